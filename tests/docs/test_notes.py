"""The page on notes states the thresholds that the code has."""

import re
from importlib import import_module
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "howto" / "notes.md"
ROW = r"^\| ([\d.]+)( %)? \| .* \| `post\.([\w.]+)\.([A-Z_]+)` \|$"
ROWS = re.findall(ROW, PAGE.read_text("utf-8"), re.M)


def test_the_page_has_a_table_of_thresholds() -> None:
    assert len(ROWS) >= 6


@pytest.mark.parametrize(("value", "percent", "module", "name"), ROWS)
def test_thresholds_on_the_page_are_those_of_the_code(
    value: str, percent: str, module: str, name: str
) -> None:
    constant = getattr(import_module(f"isopeel.post.{module}"), name)
    assert float(value) == pytest.approx(100 * constant if percent else constant)
