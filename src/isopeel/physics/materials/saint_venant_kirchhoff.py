"""The Saint Venant-Kirchhoff material."""

from dataclasses import dataclass
from functools import cache
from typing import ClassVar, Self

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.quantities import Number, Stress
from isopeel.physics.batch import MATERIAL_SIGNATURE, BatchFunction, compile_batch


@dataclass(frozen=True)
class SaintVenantKirchhoff:
    """Hooke's law between E = (F^T F - I)/2 and S in plane strain: large rotations, moderate strains.

    psi = lambda/2 (tr E)^2 + mu E:E, hence S = lambda tr(E) I + 2 mu E and P = F S (Holzapfel, Nonlinear
    Solid Mechanics, Sec. 6.5). It softens in compression, has no stiffness left at the stretch 1/sqrt(3), and
    stays finite where J <= 0, so that only det F shows an inverted point. Raises InputError unless E > 0 and
    -1 < nu < 1/2.
    """

    name: ClassVar[str] = "saint-venant-kirchhoff"
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
        """Cauchy stress sigma_33 = (lambda/J) tr E (...) for F (..., 2, 2)."""
        trace = (np.square(deformation_gradient).sum(axis=(-2, -1)) - 2) / 2
        stress: FloatArray = self.lame_lambda * trace / np.linalg.det(deformation_gradient)
        return stress


@cache
def _compiled() -> BatchFunction:
    return compile_batch(MATERIAL_SIGNATURE, _saint_venant_kirchhoff)


def _saint_venant_kirchhoff(
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
    for n in range(count):
        F00 = F[0, 0, n]
        F01 = F[0, 1, n]
        F10 = F[1, 0, n]
        F11 = F[1, 1, n]
        E00 = 0.5 * (F00 * F00 + F10 * F10 - 1.0)
        E01 = 0.5 * (F00 * F01 + F10 * F11)
        E11 = 0.5 * (F01 * F01 + F11 * F11 - 1.0)
        trace = E00 + E11
        energy[n] = 0.5 * lam * trace * trace + mu * (E00 * E00 + 2.0 * E01 * E01 + E11 * E11)
        S00 = lam * trace + 2.0 * mu * E00
        S01 = 2.0 * mu * E01
        S11 = lam * trace + 2.0 * mu * E11
        P[0, 0, n] = F00 * S00 + F01 * S01
        P[0, 1, n] = F00 * S01 + F01 * S11
        P[1, 0, n] = F10 * S00 + F11 * S01
        P[1, 1, n] = F10 * S01 + F11 * S11
        if not tangent:
            continue
        # dP_iJ/dF_kL = d_ik S_JL + lambda F_iJ F_kL + mu (F_iL F_kJ + B_ik d_JL) with B = F F^T
        B00 = mu * (F00 * F00 + F01 * F01)
        B01 = mu * (F00 * F10 + F01 * F11)
        B11 = mu * (F10 * F10 + F11 * F11)
        A[0, 0, 0, 0, n] = S00 + (lam + mu) * F00 * F00 + B00
        A[0, 0, 0, 1, n] = S01 + (lam + mu) * F00 * F01
        A[0, 0, 1, 0, n] = (lam + mu) * F00 * F10 + B01
        A[0, 0, 1, 1, n] = lam * F00 * F11 + mu * F01 * F10
        A[0, 1, 0, 0, n] = A[0, 0, 0, 1, n]
        A[0, 1, 0, 1, n] = S11 + (lam + mu) * F01 * F01 + B00
        A[0, 1, 1, 0, n] = lam * F01 * F10 + mu * F00 * F11
        A[0, 1, 1, 1, n] = (lam + mu) * F01 * F11 + B01
        A[1, 0, 0, 0, n] = A[0, 0, 1, 0, n]
        A[1, 0, 0, 1, n] = A[0, 1, 1, 0, n]
        A[1, 0, 1, 0, n] = S00 + (lam + mu) * F10 * F10 + B11
        A[1, 0, 1, 1, n] = S01 + (lam + mu) * F10 * F11
        A[1, 1, 0, 0, n] = A[0, 0, 1, 1, n]
        A[1, 1, 0, 1, n] = A[0, 1, 1, 1, n]
        A[1, 1, 1, 0, n] = A[1, 0, 1, 1, n]
        A[1, 1, 1, 1, n] = S11 + (lam + mu) * F11 * F11 + B11
