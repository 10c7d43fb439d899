"""Units of measured columns, and their sizes in SI units."""

from typing import NamedTuple

from isopeel.common.units import measured_as, parse_quantity


class Dimensions(NamedTuple):
    """Powers of stress and length, or an angle."""

    stress: int
    length: int
    angle: bool


def dimensions_of(unit: str) -> Dimensions:
    """Return the dimensions of a unit. Raises ValueError if there is no such unit."""
    quantity = parse_quantity(f"1 {unit}")
    return Dimensions(int(quantity.stress), int(quantity.length), quantity.angle)


def in_si(unit: str) -> float:
    """Return the size of a unit in SI units; of an angle in radians. Raises ValueError."""
    return float(parse_quantity(f"1 {unit}").exact)


def in_unit(text: str, unit: str) -> float:
    """Return a written value as a number of a unit; the empty unit is that of plain numbers.

    Raises ValueError with the reason.
    """
    if unit:
        return measured_as(text, unit)
    return float(text)
