"""The values that keys of a case file take, in L0 and E0, and what is said where they are wrong."""

from collections.abc import Callable
from typing import Annotated

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from isopeel.units import parse_quantity

#: Magnitudes, in L0 and E0 or degrees, between which products of a few powers of them stay finite.
SMALLEST, LARGEST = 1e-12, 1e12


def _quantity(needed: str, stress: int = 0, length: int = 0) -> Callable[[object], float]:
    """Return the reader of a quantity in E0^stress L0^length, or in degrees if both are 0."""

    def read(written: object) -> float:
        try:
            quantity = parse_quantity(str(written))
        except ValueError as error:
            raise ValueError(f"{error}; {needed}") from error
        if quantity.stress != stress or quantity.length != length:
            raise ValueError(needed)
        if quantity.value and not SMALLEST <= abs(quantity.value) <= LARGEST:
            unit = "degrees" if quantity.angle else "units made of 1 nm and 2 GPa"
            raise ValueError(f"it must lie between {SMALLEST:g} and {LARGEST:g} in {unit}")
        return quantity.value

    return read


def _constant(written: object) -> float:
    """Read a constant of a formula: a plain number, or a text with a unit made of stresses and lengths."""
    if isinstance(written, int | float) and not isinstance(written, bool):
        try:
            return float(written)
        except OverflowError as error:
            raise ValueError("it must be finite") from error
    quantity = parse_quantity(str(written))
    if quantity.angle:
        raise ValueError("write angles as plain numbers, in radians")
    return quantity.value


def window_of(written: object) -> tuple[float, float]:
    """Read two angles in degrees, the smaller one first."""
    if not isinstance(written, list) or len(written) != 2:
        raise ValueError(A_WINDOW)
    start, end = map(_quantity(A_WINDOW), written)
    if not start < end:
        raise ValueError(A_WINDOW)
    return start, end


_A_LENGTH = "a length is needed, such as '200 nm'"
_A_STRESS = "a stress is needed, such as '2 GPa'"
_AN_ENERGY = "an energy is needed, such as '1e-19 J'"
_A_SURFACE_ENERGY = "an energy per area is needed, such as '0.03 J/m^2'"
_AN_ANGLE = "an angle is needed, such as '0.1 deg'"
A_WINDOW = "two angles are needed, the smaller one first, such as ['98 deg', '101 deg']"
# The descriptions say what each key needs; messages about missing or unusable values end with them.
Length = Annotated[float, BeforeValidator(_quantity(_A_LENGTH, length=1)), Field(description=_A_LENGTH)]
Stress = Annotated[float, BeforeValidator(_quantity(_A_STRESS, stress=1)), Field(description=_A_STRESS)]
Energy = Annotated[
    float, BeforeValidator(_quantity(_AN_ENERGY, stress=1, length=3)), Field(description=_AN_ENERGY)
]
SurfaceEnergy = Annotated[
    float,
    BeforeValidator(_quantity(_A_SURFACE_ENERGY, stress=1, length=1)),
    Field(description=_A_SURFACE_ENERGY),
]
Angle = Annotated[float, BeforeValidator(_quantity(_AN_ANGLE)), Field(description=_AN_ANGLE)]
Constants = dict[str, Annotated[float, BeforeValidator(_constant)]]
Number = Annotated[float, Field(strict=True, description="a number is needed, without quotes")]


class Section(BaseModel):
    """A table of known keys."""

    model_config = ConfigDict(frozen=True, extra="forbid")
