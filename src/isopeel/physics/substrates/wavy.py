"""A substrate with a cosine wave."""

from dataclasses import dataclass, replace
from functools import cache
from typing import ClassVar, Self

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.quantities import Angle, Length
from isopeel.physics.batch import SUBSTRATE_SIGNATURE, BatchFunction, compile_batch
from isopeel.physics.substrates.closest_point import project_on_wave


@dataclass(frozen=True)
class Wavy:
    """Solid below y = height + amplitude cos(2 pi x / wavelength + phase); lengths, and the phase in radians.

    The closest point is the true one at any distance and for any amplitude. Above a trough, farther than its
    curvature radius wavelength^2 / (4 pi^2 amplitude), two points are equally close: there the normal jumps.
    Without a height the crests are at y = 0. Raises InputError unless the wavelength is positive and the
    amplitude is not negative.
    """

    name: ClassVar[str] = "wavy"
    amplitude: Length
    wavelength: Length
    phase: Angle = 0.0
    height: Length | None = None

    def __post_init__(self) -> None:
        """Check the wave."""
        if not 0 <= self.amplitude < np.inf:
            raise InputError("substrate.amplitude", self.amplitude, "it must be zero or positive")
        if not 0 < self.wavelength < np.inf:
            raise InputError("substrate.wavelength", self.wavelength, "it must be positive")
        for name, value in (("height", self.mean_height), ("phase", self.phase)):
            if not np.isfinite(value):
                raise InputError(f"substrate.{name}", value, "it must be finite")

    @property
    def mean_height(self) -> float:
        """The height, given or not."""
        return -self.amplitude if self.height is None else self.height

    @property
    def parameters(self) -> FloatArray:
        """Height, amplitude, wave number 2 pi / wavelength, and phase."""
        return np.array([self.mean_height, self.amplitude, 2 * np.pi / self.wavelength, self.phase])

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of gap, normal and curvature."""
        return _compiled()

    @property
    def constant_curvature(self) -> bool:
        """No."""
        return False

    def receded(self, gap: float) -> Self:
        """Lower by a gap (length)."""
        return replace(self, height=self.mean_height - gap)


@cache
def _compiled() -> BatchFunction:
    return compile_batch(SUBSTRATE_SIGNATURE, project_on_wave)
