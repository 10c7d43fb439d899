"""A material that lies stretched in the body's reference shape."""

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.physics.batch import (
    MATERIAL_SIGNATURE,
    BatchFunction,
    compile_batch,
    evaluate_material,
    material_at,
)
from isopeel.physics.materials.base import Material

#: Transverse stretches that the unstressed one is looked for at, 2 % apart, with 1 among them.
_STRETCHES = np.geomspace(1e-4, 1e4, 2 * 465 + 1)


@dataclass(frozen=True)
class Prestretched:
    """A material stretched along x before the body takes its reference shape, as a tape when it is laid.

    F_0 = diag(stretch, s) brings it there, with the s that leaves it free of stress across; F_33 stays 1.
    With J_0 = stretch s, per volume and area of the reference shape: psi(F) = psi_m(F F_0)/J_0 and
    P(F) = P_m(F F_0) F_0^T/J_0 of the material m. Under F = I the stress P_11 pulls along x. Raises
    InputError unless the stretch is positive and there is such an s.
    """

    material: Material
    stretch: float

    def __post_init__(self) -> None:
        """Check the stretch."""
        if not 0 < self.stretch < np.inf:
            raise InputError("material.prestretch", self.stretch, "it must be positive")
        if not np.isfinite(self.transverse_stretch):
            allowed = "the stretched material must be free of stress across at some thickness"
            raise InputError("material.prestretch", self.stretch, allowed)

    @cached_property
    def transverse_stretch(self) -> float:
        """The s nearest to 1 at which the stress P_22 rises through zero; nan where there is none."""
        from scipy.optimize import brentq

        stress = self._transverse_stress(_STRETCHES)
        rises = np.flatnonzero((stress[:-1] < 0) & (stress[1:] >= 0))
        if not rises.size:
            return float("nan")
        at = rises[np.argmin(np.abs(np.log(_STRETCHES[rises])))]
        bracket = _STRETCHES[at], _STRETCHES[at + 1]
        return float(brentq(lambda s: self._transverse_stress(np.array([s]))[0], *bracket, xtol=1e-300))

    @property
    def youngs_modulus(self) -> float:
        """That of the material, unstretched."""
        return self.material.youngs_modulus

    @property
    def poissons_ratio(self) -> float:
        """That of the material, unstretched."""
        return self.material.poissons_ratio

    @property
    def parameters(self) -> FloatArray:
        """The address of the material's kernel, which a float holds exactly, stretches and its parameters."""
        own = self.material.kernel.address, self.stretch, self.transverse_stretch
        return np.array([*own, *self.material.parameters], dtype=np.float64)

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of energy density, stress and tangent: one for all materials."""
        return _compiled()

    def solid_response(self, deformation_gradient: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Energy density (...), P (..., 3, 3) and dP/dF (..., 3, 3, 3, 3) at F (..., 3, 3)."""
        F_0 = np.array([self.stretch, self.transverse_stretch, 1.0])
        energy, P, A = self.material.solid_response(deformation_gradient * F_0)
        return energy / F_0.prod(), P * F_0 / F_0.prod(), A * F_0[:, None, None] * F_0 / F_0.prod()

    def out_of_plane_stress(self, deformation_gradient: FloatArray) -> FloatArray:
        """Cauchy stress sigma_33 (...) of the material at F F_0, for F (..., 2, 2)."""
        return self.material.out_of_plane_stress(
            deformation_gradient * np.array([self.stretch, self.transverse_stretch])
        )

    def _transverse_stress(self, transverse: FloatArray) -> FloatArray:
        """P_22 (n) of the material at diag(stretch, s) for s (n)."""
        F = np.zeros((transverse.size, 2, 2))
        F[:, 0, 0] = self.stretch
        F[:, 1, 1] = transverse
        _, P, _ = evaluate_material(self.material.kernel, self.material.parameters, F)
        return P[:, 1, 1]


@cache
def _compiled() -> BatchFunction:
    return compile_batch(MATERIAL_SIGNATURE, _prestretched)


def _prestretched(
    F: FloatArray,
    parameters: FloatArray,
    count: int,
    energy: FloatArray,
    P: FloatArray,
    A: FloatArray,
    tangent: bool,
) -> None:
    material = material_at(int(parameters[0]))
    F_0 = parameters[1:3]
    J_0 = F_0[0] * F_0[1]
    elastic = np.empty((2, 2, count))
    for i in range(2):
        for J in range(2):
            for n in range(count):
                elastic[i, J, n] = F[i, J, n] * F_0[J]
    material(elastic, parameters[3:], count, energy, P, A, tangent)
    for n in range(count):
        energy[n] /= J_0
    for i in range(2):
        for J in range(2):
            for n in range(count):
                P[i, J, n] *= F_0[J] / J_0
            if not tangent:
                continue
            for k in range(2):
                for L in range(2):
                    for n in range(count):
                        A[i, J, k, L, n] *= F_0[J] * F_0[L] / J_0
