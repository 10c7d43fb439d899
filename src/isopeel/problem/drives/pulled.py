"""A side that a force pulls."""

from dataclasses import dataclass
from typing import ClassVar, get_args

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.quantities import Angle, Dimension, Number
from isopeel.problem.drives.base import DISPLACEMENT, FORCE, Column, Freedom, Load, LoadControl, dimension_of
from isopeel.splines.nurbs import Side, check_side


@dataclass(frozen=True)
class PulledSide:
    """A force on a side, or its part from parameter `start` to `end`, at an angle (radians) from the x axis.

    It is a dead traction, or one that `follows` the surface; the side deforms freely. Under `displacement`
    control the parameter is the mean displacement of the part along the angle (length), and the force per
    unit width is the unknown that is the reaction: so a tape is pulled at a fixed angle past any instability
    of the force. Under `force` control the parameter is the force, from none on, and the reaction the
    displacement. A load that follows keeps its angle to the surface at each of its points.
    """

    name: ClassVar[str] = "force"
    side: Side
    angle: Angle
    follows: bool = False
    control: LoadControl = "displacement"
    start: Number = 0.0
    end: Number = 1.0

    def __post_init__(self) -> None:
        """Check the side, its part, the angle and the control."""
        check_side("drive.side", self.side)
        if not np.isfinite(self.angle):
            raise InputError("drive.angle", self.angle, "it must be finite")
        if self.control not in get_args(LoadControl):
            raise InputError("drive.control", self.control, f"it is {' or '.join(get_args(LoadControl))}")
        if not 0 <= self.start < self.end <= 1:
            raise InputError("drive", (self.start, self.end), "need 0 <= start < end <= 1 along the side")

    @property
    def parameter_dimension(self) -> Dimension:
        """A length, or a force per width."""
        return dimension_of(self.control)

    @property
    def parameter_column(self) -> Column:
        """What is raised."""
        return DISPLACEMENT if self.control == "displacement" else FORCE

    @property
    def reaction_column(self) -> Column:
        """What is found."""
        return FORCE if self.control == "displacement" else DISPLACEMENT

    @property
    def freedoms(self) -> tuple[Freedom, Freedom]:
        """The side deforms freely."""
        return "free", "free"

    @property
    def load(self) -> Load | None:
        """The force."""
        return Load(self.start, self.end, self.angle, self.follows, self.control)

    def prescribed(self, points: FloatArray, parameter: float) -> FloatArray:  # noqa: ARG002 (a drive's interface)
        """Nothing."""
        return np.zeros_like(points)

    def rate(self, points: FloatArray, parameter: float) -> FloatArray:  # noqa: ARG002 (a drive's interface)
        """Nothing."""
        return np.zeros_like(points)
