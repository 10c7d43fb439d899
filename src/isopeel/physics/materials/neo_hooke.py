"""The compressible neo-Hookean material."""

from dataclasses import dataclass
from functools import cache
from typing import ClassVar, Self

import numpy as np

from isopeel.arrays import FloatArray
from isopeel.errors import InputError
from isopeel.physics.batch import MATERIAL_SIGNATURE, BatchFunction, compile_batch
from isopeel.quantities import Number, Stress


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
) -> None:
    mu = parameters[0]
    lam = parameters[1]
    for n in range(count):
        J = F[0, 0, n] * F[1, 1, n] - F[0, 1, n] * F[1, 0, n]
        # an inverted point has no energy: nan tells the solver, which then finds the point
        log_J = np.log(J) if J > 0.0 else np.nan
        G00 = F[1, 1, n] / J  # G = F^-1
        G01 = -F[0, 1, n] / J
        G10 = -F[1, 0, n] / J
        G11 = F[0, 0, n] / J
        square = F[0, 0, n] ** 2 + F[0, 1, n] ** 2 + F[1, 0, n] ** 2 + F[1, 1, n] ** 2
        energy[n] = 0.5 * mu * (square - 2.0 - 2.0 * log_J) + 0.5 * lam * log_J * log_J
        c = lam * log_J - mu
        P[0, 0, n] = mu * F[0, 0, n] + c * G00
        P[0, 1, n] = mu * F[0, 1, n] + c * G10
        P[1, 0, n] = mu * F[1, 0, n] + c * G01
        P[1, 1, n] = mu * F[1, 1, n] + c * G11
        # dP_iJ/dF_kL = mu d_ik d_JL - c G_Jk G_Li + lambda G_Ji G_Lk
        A[0, 0, 0, 0, n] = mu + (lam - c) * G00 * G00
        A[0, 0, 0, 1, n] = (lam - c) * G00 * G10
        A[0, 0, 1, 0, n] = (lam - c) * G00 * G01
        A[0, 0, 1, 1, n] = lam * G00 * G11 - c * G01 * G10
        A[0, 1, 0, 0, n] = A[0, 0, 0, 1, n]
        A[0, 1, 0, 1, n] = mu + (lam - c) * G10 * G10
        A[0, 1, 1, 0, n] = lam * G10 * G01 - c * G11 * G00
        A[0, 1, 1, 1, n] = (lam - c) * G10 * G11
        A[1, 0, 0, 0, n] = A[0, 0, 1, 0, n]
        A[1, 0, 0, 1, n] = A[0, 1, 1, 0, n]
        A[1, 0, 1, 0, n] = mu + (lam - c) * G01 * G01
        A[1, 0, 1, 1, n] = (lam - c) * G01 * G11
        A[1, 1, 0, 0, n] = A[0, 0, 1, 1, n]
        A[1, 1, 0, 1, n] = A[0, 1, 1, 1, n]
        A[1, 1, 1, 0, n] = A[1, 0, 1, 1, n]
        A[1, 1, 1, 1, n] = mu + (lam - c) * G11 * G11
