"""The compressible Mooney-Rivlin material."""

from dataclasses import dataclass
from functools import cache
from typing import ClassVar, Self

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.quantities import Stress
from isopeel.physics.batch import MATERIAL_SIGNATURE, BatchFunction, compile_batch


@dataclass(frozen=True)
class MooneyRivlin:
    """Mooney-Rivlin solid in plane strain, of decoupled (isochoric and volumetric) form.

    psi = c10 (J^(-2/3) I1 - 3) + c01 (J^(-4/3) I2 - 3) + kappa/2 (J - 1)^2 with the invariants I1, I2 of
    F^T F in three dimensions, F_33 = 1, and the bulk modulus kappa (Holzapfel, Nonlinear Solid Mechanics,
    Secs. 6.4 and 6.5; Mooney, J. Appl. Phys. 11, 1940). Codes that want D1 write kappa = 2/D1. All constants
    are stresses; energies are nan where J <= 0. Raises InputError unless c10 + c01 > 0 and kappa > 0.
    """

    name: ClassVar[str] = "mooney-rivlin"
    c10: Stress
    c01: Stress
    bulk_modulus: Stress

    def __post_init__(self) -> None:
        """Check that the state of rest is stable."""
        for name in ("c10", "c01"):
            if not np.isfinite(getattr(self, name)):
                raise InputError(f"material.{name}", getattr(self, name), "it must be finite")
        if not self.c10 + self.c01 > 0:
            allowed = "it must be positive: it is half the shear modulus at rest"
            raise InputError("material.c10 + c01", self.c10 + self.c01, allowed)
        if not 0 < self.bulk_modulus < np.inf:
            raise InputError("material.bulk_modulus", self.bulk_modulus, "it must be positive")

    @property
    def shear_modulus(self) -> float:
        """mu = 2 (c10 + c01) at small strain."""
        return 2 * (self.c10 + self.c01)

    @property
    def youngs_modulus(self) -> float:
        """E = 9 kappa mu / (3 kappa + mu) at small strain."""
        return 9 * self.bulk_modulus * self.shear_modulus / (3 * self.bulk_modulus + self.shear_modulus)

    @property
    def poissons_ratio(self) -> float:
        """nu = (3 kappa - 2 mu) / (6 kappa + 2 mu) at small strain."""
        bulk, shear = self.bulk_modulus, self.shear_modulus
        return (3 * bulk - 2 * shear) / (6 * bulk + 2 * shear)

    @classmethod
    def like(cls, youngs_modulus: float, poissons_ratio: float) -> Self:
        """The material of these constants at small strain, c10 = c01."""
        quarter = youngs_modulus / (8 * (1 + poissons_ratio))
        return cls(quarter, quarter, youngs_modulus / (3 * (1 - 2 * poissons_ratio)))

    @property
    def parameters(self) -> FloatArray:
        """c10, c01 and kappa."""
        return np.array([self.c10, self.c01, self.bulk_modulus], dtype=np.float64)

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of energy density, stress and tangent."""
        return _compiled()

    def out_of_plane_stress(self, deformation_gradient: FloatArray) -> FloatArray:
        """Cauchy stress sigma_33 (...) for F (..., 2, 2).

        sigma_33 = 2/3 [c10 J^(-5/3) (2 - F:F) + c01 J^(-7/3) (F:F - 2 J^2)] + kappa (J - 1).
        """
        square = np.square(deformation_gradient).sum(axis=(-2, -1))
        J = np.linalg.det(deformation_gradient)
        first = self.c10 * J ** (-5 / 3) * (2 - square)
        second = self.c01 * J ** (-7 / 3) * (square - 2 * J**2)
        stress: FloatArray = 2 / 3 * (first + second) + self.bulk_modulus * (J - 1)
        return stress


@cache
def _compiled() -> BatchFunction:
    return compile_batch(MATERIAL_SIGNATURE, _mooney_rivlin)


def _mooney_rivlin(
    F: FloatArray,
    parameters: FloatArray,
    count: int,
    energy: FloatArray,
    P: FloatArray,
    A: FloatArray,
    tangent: bool,
) -> None:
    kappa = parameters[2]
    for n in range(count):
        F00 = F[0, 0, n]
        F01 = F[0, 1, n]
        F10 = F[1, 0, n]
        F11 = F[1, 1, n]
        J = F00 * F11 - F01 * F10
        # an inverted point has no energy: nan tells the solver, which then finds the point
        scale = J ** (-2.0 / 3.0) if J > 0.0 else np.nan
        inverse_J = 1.0 / J
        c1 = parameters[0] * scale
        c2 = parameters[1] * scale * scale
        # F_33 = 1 makes I1 = F:F + 1 and I2 = F:F + J^2, so psi depends on F:F and J alone
        square = F00 * F00 + F01 * F01 + F10 * F10 + F11 * F11
        energy[n] = (
            c1 * (square + 1.0)
            + c2 * (square + J * J)
            - 3.0 * (parameters[0] + parameters[1])
            + 0.5 * kappa * (J - 1.0) ** 2
        )
        # P = a F + p C with a = 2 d psi/d(F:F), p = d psi/dJ and the cofactors C = dJ/dF
        a = 2.0 * (c1 + c2)
        p = -2.0 / 3.0 * inverse_J * (c1 * (square + 1.0) + c2 * (2.0 * square - J * J)) + kappa * (J - 1.0)
        C00 = F11
        C01 = -F10
        C10 = -F01
        C11 = F00
        P[0, 0, n] = a * F00 + p * C00
        P[0, 1, n] = a * F01 + p * C01
        P[1, 0, n] = a * F10 + p * C10
        P[1, 1, n] = a * F11 + p * C11
        if not tangent:
            continue
        # dP_iJ/dF_kL = a d_ik d_JL + C_iJ D_kL + D_iJ C_kL + p dC_iJ/dF_kL, D = da/dJ F + 1/2 dp/dJ C
        a_J = -4.0 / 3.0 * inverse_J * (c1 + 2.0 * c2)
        half_p_J = (
            inverse_J * inverse_J / 9.0 * (5.0 * c1 * (square + 1.0) + 14.0 * c2 * square)
            - c2 / 9.0
            + 0.5 * kappa
        )
        D00 = a_J * F00 + half_p_J * C00
        D01 = a_J * F01 + half_p_J * C01
        D10 = a_J * F10 + half_p_J * C10
        D11 = a_J * F11 + half_p_J * C11
        A[0, 0, 0, 0, n] = a + 2.0 * C00 * D00
        A[0, 0, 0, 1, n] = C00 * D01 + D00 * C01
        A[0, 0, 1, 0, n] = C00 * D10 + D00 * C10
        A[0, 0, 1, 1, n] = C00 * D11 + D00 * C11 + p
        A[0, 1, 0, 0, n] = A[0, 0, 0, 1, n]
        A[0, 1, 0, 1, n] = a + 2.0 * C01 * D01
        A[0, 1, 1, 0, n] = C01 * D10 + D01 * C10 - p
        A[0, 1, 1, 1, n] = C01 * D11 + D01 * C11
        A[1, 0, 0, 0, n] = A[0, 0, 1, 0, n]
        A[1, 0, 0, 1, n] = A[0, 1, 1, 0, n]
        A[1, 0, 1, 0, n] = a + 2.0 * C10 * D10
        A[1, 0, 1, 1, n] = C10 * D11 + D10 * C11
        A[1, 1, 0, 0, n] = A[0, 0, 1, 1, n]
        A[1, 1, 0, 1, n] = A[0, 1, 1, 1, n]
        A[1, 1, 1, 0, n] = A[1, 0, 1, 1, n]
        A[1, 1, 1, 1, n] = a + 2.0 * C11 * D11
