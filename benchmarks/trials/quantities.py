"""Quantities as people write them: a number of a few digits, and one of the units in use."""

from typing import NamedTuple

import numpy as np


class Unit(NamedTuple):
    """A unit by its name, and how many SI units it is."""

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
#: Numbers are written between these, in the first units that allow it.
LEAST, MOST = 0.01, 1000.0


def written(random: np.random.Generator, value: float, units: tuple[Unit, ...]) -> str:
    """Write a value in SI units with one of the units, in which it is neither large nor small."""
    handy = [unit for unit in units if LEAST <= abs(value) / unit.size < MOST]
    if not handy:
        handy = [min(units, key=lambda unit: abs(np.log(abs(value) / unit.size)))]
    unit = handy[random.integers(len(handy))]
    return f"{value / unit.size:.10g} {unit.name}"


def rounded(value: float, digits: int = 4) -> float:
    """The value with so many digits, as it is written."""
    return float(f"{value:.{digits - 1}e}")


def parsed_length(text: str) -> float:
    """Metres in a written length."""
    number, name = text.split()
    return float(number) * next(unit.size for unit in LENGTHS if unit.name == name)
