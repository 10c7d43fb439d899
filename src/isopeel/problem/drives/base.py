"""The interface of a drive: how one side of a body is moved or loaded by one parameter."""

from dataclasses import dataclass
from typing import Literal, Protocol, TypeAlias

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.quantities import FORCE_PER_WIDTH, LENGTH, Dimension
from isopeel.splines.nurbs import Side

#: The displacement component of a driven side: free at each point; tied, one unknown for the whole side;
#: prescribed by the drive; or held where it is.
Freedom: TypeAlias = Literal["free", "tied", "prescribed", "held"]

#: What the parameter of a load prescribes, its displacement or its force. The other one is the reaction.
LoadControl: TypeAlias = Literal["displacement", "force"]


@dataclass(frozen=True)
class Column:
    """A column of a table: its name, its unit, the factor from internal values, and the label in figures."""

    name: str
    unit: str
    factor: float = 1.0
    words: str = ""

    def shown(self, value: float) -> float:
        """Return the value in the unit of the column, without the round-off of its conversion."""
        return round(value * self.factor, 12)


DISPLACEMENT = Column("displacement", "L0", words="displacement $d$")
FORCE = Column("force", "E0 L0", words="force $F$")


@dataclass(frozen=True)
class Load:
    """A uniform traction on the part of a side, from parameter `start` to `end` in [0, 1].

    Its sum is a force per unit width, at an `angle` (radians) from the x axis. A load that `follows` rotates
    with the surface, and acts on the deformed length. Under `displacement` control the parameter of the drive
    is the mean displacement of the part along the angle, and the force is an unknown. Under `force` control
    the parameter is the force, and the reaction is the displacement.
    """

    start: float
    end: float
    angle: float
    follows: bool
    control: LoadControl

    @property
    def direction(self) -> FloatArray:
        """Unit vector (2,) of the force on the undeformed side."""
        return unit_vector(self.angle)


class Drive(Protocol):
    """A side with a prescribed displacement g(parameter) or a load; components of it may be free."""

    @property
    def side(self) -> Side:
        """The driven side."""
        ...

    @property
    def parameter_dimension(self) -> Dimension:
        """Whether the parameter is an angle, a length, or a force per width."""
        ...

    @property
    def parameter_column(self) -> Column:
        """The column of the parameter in tables."""
        ...

    @property
    def reaction_column(self) -> Column:
        """The column of the reaction in tables."""
        ...

    @property
    def freedoms(self) -> tuple[Freedom, Freedom]:
        """How the displacement of the side is constrained along x and along y."""
        ...

    @property
    def load(self) -> Load | None:
        """The load on the side, or None."""
        ...

    def prescribed(self, points: FloatArray, parameter: float) -> FloatArray:
        """Displacement g (n, 2) of points (n, 2) of the side; zero along components that are free or held."""
        ...

    def rate(self, points: FloatArray, parameter: float) -> FloatArray:
        """dg/dparameter (n, 2), which gives the reaction: force times rate, summed over the points."""
        ...


def unit_vector(angle: float) -> FloatArray:
    """Return the direction (2,) at an angle (radians) from the x axis."""
    # with the round-off of pi, directions along an axis would be slightly inclined
    return np.round(np.array([np.cos(angle), np.sin(angle)]), 15)


def dimension_of(control: LoadControl) -> Dimension:
    """Return the dimension of the parameter of a load under force or displacement control."""
    return LENGTH if control == "displacement" else FORCE_PER_WIDTH
