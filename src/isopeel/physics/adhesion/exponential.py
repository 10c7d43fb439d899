"""The exponential cohesive law."""

from dataclasses import dataclass
from functools import cache
from typing import ClassVar, Self

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.quantities import Length, Stress, SurfaceEnergy
from isopeel.physics.adhesion.cohesive import check_cohesive
from isopeel.physics.batch import ADHESION_SIGNATURE, BatchFunction, compile_batch


@dataclass(frozen=True)
class Exponential:
    """Normal traction T(x) = -W/d^2 x exp(-x/d) over the opening x: strongest, W/(e d), at x = d.

    The normal part of the law of Xu and Needleman (J. Mech. Phys. Solids 42, 1994); linear in compression, at
    the initial stiffness W/d^2. The opening is the gap less `equilibrium_gap` (length), whatever the
    curvature of the substrate.

    strength: largest attraction, a stress; work_of_adhesion: W, the energy per area to part the surfaces.
    Raises InputError unless both are positive.
    """

    name: ClassVar[str] = "exponential"
    strength: Stress
    work_of_adhesion: SurfaceEnergy
    equilibrium_gap: Length = 0.0

    def __post_init__(self) -> None:
        """Check the constants."""
        check_cohesive(self.strength, self.work_of_adhesion, self.equilibrium_gap)

    @property
    def characteristic_length(self) -> float:
        """d = W / (e strength), the opening of strongest attraction."""
        return float(self.work_of_adhesion / (np.e * self.strength))

    @classmethod
    def like(cls, strength: float, work_of_adhesion: float, equilibrium_gap: float) -> Self:
        """The law of this strength, work and gap."""
        return cls(strength, work_of_adhesion, equilibrium_gap)

    @property
    def parameters(self) -> FloatArray:
        """Gap r_eq, work W and length d."""
        return np.array(
            [self.equilibrium_gap, self.work_of_adhesion, self.characteristic_length], dtype=np.float64
        )

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of potential, traction and its derivative."""
        return _compiled()


@cache
def _compiled() -> BatchFunction:
    return compile_batch(ADHESION_SIGNATURE, _exponential)


def _exponential(
    gap: FloatArray,
    _curvature: FloatArray,
    parameters: FloatArray,
    count: int,
    potential: FloatArray,
    traction: FloatArray,
    derivative: FloatArray,
) -> None:
    work = parameters[1]
    length = parameters[2]
    stiffness = work / (length * length)
    for n in range(count):
        x = gap[n] - parameters[0]
        if x <= 0.0:
            potential[n] = 0.5 * stiffness * x * x - work
            traction[n] = -stiffness * x
            derivative[n] = -stiffness
        else:
            z = x / length
            decay = np.exp(-z)
            potential[n] = -work * (1.0 + z) * decay
            traction[n] = -stiffness * x * decay
            derivative[n] = -stiffness * (1.0 - z) * decay
