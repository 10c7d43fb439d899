"""The trapezoidal cohesive law, its kinks rounded."""

from dataclasses import dataclass
from functools import cache
from typing import ClassVar, Self

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.quantities import Length, Number, Stress, SurfaceEnergy
from isopeel.physics.adhesion.cohesive import check_cohesive
from isopeel.physics.batch import ADHESION_SIGNATURE, BatchFunction, compile_batch


@dataclass(frozen=True)
class Trapezoidal:
    """Attraction that rises linearly with the opening, stays, and falls linearly to zero.

    The law of Tvergaard and Hutchinson (J. Mech. Phys. Solids 40, 1992): `rise` and `plateau` are shares of
    the opening that ends it. This law is averaged over an opening of +- `rounding` times its rise, which puts
    parabolas in the place of its kinks: sharp ones make Newton's method jump to and fro for ever. The average
    has the given strength and work, and rises linearly over the first 1 - `rounding` of the rise; compression
    has the same stiffness. The opening is the gap less `equilibrium_gap` (length), whatever the curvature of
    the substrate.

    strength: largest attraction, a stress; work_of_adhesion: energy per area to part the surfaces. Raises
    InputError unless both are positive, 0 < rise, 0 <= plateau, rise + plateau < 1, and 0 < rounding is at
    most 1 and 1 / (2 rise).
    """

    name: ClassVar[str] = "trapezoidal"
    strength: Stress
    work_of_adhesion: SurfaceEnergy
    rise: Number
    plateau: Number
    rounding: Number = 0.5
    equilibrium_gap: Length = 0.0

    def __post_init__(self) -> None:
        """Check the constants."""
        check_cohesive(self.strength, self.work_of_adhesion, self.equilibrium_gap)
        if not 0 < self.rise < 1:
            raise InputError("adhesion.rise", self.rise, "it must lie in (0, 1)")
        if not 0 <= self.plateau < 1 - self.rise:
            raise InputError("adhesion.plateau", self.plateau, "it must be at least 0 and less than 1 - rise")
        if not 0 < self.rounding <= min(1, 0.5 / self.rise):
            raise InputError("adhesion.rounding", self.rounding, "it must be in (0, 1], at most 1 / (2 rise)")

    @classmethod
    def like(cls, strength: float, work_of_adhesion: float, equilibrium_gap: float) -> Self:
        """The law of this strength, work and gap."""
        return cls(strength, work_of_adhesion, 0.2, 0.4, equilibrium_gap=equilibrium_gap)

    @property
    def parameters(self) -> FloatArray:
        """Gap r_eq, work W, slopes of rise and fall, half-width of the average, openings of the kinks."""
        up, down = 1 / self.rise, 1 / (1 - self.rise - self.plateau)
        width = self.rounding * self.rise
        # what the average leaves of a sharp law of strength 1 that ends at 1: its peak is lower where the
        # average around it meets rise and fall, its work lacks the corners
        overlap = max(2 * width - self.plateau, 0.0)
        peak = 1 - overlap**2 / (4 * width) * up * down / (up + down)
        work = (1 + self.plateau) / 2 - width**2 * up / 6
        stress = self.strength / peak
        length = self.work_of_adhesion / (stress * work)
        slopes = np.array([up, down]) * (stress / length)
        openings = np.array([width, self.rise, self.rise + self.plateau, 1.0]) * length
        return np.array([self.equilibrium_gap, self.work_of_adhesion, *slopes, *openings], dtype=np.float64)

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of potential, traction and its derivative."""
        return _compiled()


@cache
def _compiled() -> BatchFunction:
    return compile_batch(ADHESION_SIGNATURE, _trapezoidal)


def _trapezoidal(
    gap: FloatArray,
    _curvature: FloatArray,
    parameters: FloatArray,
    count: int,
    potential: FloatArray,
    traction: FloatArray,
    derivative: FloatArray,
) -> None:
    work = parameters[1]
    rise = parameters[2]
    fall = parameters[3]
    width = parameters[4]
    changes = (-rise, -fall, fall)
    for n in range(count):
        x = gap[n] - parameters[0]
        # the straight line at one end and a ramp from each kink on; beginning at the nearer end, where the
        # line is the rise or zero, few terms cancel
        if x <= parameters[5]:
            side = 1.0
            Phi = 0.5 * rise * x * x - work
            T = -rise * x
            dT = -rise
        else:
            side = -1.0
            Phi = 0.0
            T = 0.0
            dT = 0.0
        for kink in range(3):
            past = side * (x - parameters[5 + kink])
            change = changes[kink]
            if past >= width:
                Phi += side * change * (0.5 * past * past + width * width / 6.0)
                T -= change * past
                dT -= side * change
            elif not past <= -width:  # nan stays nan
                share = 0.5 + 0.5 * past / width
                Phi += side * change * width * width * share**3 / 1.5
                T -= change * width * share * share
                dT -= side * change * share
        potential[n] = Phi
        traction[n] = T
        derivative[n] = dT
