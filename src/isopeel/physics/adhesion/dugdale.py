"""Dugdale's law of constant attraction, its ends smoothed."""

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
class Dugdale:
    """Constant attraction up to a critical opening W / strength, reached and left smoothly.

    The law of Dugdale (J. Mech. Phys. Solids 8, 1960), for adhesion by Maugis (J. Colloid Interface Sci. 150,
    1992). Over the first a = `transition` * W / strength of the opening x it rises as u (3 - u^2)/2, u = x/a,
    and over the last a it falls as 1 - v^2 (3 - 2 v), with v from 0 to 1; W stays the work. So the traction
    has no kinks, and goes on into compression with its initial stiffness, 3/2 strength / a. The opening is
    the gap less `equilibrium_gap` (length), whatever the curvature of the substrate.

    strength: largest attraction, a stress; work_of_adhesion: energy per area to part the surfaces. Raises
    InputError unless both are positive and 0 < transition <= 8/9, where no plateau is left.
    """

    name: ClassVar[str] = "dugdale"
    strength: Stress
    work_of_adhesion: SurfaceEnergy
    transition: Number
    equilibrium_gap: Length = 0.0

    def __post_init__(self) -> None:
        """Check the constants."""
        check_cohesive(self.strength, self.work_of_adhesion, self.equilibrium_gap)
        if not 0 < self.transition <= 8 / 9:
            raise InputError("adhesion.transition", self.transition, "it must lie in (0, 8/9]")

    @classmethod
    def like(cls, strength: float, work_of_adhesion: float, equilibrium_gap: float) -> Self:
        """The law of this strength, work and gap."""
        return cls(strength, work_of_adhesion, 0.3, equilibrium_gap)

    @property
    def parameters(self) -> FloatArray:
        """Gap r_eq, strength, work W, the length a of rise and fall, the opening at which the fall begins."""
        critical = self.work_of_adhesion / self.strength
        # rise and fall take 5/8 and 1/2 of what a constant attraction over their length takes
        start = critical * (1 - self.transition / 8)
        numbers = (self.strength, self.work_of_adhesion, self.transition * critical, start)
        return np.array([self.equilibrium_gap, *numbers], dtype=np.float64)

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of potential, traction and its derivative."""
        return _compiled()


@cache
def _compiled() -> BatchFunction:
    return compile_batch(ADHESION_SIGNATURE, _dugdale)


def _dugdale(
    gap: FloatArray,
    _curvature: FloatArray,
    parameters: FloatArray,
    count: int,
    potential: FloatArray,
    traction: FloatArray,
    derivative: FloatArray,
) -> None:
    strength = parameters[1]
    work = parameters[2]
    length = parameters[3]
    start = parameters[4]
    for n in range(count):
        x = gap[n] - parameters[0]
        u = x / length
        rest = 1.0 - (x - start) / length
        if u <= 0.0:
            potential[n] = 0.75 * strength * x * u - work
            traction[n] = -1.5 * strength * u
            derivative[n] = -1.5 * strength / length
        elif u < 1.0:
            potential[n] = strength * x * u * (0.75 - 0.125 * u * u) - work
            traction[n] = -0.5 * strength * u * (3.0 - u * u)
            derivative[n] = -1.5 * strength / length * (1.0 - u * u)
        elif rest >= 1.0:
            potential[n] = strength * (x - 0.375 * length) - work
            traction[n] = -strength
            derivative[n] = 0.0
        elif rest <= 0.0:
            potential[n] = 0.0
            traction[n] = 0.0
            derivative[n] = 0.0
        else:
            potential[n] = -strength * length * rest**3 * (1.0 - 0.5 * rest)
            traction[n] = -strength * rest * rest * (3.0 - 2.0 * rest)
            derivative[n] = 6.0 * strength / length * rest * (1.0 - rest)
