"""A substrate with a cosine wave."""

from dataclasses import replace
from typing import Annotated, Self

import numpy as np

from isopeel.common.compilation import inlined
from isopeel.common.quantities import Angle, Finite, Length, Meaning, NotNegative, Positive
from isopeel.physics.substrates.closest_point import minimum, seen_from
from isopeel.physics.substrates.rigid import RigidSubstrate, substrate


@substrate
class Wavy(RigidSubstrate):
    """Solid below y = height + amplitude cos(2 pi x / wavelength + phase); lengths, and the phase in radians.

    The closest point is the true one at any distance and for any amplitude. Above a trough, farther than its
    curvature radius wavelength^2 / (4 pi^2 amplitude), two points are equally close: there the normal jumps.
    Without a height the crests are at y = 0. Raises InputError unless the wavelength is positive and the
    amplitude is not negative.
    """

    amplitude: Annotated[
        NotNegative[Length], Meaning("half of the height between troughs and crests", "1 nm")
    ]
    wavelength: Annotated[Positive[Length], Meaning("distance of two crests", "50 nm")]
    phase: Annotated[
        Finite[Angle], Meaning("shift of the crests along x, one wavelength for 360 degrees", "90 deg")
    ] = 0.0
    height: Annotated[
        Finite[Length] | None, Meaning("mean height", "0 nm", usual="the crests are at y = 0")
    ] = None

    @property
    def mean_height(self) -> float:
        """The height, given or not."""
        return -self.amplitude if self.height is None else self.height

    def receded(self, gap: float) -> Self:
        """Lower by a gap (length)."""
        return replace(self, height=self.mean_height - gap)

    def constants(self) -> tuple[float, ...]:
        """Height, amplitude, wave number 2 pi / wavelength, and phase."""
        return self.mean_height, self.amplitude, 2 * np.pi / self.wavelength, self.phase

    @staticmethod
    def at_point(
        x: float, y: float, height: float, amplitude: float, number: float, phase: float
    ) -> tuple[float, float, float, float]:
        """Return gap, normal and curvature.

        A crest and a trough next to each other mirror the curve, so that the closest point lies in the same
        half wave as x. There g (see `closest_point`) has one root only: with c the cosine,
        g' = 1 + A^2 + A q (y - h) c - 2 A^2 c^2 for A = a q, positive at c = 0, is positive between two
        places, and beyond them g has the sign that it has at the crest or trough. This holds for points at
        any distance.
        """
        half = np.floor((number * x + phase) / np.pi)
        start = (half * np.pi - phase) / number
        # the half wave as a cosine from 0 to pi, of amplitude A/q of either sign
        A = amplitude * number * (1.0 if half % 2.0 == 0.0 else -1.0)
        B = number * (y - height) * (1.0 if A >= 0.0 else -1.0)
        # the two roots c, without loss of digits: one by the quadratic formula, one by their product
        root = abs(B) + np.sqrt(B * B + 8.0 * (1.0 + A * A))
        large = min(root / (4.0 * abs(A)), 1.0)
        small = min(2.0 * (1.0 + A * A) / (abs(A) * root), 1.0)
        low = start + np.arccos(large if B >= 0.0 else small) / number
        high = start + np.arccos(-small if B >= 0.0 else -large) / number
        wave = height, amplitude, number, phase
        return seen_from(x, y, minimum(_wave, wave, x, y, low, min(max(x, low), high), high))


@inlined
def _wave(x: float, wave: tuple[float, float, float, float]) -> tuple[float, float, float]:
    """Return height, slope and second derivative."""
    height, amplitude, number, phase = wave
    angle = number * x + phase
    cosine = amplitude * np.cos(angle)
    return height + cosine, -amplitude * number * np.sin(angle), -amplitude * number**2 * np.cos(angle)
