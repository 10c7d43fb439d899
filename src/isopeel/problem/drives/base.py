"""The two kinds of drives: a constraint moves boundaries, a load pulls them, each by one parameter."""

from dataclasses import dataclass
from typing import Literal, Protocol, TypeAlias, runtime_checkable

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.quantities import FORCE_PER_WIDTH, LENGTH, Dimension
from isopeel.problem.boundary import Place

#: A displacement component of a driven boundary: free at each point; tied, one unknown for the whole
#: boundary; prescribed by the drive; or held where it is.
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

    def text(self, shown: float) -> str:
        """Return a value in the unit of the column with this unit."""
        plural = "s" if self.unit == "degree" and shown != 1.0 else ""
        return f"{shown:.6g} {self.unit}{plural}"


DISPLACEMENT = Column("displacement", "L0", words="displacement $d$")
FORCE = Column("force", "E0 L0", words="force $F$")


class _Driving(Protocol):
    """What all drives have."""

    @property
    def on(self) -> Place:
        """The boundaries that it acts on, and their factors."""
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


@runtime_checkable
class Constraint(_Driving, Protocol):
    """A drive that prescribes a displacement g of boundaries; components of it may be free.

    The displacement of a boundary is that at its factor times the parameter.
    """

    @property
    def freedoms(self) -> tuple[Freedom, Freedom]:
        """How the displacement of a boundary is constrained along x and along y."""
        ...

    def prescribed(self, points: FloatArray, parameter: float) -> FloatArray:
        """Displacement g (n, 2) of points (n, 2) of a boundary; zero along components that are free or held.

        The points are in the order of the parameter of the side.
        """
        ...

    def rate(self, points: FloatArray, parameter: float) -> FloatArray:
        """dg/dparameter (n, 2), which gives the reaction: force times rate, summed over the points."""
        ...


@runtime_checkable
class Load(_Driving, Protocol):
    """A drive that pulls boundaries by uniform tractions of one size, the force per width.

    The force on a boundary is its factor times that. Under `displacement` control the force is an unknown,
    and the parameter is the displacement on which it works: the sum of factor times mean displacement along
    the direction. Under `force` control it is the other way round.
    """

    @property
    def direction(self) -> FloatArray:
        """Unit vector (2,) of the force on the undeformed boundary."""
        ...

    @property
    def follows(self) -> bool:
        """Whether the force turns with the surface, and acts on its deformed length."""
        ...

    @property
    def control(self) -> LoadControl:
        """What the parameter is."""
        ...


Drive: TypeAlias = Constraint | Load


def raises_load(drive: Drive) -> bool:
    """Return whether the parameter is the size of a load, so that the reaction is a displacement."""
    return isinstance(drive, Load) and drive.control == "force"


def unit_vector(angle: float) -> FloatArray:
    """Return the direction (2,) at an angle (radians) from the x axis."""
    # with the round-off of pi, directions along an axis would be slightly inclined
    return np.round(np.array([np.cos(angle), np.sin(angle)]), 15)


def dimension_of(control: LoadControl) -> Dimension:
    """Return the dimension of the parameter of a load under force or displacement control."""
    return LENGTH if control == "displacement" else FORCE_PER_WIDTH
