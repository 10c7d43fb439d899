"""The interface of a drive: how one side of a body is moved or loaded by one parameter."""

from dataclasses import dataclass
from typing import Literal, Protocol, TypeAlias

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.quantities import FORCE_PER_WIDTH, LENGTH, Dimension
from isopeel.splines.nurbs import Side

#: A displacement component of the driven side: each point's own, one unknown that the whole side shares,
#: moved by the drive, or held where it is.
Freedom: TypeAlias = Literal["free", "tied", "prescribed", "held"]

#: What is raised and what is found, under a load: either its displacement or its force.
LoadControl: TypeAlias = Literal["displacement", "force"]


@dataclass(frozen=True)
class Column:
    """How a quantity is tabulated: name, unit, the factor from internal values, and what figures call it."""

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
    """A traction of one size on the part of a side, from parameter `start` to `end` in [0, 1].

    It amounts to a force per width, at an `angle` (radians) from the x axis. A load that `follows` turns
    with the surface it acts on, and acts on its deformed length. Under `displacement` control the force is
    an unknown, and the parameter of the drive is the mean displacement of the part along the angle; under
    `force` control it is the other way round.
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
    """A side that moves by a known displacement g(parameter), or is loaded; up to what it leaves free."""

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
        """How the parameter is tabulated."""
        ...

    @property
    def reaction_column(self) -> Column:
        """How the reaction is tabulated."""
        ...

    @property
    def freedoms(self) -> tuple[Freedom, Freedom]:
        """What becomes of the displacement of the side along x and along y."""
        ...

    @property
    def load(self) -> Load | None:
        """The load on the side, where there is one."""
        ...

    def prescribed(self, points: FloatArray, parameter: float) -> FloatArray:
        """Displacement g (n, 2) of points (n, 2) of the side; zero along components that are free or held."""
        ...

    def rate(self, points: FloatArray, parameter: float) -> FloatArray:
        """dg/dparameter (n, 2), which gives the reaction: force times rate, summed over the points."""
        ...


def unit_vector(angle: float) -> FloatArray:
    """Return the direction (2,) at an angle (radians) from the x axis."""
    # the round-off of pi would slant what is meant to lie along an axis
    return np.round(np.array([np.cos(angle), np.sin(angle)]), 15)


def dimension_of(control: LoadControl) -> Dimension:
    """Return the dimension of the parameter of a load under force or displacement control."""
    return LENGTH if control == "displacement" else FORCE_PER_WIDTH
