"""Adhesion of a body to its own mirror image."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion.base import AdhesionLaw
from isopeel.physics.batch import ADHESION_SIGNATURE, BatchFunction, compile_batch, law_at


@dataclass(frozen=True)
class Mirrored:
    """The law that acts between a body and its mirror image, as a law of the gap g to the mirror plane.

    For symmetric problems, such as the double cantilever beam, of which one half is modelled: `law` acts over
    the separation 2 g of the two faces, so that T = T_law(2 g). One half has one half of the energy,
    Phi = Phi_law(2 g)/2, and -dPhi/dg = T. The mirror plane is a `Flat` substrate; a curvature is passed on.
    """

    law: AdhesionLaw

    @property
    def parameters(self) -> FloatArray:
        """The address of the law's kernel, which a float holds exactly, and the law's parameters."""
        return np.array([self.law.kernel.address, *self.law.parameters], dtype=np.float64)

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of potential, traction and its derivative: one for all laws."""
        return _compiled()

    @property
    def equilibrium_gap(self) -> float:
        """Half of the law's: the distance of either face to the mirror plane."""
        return self.law.equilibrium_gap / 2

    @property
    def work_of_adhesion(self) -> float:
        """Half of the law's: the share of the half that is modelled."""
        return self.law.work_of_adhesion / 2


@cache
def _compiled() -> BatchFunction:
    return compile_batch(ADHESION_SIGNATURE, _mirrored)


def _mirrored(
    gap: FloatArray,
    curvature: FloatArray,
    parameters: FloatArray,
    count: int,
    potential: FloatArray,
    traction: FloatArray,
    derivative: FloatArray,
) -> None:
    law = law_at(int(parameters[0]))
    separation = np.empty(count)
    for n in range(count):
        separation[n] = 2.0 * gap[n]
    law(separation, curvature, parameters[1:], count, potential, traction, derivative)
    for n in range(count):
        potential[n] *= 0.5
        derivative[n] *= 2.0
