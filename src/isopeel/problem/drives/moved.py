"""Sides that are moved along a straight line."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, TypeAlias, get_args

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.quantities import LENGTH, Angle, Dimension, Meaning
from isopeel.problem.boundary import Place, driven_boundaries
from isopeel.problem.drives.base import DISPLACEMENT, FORCE, Column, Freedom, unit_vector

#: How the displacement across the motion is constrained.
Transverse: TypeAlias = Literal["free", "held"]


@dataclass(frozen=True)
class MovedSide:
    """A side, or boundaries by factors, whose points all move by one displacement.

    It is along an angle (radians) from the x axis. Parameter: the displacement (length). Reaction: the force
    along it per unit width. Across the motion each point is `held`, or `free` if the motion is along an axis.
    A side that moves along itself cannot rotate without being stretched: for the end of a beam take
    `PulledSide`.
    """

    name: ClassVar[str] = "displacement"
    on: Place
    angle: Annotated[Angle, Meaning("angle of the motion from the x axis", "90 deg")]
    transverse: Annotated[
        Transverse, Meaning("whether points of the side can move across the motion", "held")
    ] = "free"

    def __post_init__(self) -> None:
        """Check the boundaries, the angle and the constraint across the motion."""
        driven_boundaries(self.on)
        if self.transverse not in get_args(Transverse):
            allowed = f"it must be {' or '.join(get_args(Transverse))}"
            raise InputError("drive.transverse", self.transverse, allowed)
        if not np.isfinite(self.angle):
            raise InputError("drive.angle", self.angle, "it must be finite")
        if self.transverse == "free" and 0.0 not in unit_vector(self.angle):
            allowed = "at this angle the side must be 'held' across; 'free' needs 0, 90, 180 or 270 deg"
            raise InputError("drive.angle", self.angle, allowed)

    @property
    def parameter_dimension(self) -> Dimension:
        """A length."""
        return LENGTH

    @property
    def parameter_column(self) -> Column:
        """The displacement."""
        return DISPLACEMENT

    @property
    def reaction_column(self) -> Column:
        """The force on a body of unit width."""
        return FORCE

    @property
    def freedoms(self) -> tuple[Freedom, Freedom]:
        """Prescribed along the motion."""
        x, y = unit_vector(self.angle)
        across: Freedom = "free" if self.transverse == "free" else "held"
        return "prescribed" if x else across, "prescribed" if y else across

    def prescribed(self, points: FloatArray, parameter: float) -> FloatArray:
        """Return the same displacement for all points."""
        return np.broadcast_to(parameter * unit_vector(self.angle), points.shape)

    def rate(self, points: FloatArray, parameter: float) -> FloatArray:  # noqa: ARG002 (a drive's interface)
        """Return the direction."""
        return np.broadcast_to(unit_vector(self.angle), points.shape)
