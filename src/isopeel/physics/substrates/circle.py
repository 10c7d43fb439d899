"""A substrate bounded by a circle: a cylinder, or a hole."""

from dataclasses import dataclass, replace
from functools import cache
from typing import ClassVar, Literal, Self, get_args

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.quantities import Length
from isopeel.physics.batch import SUBSTRATE_SIGNATURE, BatchFunction, compile_batch

#: Where the solid lies: inside the circle (a cylinder, convex) or outside it (a hole, concave).
SolidPart = Literal["inside", "outside"]


@dataclass(frozen=True)
class Circle:
    """Solid inside or outside a circle (lengths); its curvature is 1/R inside, -1/R outside.

    The gap is d - R for a cylinder and R - d for a hole, at the distance d from the centre. The centre has no
    closest point: its normal is nan. Without a centre the circle is below or above the origin, so that the
    substrate ends there and lies below it. Raises InputError unless R > 0.
    """

    name: ClassVar[str] = "circle"
    radius: Length
    solid: SolidPart = "inside"
    centre: tuple[Length, Length] | None = None

    def __post_init__(self) -> None:
        """Check the circle and the part that is solid."""
        if not 0 < self.radius < np.inf:
            raise InputError("substrate.radius", self.radius, "it must be positive")
        if self.solid not in get_args(SolidPart):
            raise InputError("substrate.solid", self.solid, f"it is {' or '.join(get_args(SolidPart))}")
        if len(self.middle) != 2 or not np.isfinite(self.middle).all():
            raise InputError("substrate.centre", self.centre, "it has two finite coordinates")

    @property
    def middle(self) -> tuple[float, float]:
        """The centre, given or not."""
        return self.centre or (0.0, -self._sign * self.radius)

    @property
    def parameters(self) -> FloatArray:
        """Centre, radius, and the sign of the curvature."""
        return np.array([*self.middle, self.radius, self._sign])

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of gap, normal and curvature."""
        return _compiled()

    @property
    def constant_curvature(self) -> bool:
        """Yes: that of the circle."""
        return True

    def receded(self, gap: float) -> Self:
        """A smaller cylinder or a larger hole about the same centre, by a gap (length)."""
        radius = self.radius - self._sign * gap
        if not 0 < radius < np.inf:
            raise InputError("substrate.gap", gap, f"it leaves the radius {radius:g}, which must be positive")
        return replace(self, radius=radius, centre=self.middle)

    @property
    def _sign(self) -> float:
        return 1.0 if self.solid == "inside" else -1.0


@cache
def _compiled() -> BatchFunction:
    return compile_batch(SUBSTRATE_SIGNATURE, _circle)


def _circle(
    position: FloatArray,
    parameters: FloatArray,
    count: int,
    gap: FloatArray,
    normal: FloatArray,
    curvature: FloatArray,
) -> None:
    radius = parameters[2]
    sign = parameters[3]
    for n in range(count):
        x = position[0, n] - parameters[0]
        y = position[1, n] - parameters[1]
        distance = np.hypot(x, y)
        gap[n] = sign * (distance - radius)
        normal[0, n] = sign * x / distance
        normal[1, n] = sign * y / distance
        curvature[n] = sign / radius
