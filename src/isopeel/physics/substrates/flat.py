"""A flat substrate."""

from dataclasses import dataclass, replace
from functools import cache
from math import pi
from typing import ClassVar, Self

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.quantities import Angle, Length
from isopeel.physics.batch import SUBSTRATE_SIGNATURE, BatchFunction, compile_batch


@dataclass(frozen=True)
class Flat:
    """Half space behind a line; its normal has an angle (radians) from the x axis, and points up by default.

    Along the normal n the line has the distance `height` (length) from the origin: n . x = height.
    """

    name: ClassVar[str] = "flat"
    height: Length = 0.0
    angle: Angle = pi / 2

    def __post_init__(self) -> None:
        """Check that the numbers are finite."""
        for key, value in (("height", self.height), ("angle", self.angle)):
            if not np.isfinite(value):
                raise InputError(f"substrate.{key}", value, "it must be finite")

    @property
    def parameters(self) -> FloatArray:
        """The height and the normal."""
        # the round-off of pi would slant what is meant to lie along an axis
        normal = np.round([np.cos(self.angle), np.sin(self.angle)], 15)
        return np.array([self.height, *normal], dtype=np.float64)

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of gap, normal and curvature."""
        return _compiled()

    @property
    def constant_curvature(self) -> bool:
        """Yes: zero."""
        return True

    def receded(self, gap: float) -> Self:
        """Farther back by a gap (length)."""
        return replace(self, height=self.height - gap)


@cache
def _compiled() -> BatchFunction:
    return compile_batch(SUBSTRATE_SIGNATURE, _flat)


def _flat(
    position: FloatArray,
    parameters: FloatArray,
    count: int,
    gap: FloatArray,
    normal: FloatArray,
    curvature: FloatArray,
) -> None:
    for n in range(count):
        gap[n] = parameters[1] * position[0, n] + parameters[2] * position[1, n] - parameters[0]
        normal[0, n] = parameters[1]
        normal[1, n] = parameters[2]
        curvature[n] = 0.0
