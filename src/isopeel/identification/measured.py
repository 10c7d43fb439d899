"""Measured curves: columns of a CSV file, with their units."""

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.identification.units import dimensions_of

#: A heading with the unit of its column, such as "force [N/m]" or "force (N/25 mm)".
_HEADING = re.compile(r"(?P<name>.*?)\s*[\[(](?P<unit>.*)[\])]\s*")
_LARGEST_FILE = 20_000_000  # bytes
_MOST_POINTS = 100_000
_A_HEADING = "a heading has the unit of its column in brackets, such as 'force [N/m]'"


@dataclass(frozen=True, eq=False)
class Measured:
    """The measured points of one curve: values y (points,) over x (points,), in the units of their columns.

    `deviations` (points,) are the standard deviations of y, None if they are not known. Raises InputError if
    the arrays do not have the same length or are not finite, or if a unit does not exist.
    """

    name: str
    columns: tuple[str, str]
    units: tuple[str, str]
    x: FloatArray
    y: FloatArray
    deviations: FloatArray | None = None

    def __post_init__(self) -> None:
        """Check the columns."""
        for column, unit in zip(self.columns, self.units, strict=True):
            try:
                dimensions_of(unit)
            except ValueError as error:
                raise InputError(f"{self.name}, {column}", unit, f"{error}; {_A_HEADING}") from error
        arrays = [self.x, self.y] + ([] if self.deviations is None else [self.deviations])
        if len({array.shape for array in arrays}) != 1 or self.x.ndim != 1:
            raise InputError(self.name, None, "all columns need the same number of values")
        if not len(self.x):
            raise InputError(self.name, None, "it has no points")
        if not all(np.isfinite(array).all() for array in arrays):
            raise InputError(self.name, None, "all values must be finite")
        if self.deviations is not None and not (self.deviations > 0).all():
            raise InputError(self.name, None, "all standard deviations must be positive")

    @property
    def headings(self) -> tuple[str, str]:
        """The headings of x and y."""
        x, y = (f"{name} [{unit}]" for name, unit in zip(self.columns, self.units, strict=True))
        return x, y


def read_measured(path: Path, x: str = "", y: str = "", deviation: str = "") -> Measured:
    """Read a CSV file whose first line has headings with units; lines that begin with # are left out.

    `x`, `y` and `deviation` are the names of columns, or their whole headings; by default x and y are the
    first and the second column. Columns are separated by commas, semicolons or tabs. Raises InputError whose
    field is the file, its line and its column.
    """
    rows = _rows(path)
    (_, headings), *lines = rows
    chosen = [_column(path, headings, name, place) for place, name in enumerate((x, y))]
    if deviation:
        chosen.append(_column(path, headings, deviation, 2))
    names, units = zip(*(_name_and_unit(path, headings[place]) for place in chosen), strict=True)
    if deviation and units[2] != units[1]:
        allowed = f"the standard deviation must have the unit of {headings[chosen[1]]!r}"
        raise InputError(str(path), headings[chosen[2]], allowed)
    if not lines:
        raise InputError(str(path), None, "it has no points below its headings")
    table = np.array(
        [
            [
                _number(path, number, headings[place], row[place] if place < len(row) else "")
                for place in chosen
            ]
            for number, row in lines
        ]
    )
    deviations = table[:, 2] if deviation else None
    return Measured(str(path), names[:2], units[:2], table[:, 0], table[:, 1], deviations)


def _rows(path: Path) -> list[tuple[int, list[str]]]:
    """Return the lines of a file with their numbers, without comments and empty lines."""
    try:
        if not path.is_file():
            kind = "is no file" if path.exists() else "does not exist"
            raise InputError("measured", str(path), f"it {kind}; a CSV file is needed")
        if path.stat().st_size > _LARGEST_FILE:
            raise InputError("measured", str(path), f"a measured curve has at most {_LARGEST_FILE} bytes")
        text = path.read_text("utf-8-sig")
    except OSError as error:
        raise InputError("measured", str(path), f"it cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InputError("measured", str(path), "a CSV file is UTF-8 text") from error
    kept = [
        (number, line)
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not kept:
        raise InputError(
            "measured", str(path), "it is empty; a line of headings and lines of numbers are needed"
        )
    if len(kept) > _MOST_POINTS:
        raise InputError("measured", str(path), f"a measured curve has at most {_MOST_POINTS} points")
    heading = kept[0][1]
    delimiter = next((one for one in ("\t", ";") if one in heading), ",")
    fields = csv.reader((line for _, line in kept), delimiter=delimiter, skipinitialspace=True)
    try:
        return [
            (number, [field.strip() for field in row]) for (number, _), row in zip(kept, fields, strict=True)
        ]
    except (csv.Error, ValueError) as error:
        raise InputError("measured", str(path), f"it is no CSV file: {error}") from error


def _column(path: Path, headings: Sequence[str], wanted: str, usual: int) -> int:
    """Return the place of a column by its name or heading; by default the usual one."""
    if not wanted:
        if usual < len(headings):
            return usual
        raise InputError(str(path), None, f"it needs two columns, and has {len(headings)}")
    names = [_HEADING.sub(r"\g<name>", heading) for heading in headings]
    found = [place for place, pair in enumerate(zip(headings, names, strict=True)) if wanted in pair]
    if len(found) != 1:
        number = "no column has" if not found else f"{len(found)} columns have"
        raise InputError(str(path), wanted, f"{number} this name; the headings are {', '.join(headings)}")
    return found[0]


def _name_and_unit(path: Path, heading: str) -> tuple[str, str]:
    found = _HEADING.fullmatch(heading)
    if found is None:
        raise InputError(str(path), heading, _A_HEADING)
    return found["name"], found["unit"]


def _number(path: Path, line: int, heading: str, text: str) -> float:
    field = f"{path}, line {line}, {heading}"
    try:
        value = float(text)
    except ValueError as error:
        raise InputError(field, text, "a number is needed, with a point before its decimals") from error
    if not isfinite(value):
        raise InputError(field, text, "it must be finite; leave out points that were not measured")
    return value
