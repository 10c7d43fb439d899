"""A substrate bounded by a circle: a cylinder, or a hole."""

from dataclasses import dataclass
from functools import cache
from typing import Literal, get_args

import numpy as np

from isopeel.arrays import FloatArray
from isopeel.errors import InputError
from isopeel.physics.batch import SUBSTRATE_SIGNATURE, BatchFunction, compile_batch

#: Where the solid lies: inside the circle (a cylinder, convex) or outside it (a hole, concave).
SolidPart = Literal["inside", "outside"]


@dataclass(frozen=True)
class Circle:
    """Solid inside or outside a circle (lengths); its curvature is 1/R inside, -1/R outside.

    The gap is d - R for a cylinder and R - d for a hole, at the distance d from the centre. The centre has no
    closest point: its normal is nan. Raises InputError unless R > 0.
    """

    centre: tuple[float, float]
    radius: float
    solid: SolidPart

    def __post_init__(self) -> None:
        """Check the circle and the part that is solid."""
        if len(self.centre) != 2 or not np.isfinite(self.centre).all():
            raise InputError("substrate.centre", self.centre, "it has two finite coordinates")
        if not 0 < self.radius < np.inf:
            raise InputError("substrate.radius", self.radius, "it must be positive")
        if self.solid not in get_args(SolidPart):
            raise InputError("substrate.solid", self.solid, f"it is {' or '.join(get_args(SolidPart))}")

    @property
    def parameters(self) -> FloatArray:
        """Centre, radius, and the sign of the curvature."""
        return np.array([*self.centre, self.radius, 1.0 if self.solid == "inside" else -1.0])

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of gap, normal and curvature."""
        return _compiled()


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
