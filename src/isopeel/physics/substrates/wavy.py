"""A substrate with a cosine wave."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from isopeel.arrays import FloatArray
from isopeel.errors import InputError
from isopeel.physics.batch import SUBSTRATE_SIGNATURE, BatchFunction, compile_batch
from isopeel.physics.substrates.closest_point import project_on_wave


@dataclass(frozen=True)
class Wavy:
    """Solid below y = height + amplitude cos(2 pi x / wavelength + phase); lengths, and the phase in radians.

    The closest point is the true one at any distance and for any amplitude. Above a trough, farther than its
    curvature radius wavelength^2 / (4 pi^2 amplitude), two points are equally close: there the normal jumps.
    Raises InputError unless the wavelength is positive and the amplitude is not negative.
    """

    height: float
    amplitude: float
    wavelength: float
    phase: float = 0.0

    def __post_init__(self) -> None:
        """Check the wave."""
        for name in ("height", "phase"):
            if not np.isfinite(getattr(self, name)):
                raise InputError(f"substrate.{name}", getattr(self, name), "it must be finite")
        if not 0 <= self.amplitude < np.inf:
            raise InputError("substrate.amplitude", self.amplitude, "it must be zero or positive")
        if not 0 < self.wavelength < np.inf:
            raise InputError("substrate.wavelength", self.wavelength, "it must be positive")

    @property
    def parameters(self) -> FloatArray:
        """Height, amplitude, wave number 2 pi / wavelength, and phase."""
        return np.array([self.height, self.amplitude, 2 * np.pi / self.wavelength, self.phase])

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of gap, normal and curvature."""
        return _compiled()


@cache
def _compiled() -> BatchFunction:
    return compile_batch(SUBSTRATE_SIGNATURE, project_on_wave)
