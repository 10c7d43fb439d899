"""Files of cases: how they are read, and which are refused."""

import json
from pathlib import Path

import numpy as np
import pytest
from case_texts import STRIP, case_with

from isopeel.case import Case, load_case, shipped_cases, with_options
from isopeel.case.load import LARGEST_FILE
from isopeel.common.errors import InputError
from isopeel.problem.shapes import Patch


def test_files_that_are_no_case_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    broken, binary, nested, digits, large = (tmp_path / f"{name}.toml" for name in "abcde")
    broken.write_text('name = "x"\nlength 3\n')
    binary.write_bytes(b"name\xff")
    nested.write_text("a = " + "[" * 10_000)
    digits.write_text("a = " + "1" * 5000)
    large.write_text("#" * (LARGEST_FILE + 1))
    for path, allowed in (
        (tmp_path / "none.toml", "does not exist"),
        (tmp_path, "is no file"),
        (broken, "line 2"),
        (binary, "byte 4"),
        (nested, "not TOML"),
        (digits, "not TOML"),
        (large, f"at most {LARGEST_FILE} bytes"),
    ):
        with pytest.raises(InputError) as caught:
            load_case(path)
        assert (caught.value.field, caught.value.value) == ("CASE", str(path))
        assert allowed in caught.value.allowed

    def refuse(*_: object) -> str:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(InputError, match="Permission denied"):
        load_case(broken)


def test_a_file_is_read_like_a_shipped_case(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(STRIP)
    assert load_case(path) == load_case("strip")
    assert "strip" in shipped_cases()


def test_a_shape_s_file_is_seen_from_the_folder_of_the_case(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    patch = {
        "SplineType": "Bezier",
        "para_dim": 2,
        "dim": 2,
        "degrees": [1, 1],
        "control_points": [[0, 0], [4, 0], [0, 1], [4, 1]],
    }
    (tmp_path / "patch.json").write_text(json.dumps({"SplineList": [patch]}))
    (tmp_path / "case.toml").write_text(
        case_with(body='shape = "patch"\nfile = "patch.json"\nunit_length = "10 nm"')
    )
    case = load_case(tmp_path / "case.toml")
    shape = case.problem().body.shape
    expected = Patch(tmp_path / "patch.json", 10.0).surface()
    assert np.array_equal(shape.control_points, expected.control_points)
    assert shape.control_points.max() == 40.0
    # the text of the case, which a run keeps, can be read from any other place
    monkeypatch.chdir(Path("/"))
    again = Case.parse(with_options(case, mesh="20x2").text)
    assert np.array_equal(again.problem().body.shape.control_points, expected.control_points)
    with pytest.raises(InputError, match=r"body\.file"):
        Case.parse((tmp_path / "case.toml").read_text())
