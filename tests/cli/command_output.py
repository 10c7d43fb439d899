"""What commands print and write, read back, and the options of a small run."""

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from isopeel.solve.step import KINDS

SMALL = ("--mesh", "20x2", "--space", "L1", "--to", "3", "--step", "1")
FILES = {"curve.csv", "run.h5", "summary.json", "curve.png", "shapes.png"}


def table(path: Path) -> tuple[list[str], np.ndarray[Any, np.dtype[np.float64]]]:
    with path.open(newline="") as file:
        heading, *rows = csv.reader(file)
    kind = heading.index("kind")  # the only column of words
    for row in (heading, *rows):
        assert row.pop(kind) in ("kind", *KINDS)
    values = [[cell or "nan" for cell in row] for row in rows]  # what was not measured is left empty
    return heading, np.array(values, dtype=np.float64).reshape(len(rows), len(heading))


#: Moment per width of E0 L0^3 for a width of L0, 2 GPa nm^2, and an energy likewise.
SI = 2e9 * 1e-18


def summary(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "summary.json").read_text())
    return found


def the_error(capsys: pytest.CaptureFixture[str]) -> str:
    """Return the one line on standard error."""
    error = capsys.readouterr().err
    assert error.startswith("isopeel: ")
    assert error.endswith("\n")
    assert error.count("\n") == 1
    assert "Traceback" not in error
    return error
