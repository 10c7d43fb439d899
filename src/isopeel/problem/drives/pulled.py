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
    """A force on the part of a side from parameter `start` to `end`, at an angle (radians) from the x axis.

    It is a dead traction, or one that `follows` the surface; the side deforms freely. Under `displacement`
    control the parameter is the mean displacement of the part along the angle (length). The force per unit
    width is an unknown, and the reaction. This pulls a tape at a fixed angle past an instability of the
    force. Under `force` control the parameter is the force, which begins with zero, and the reaction is the
    displacement. A load that follows keeps its angle to the surface at each point.
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
            raise InputError(
                "drive.control", self.control, f"it must be {' or '.join(get_args(LoadControl))}"
            )
        if not 0 <= self.start < self.end <= 1:
            raise InputError("drive", (self.start, self.end), "need 0 <= start < end <= 1 along the side")

    @property
    def parameter_dimension(self) -> Dimension:
        """A length under displacement control, a force per width under force control."""
        return dimension_of(self.control)

    @property
    def parameter_column(self) -> Column:
        """The displacement or the force, by the control."""
        return DISPLACEMENT if self.control == "displacement" else FORCE

    @property
    def reaction_column(self) -> Column:
        """The other one of displacement and force."""
        return FORCE if self.control == "displacement" else DISPLACEMENT

    @property
    def freedoms(self) -> tuple[Freedom, Freedom]:
        """The side deforms freely."""
        return "free", "free"

    @property
    def load(self) -> Load | None:
        """The traction."""
        return Load(self.start, self.end, self.angle, self.follows, self.control)

    def prescribed(self, points: FloatArray, parameter: float) -> FloatArray:  # noqa: ARG002 (a drive's interface)
        """Return zeros."""
        return np.zeros_like(points)

    def rate(self, points: FloatArray, parameter: float) -> FloatArray:  # noqa: ARG002 (a drive's interface)
        """Return zeros."""
        return np.zeros_like(points)
