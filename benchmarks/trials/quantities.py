"""Quantities as people write them: a number with a few digits, and a common unit."""

from typing import NamedTuple

import numpy as np


class Unit(NamedTuple):
    """A unit by its name, and its size in SI units."""

    name: str
    size: float


LENGTHS = (Unit("nm", 1e-9), Unit("um", 1e-6), Unit("mm", 1e-3), Unit("m", 1.0))
STRESSES = (Unit("Pa", 1.0), Unit("kPa", 1e3), Unit("MPa", 1e6), Unit("GPa", 1e9), Unit("N/mm^2", 1e6))
WORKS = (
    Unit("J/m^2", 1.0),
    Unit("mJ/m^2", 1e-3),
    Unit("N/m", 1.0),
    Unit("N/mm", 1e3),
    Unit("mN/m", 1e-3),
)
FORCES = (Unit("N/m", 1.0), Unit("N/mm", 1e3), Unit("mN/m", 1e-3), Unit("uN/m", 1e-6))
#: The range of written numbers: the first unit is used that gives a number in this range.
LEAST, MOST = 0.01, 1000.0


def written(random: np.random.Generator, value: float, units: tuple[Unit, ...]) -> str:
    """Return the text of a value in SI units, with a unit in which it is neither large nor small."""
    handy = [unit for unit in units if LEAST <= abs(value) / unit.size < MOST]
    if not handy:
        handy = [min(units, key=lambda unit: abs(np.log(abs(value) / unit.size)))]
    unit = handy[random.integers(len(handy))]
    return f"{value / unit.size:.10g} {unit.name}"


def rounded(value: float, digits: int = 4) -> float:
    """Return the value rounded to this number of digits, as it is written."""
    return float(f"{value:.{digits - 1}e}")


def parsed_length(text: str) -> float:
    """Return a written length in metres."""
    number, name = text.split()
    return float(number) * next(unit.size for unit in LENGTHS if unit.name == name)
