"""Types of the fields of physics and problem objects: floats with a dimension, in any consistent units.

    radius: Positive[Length]

declares a field as a length larger than zero, without a unit: in Python, the caller chooses any consistent
units. Only case files have units, and these dimensions define which units are allowed.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, isfinite
from typing import Annotated, Any, TypeAlias, TypeVar


@dataclass(frozen=True)
class Dimension:
    """A power product of stresses and lengths, an angle (in radians), or a plain number if it is none.

    `needed` is the text of messages: what is needed, with an example.
    """

    needed: str
    stress: int = 0
    length: int = 0
    angle: bool = False

    @property
    def is_number(self) -> bool:
        """Whether a value is written without a unit."""
        return not (self.stress or self.length or self.angle)


LENGTH = Dimension("a length is needed, such as '200 nm'", length=1)
STRESS = Dimension("a stress is needed, such as '2 GPa'", stress=1)
ENERGY = Dimension("an energy is needed, such as '1e-19 J'", stress=1, length=3)
SURFACE_ENERGY = Dimension("an energy per area is needed, such as '0.03 J/m^2'", stress=1, length=1)
STRESS_PER_LENGTH = Dimension("a stress per length is needed, such as '10 N/mm^3'", stress=1, length=-1)
FORCE_PER_WIDTH = Dimension("a force per width is needed, such as '0.05 N/m'", stress=1, length=1)
ANGLE = Dimension("an angle is needed, such as '0.1 deg'", angle=True)
NUMBER = Dimension("a number is needed, without quotes")

Length: TypeAlias = Annotated[float, LENGTH]
Stress: TypeAlias = Annotated[float, STRESS]
Energy: TypeAlias = Annotated[float, ENERGY]
SurfaceEnergy: TypeAlias = Annotated[float, SURFACE_ENERGY]
ForcePerWidth: TypeAlias = Annotated[float, FORCE_PER_WIDTH]
StressPerLength: TypeAlias = Annotated[float, STRESS_PER_LENGTH]
Angle: TypeAlias = Annotated[float, ANGLE]
Number: TypeAlias = Annotated[float, NUMBER]


@dataclass(frozen=True)
class Limit:
    """What a value must be, in words and as a condition; `Component` checks it."""

    allowed: str
    holds: Callable[[float], bool]


@dataclass(frozen=True)
class Meaning:
    """What a field means, as the reference of keys shows it.

    `example` is a value as a case file has it, `usual` the default in words where the value does not show it,
    and `see` a page of the site, with its section.
    """

    text: str
    example: Any = None
    usual: str = ""
    see: str = ""


_Quantity = TypeVar("_Quantity")

Finite: TypeAlias = Annotated[_Quantity, Limit("it must be finite", isfinite)]
Positive: TypeAlias = Annotated[_Quantity, Limit("it must be positive", lambda value: 0 < value < inf)]
NotNegative: TypeAlias = Annotated[
    _Quantity, Limit("it must be zero or positive", lambda value: 0 <= value < inf)
]
