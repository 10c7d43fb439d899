"""The names that `import isopeel` gives."""

import pytest

import isopeel


def test_the_package_gives_all_its_names() -> None:
    for name in isopeel.__all__:
        assert getattr(isopeel, name).__name__ == name
    assert set(isopeel.__all__) <= set(dir(isopeel))
    with pytest.raises(AttributeError, match="no attribute 'peel'"):
        _ = isopeel.peel  # type: ignore[attr-defined]
