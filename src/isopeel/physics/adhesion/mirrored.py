"""Adhesion of a body to its own mirror image."""

from dataclasses import dataclass
from functools import cache, lru_cache

import numpy as np
from numba import types, void

from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion.base import AdhesionLaw
from isopeel.physics.batch import ADHESION_SIGNATURE, BatchFunction, compile_batch


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
        """Those of the law."""
        return self.law.parameters

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of potential, traction and its derivative."""
        return _compiled(self.law.kernel)

    @property
    def equilibrium_gap(self) -> float:
        """Half of the law's: the distance of either face to the mirror plane."""
        return self.law.equilibrium_gap / 2

    @property
    def work_of_adhesion(self) -> float:
        """Half of the law's: the share of the half that is modelled."""
        return self.law.work_of_adhesion / 2


@lru_cache(maxsize=64)
def _compiled(law: BatchFunction) -> BatchFunction:
    wrapper = _wrapper()

    def batch(
        gap: FloatArray,
        curvature: FloatArray,
        parameters: FloatArray,
        count: int,
        potential: FloatArray,
        traction: FloatArray,
        derivative: FloatArray,
    ) -> None:
        wrapper(law, gap, curvature, parameters, count, potential, traction, derivative)

    return compile_batch(ADHESION_SIGNATURE, batch, cache=False)


@cache
def _wrapper() -> BatchFunction:
    # called by address it can be stored, and each law needs no more than the call compiled
    signature = void(types.FunctionType(ADHESION_SIGNATURE), *ADHESION_SIGNATURE.args)
    return compile_batch(signature, _mirrored)


def _mirrored(
    law: BatchFunction,
    gap: FloatArray,
    curvature: FloatArray,
    parameters: FloatArray,
    count: int,
    potential: FloatArray,
    traction: FloatArray,
    derivative: FloatArray,
) -> None:
    separation = np.empty(count)
    for n in range(count):
        separation[n] = 2.0 * gap[n]
    law(separation, curvature, parameters, count, potential, traction, derivative)
    for n in range(count):
        potential[n] *= 0.5
        derivative[n] *= 2.0
