"""A flat substrate."""

from math import pi
from typing import Annotated, ClassVar

import numpy as np

from isopeel.common.quantities import Angle, Finite, Length, Meaning
from isopeel.physics.substrates.rigid import RigidSubstrate, substrate


@substrate
class Flat(RigidSubstrate):
    """Half space behind a line; its normal has an angle (radians) from the x axis, and points up by default.

    Along the normal n the line has the distance `height` (length) from the origin: n . x = height.
    """

    constant_curvature: ClassVar[bool] = True
    height: Annotated[Finite[Length], Meaning("distance of the plane from the origin", "0 nm")] = 0.0
    angle: Annotated[Finite[Angle], Meaning("angle of the normal of the plane from the x axis", "90 deg")] = (
        pi / 2
    )

    def constants(self) -> tuple[float, ...]:
        """Height and normal."""
        # the round-off of pi would slant what is meant to lie along an axis
        return self.height, *np.round([np.cos(self.angle), np.sin(self.angle)], 15)

    @staticmethod
    def at_point(
        x: float, y: float, height: float, normal_x: float, normal_y: float
    ) -> tuple[float, float, float, float]:
        """Return gap, normal and curvature."""
        return normal_x * x + normal_y * y - height, normal_x, normal_y, 0.0
