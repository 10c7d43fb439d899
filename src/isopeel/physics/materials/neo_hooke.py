"""The compressible neo-Hookean material."""

from dataclasses import dataclass
from functools import cache
from typing import ClassVar, Self

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.quantities import Number, Stress
from isopeel.physics.batch import MATERIAL_SIGNATURE, BatchFunction, compile_batch
from isopeel.physics.logarithm import log


@dataclass(frozen=True)
class NeoHooke:
    """Compressible neo-Hookean solid in plane strain.

    psi = mu/2 (F:F - 2 - 2 ln J) + lambda/2 (ln J)^2, hence P = mu (F - F^-T) + lambda ln J F^-T and
    sigma = (lambda/J) ln J I + (mu/J) (F F^T - I); Bonet and Wood, Nonlinear Continuum Mechanics for Finite
    Element Analysis, the compressible neo-Hookean material. Raises InputError unless E > 0 and
    -1 < nu < 1/2.
    """

    name: ClassVar[str] = "neo-hooke"
    youngs_modulus: Stress
    poissons_ratio: Number

    def __post_init__(self) -> None:
        """Check the elastic constants."""
        if not 0 < self.youngs_modulus < np.inf:
            raise InputError("material.youngs_modulus", self.youngs_modulus, "it must be positive")
        if not -1 < self.poissons_ratio < 0.5:
            raise InputError("material.poissons_ratio", self.poissons_ratio, "it must lie in (-1, 0.5)")

    @property
    def shear_modulus(self) -> float:
        """mu = E / (2 (1 + nu))."""
        return self.youngs_modulus / (2 * (1 + self.poissons_ratio))

    @property
    def lame_lambda(self) -> float:
        """lambda = E nu / ((1 + nu) (1 - 2 nu))."""
        nu = self.poissons_ratio
        return self.youngs_modulus * nu / ((1 + nu) * (1 - 2 * nu))

    @classmethod
    def like(cls, youngs_modulus: float, poissons_ratio: float) -> Self:
        """The material of these elastic constants."""
        return cls(youngs_modulus, poissons_ratio)

    @property
    def parameters(self) -> FloatArray:
        """mu and lambda."""
        return np.array([self.shear_modulus, self.lame_lambda])

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of energy density, stress and tangent."""
        return _compiled()

    def out_of_plane_stress(self, deformation_gradient: FloatArray) -> FloatArray:
        """Cauchy stress sigma_33 = (lambda/J) ln J (...) for F (..., 2, 2)."""
        jacobian = np.linalg.det(deformation_gradient)
        stress: FloatArray = self.lame_lambda * np.log(jacobian) / jacobian
        return stress


@cache
def _compiled() -> BatchFunction:
    return compile_batch(MATERIAL_SIGNATURE, _neo_hooke)


def _neo_hooke(
    F: FloatArray,
    parameters: FloatArray,
    count: int,
    energy: FloatArray,
    P: FloatArray,
    A: FloatArray,
    tangent: bool,
) -> None:
    mu = parameters[0]
    lam = parameters[1]
    J = np.empty(count)
    c = np.empty(count)
    pull = np.empty(count)  # c / J
    # loops over few arrays each: one over all of them could not prove that they do not overlap, and would
    # not run in vector registers
    for n in range(count):
        J[n] = F[0, 0, n] * F[1, 1, n] - F[0, 1, n] * F[1, 0, n]
    for n in range(count):
        # an inverted point has no energy: nan tells the solver, which then finds the point
        log_J = log(J[n])
        c[n] = lam * log_J - mu
        pull[n] = c[n] / J[n]
        energy[n] = (0.5 * lam * log_J - mu) * log_J - mu
    for i in range(2):
        for n in range(count):
            energy[n] += 0.5 * mu * (F[i, 0, n] * F[i, 0, n] + F[i, 1, n] * F[i, 1, n])
        for K in range(2):
            sign = 1.0 if i == K else -1.0
            for n in range(count):
                P[i, K, n] = mu * F[i, K, n] + sign * pull[n] * F[1 - i, 1 - K, n]
    if not tangent:
        return
    G = np.empty((2, 2, count))  # F^-1
    for n in range(count):
        # a division takes as long as ten products
        J[n] = 1.0 / J[n]
    for i in range(2):
        for K in range(2):
            sign = 1.0 if i == K else -1.0
            for n in range(count):
                G[K, i, n] = sign * F[1 - i, 1 - K, n] * J[n]
    for one in range(4):
        for other in range(one + 1):
            i, K, k, L = one // 2, one % 2, other // 2, other % 2
            # dP_iK/dF_kL = mu d_ik d_KL - c G_Kk G_Li + lambda G_Ki G_Lk
            same = mu if one == other else 0.0
            for n in range(count):
                A[i, K, k, L, n] = same - c[n] * G[K, k, n] * G[L, i, n] + lam * G[K, i, n] * G[L, k, n]
            for n in range(count):
                A[k, L, i, K, n] = A[i, K, k, L, n]
