"""A substrate bounded by a circle: a cylinder, or a hole."""

from dataclasses import replace
from typing import Annotated, ClassVar, Literal, Self, get_args

import numpy as np

from isopeel.common.errors import InputError
from isopeel.common.quantities import Length, Meaning, Positive
from isopeel.physics.substrates.rigid import RigidSubstrate, substrate

#: Where the solid lies: inside the circle (a cylinder, convex) or outside it (a hole, concave).
SolidPart = Literal["inside", "outside"]


@substrate
class Circle(RigidSubstrate):
    """Solid inside or outside a circle (lengths); its curvature is 1/R inside, -1/R outside.

    The gap is d - R for a cylinder and R - d for a hole, at the distance d from the centre. The centre has no
    closest point: its normal is nan. Without a centre the circle is below or above the origin, so that the
    substrate ends there and lies below it. Raises InputError unless R > 0.
    """

    constant_curvature: ClassVar[bool] = True
    radius: Annotated[Positive[Length], Meaning("radius of the cylinder or the hollow", "200 nm")]
    solid: Annotated[
        SolidPart, Meaning("which side is solid: inside (a cylinder) or outside (a hollow)", "inside")
    ] = "inside"
    centre: Annotated[
        tuple[Length, Length] | None,
        Meaning(
            "centre of the circle",
            ["0 nm", "-200 nm"],
            usual="the lowest or highest point of the circle is the origin",
        ),
    ] = None

    def check(self) -> None:
        """Check the part that is solid and the centre."""
        if self.solid not in get_args(SolidPart):
            raise self.error("solid", f"it is {' or '.join(get_args(SolidPart))}")
        if len(self.middle) != 2 or not np.isfinite(self.middle).all():
            raise self.error("centre", "it has two finite coordinates")

    @property
    def middle(self) -> tuple[float, float]:
        """The centre, given or not."""
        return self.centre or (0.0, -self._sign * self.radius)

    def receded(self, gap: float) -> Self:
        """A smaller cylinder or a larger hole about the same centre, by a gap (length)."""
        radius = self.radius - self._sign * gap
        if not 0 < radius < np.inf:
            raise InputError("substrate.gap", gap, f"it leaves the radius {radius:g}, which must be positive")
        return replace(self, radius=radius, centre=self.middle)

    @property
    def _sign(self) -> float:
        return 1.0 if self.solid == "inside" else -1.0

    def constants(self) -> tuple[float, ...]:
        """Centre, radius, and the sign of the curvature."""
        return *self.middle, self.radius, self._sign

    @staticmethod
    def at_point(
        x: float, y: float, centre_x: float, centre_y: float, radius: float, sign: float
    ) -> tuple[float, float, float, float]:
        """Return gap, normal and curvature."""
        x, y = x - centre_x, y - centre_y
        distance = np.hypot(x, y)
        return sign * (distance - radius), sign * x / distance, sign * y / distance, sign / radius
