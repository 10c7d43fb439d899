"""A flat substrate."""

from dataclasses import dataclass, replace
from functools import cache
from typing import ClassVar, Self

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.quantities import Length
from isopeel.physics.batch import SUBSTRATE_SIGNATURE, BatchFunction, compile_batch


@dataclass(frozen=True)
class Flat:
    """Half space below the line y = `height` (length); its normal points along +y."""

    name: ClassVar[str] = "flat"
    height: Length = 0.0

    def __post_init__(self) -> None:
        """Check the height."""
        if not np.isfinite(self.height):
            raise InputError("substrate.height", self.height, "it must be finite")

    @property
    def parameters(self) -> FloatArray:
        """The height."""
        return np.array([self.height], dtype=np.float64)

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of gap, normal and curvature."""
        return _compiled()

    @property
    def constant_curvature(self) -> bool:
        """Yes: zero."""
        return True

    def receded(self, gap: float) -> Self:
        """Lower by a gap (length)."""
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
        gap[n] = position[1, n] - parameters[0]
        normal[0, n] = 0.0
        normal[1, n] = 1.0
        curvature[n] = 0.0
