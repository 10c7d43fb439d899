"""The compressible Yeoh material."""

from dataclasses import dataclass
from functools import cache
from typing import ClassVar, Self

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.quantities import Stress
from isopeel.physics.batch import MATERIAL_SIGNATURE, BatchFunction, compile_batch


@dataclass(frozen=True)
class Yeoh:
    """Yeoh solid in plane strain, of decoupled (isochoric and volumetric) form.

    psi = c10 x + c20 x^2 + c30 x^3 + kappa/2 (J - 1)^2 with x = J^(-2/3) I1 - 3, the invariant I1 of F^T F in
    three dimensions, F_33 = 1, and the bulk modulus kappa (Holzapfel, Nonlinear Solid Mechanics, Secs. 6.4
    and 6.5; Yeoh, Rubber Chem. Technol. 66, 1993). Codes that want D1 write kappa = 2/D1, and no D2, D3. All
    constants are stresses; energies are nan where J <= 0. Raises InputError unless c10 > 0 and kappa > 0.
    """

    name: ClassVar[str] = "yeoh"
    c10: Stress
    c20: Stress
    c30: Stress
    bulk_modulus: Stress

    def __post_init__(self) -> None:
        """Check that the state of rest is stable."""
        for name in ("c10", "bulk_modulus"):
            if not 0 < getattr(self, name) < np.inf:
                raise InputError(f"material.{name}", getattr(self, name), "it must be positive")
        for name in ("c20", "c30"):
            if not np.isfinite(getattr(self, name)):
                raise InputError(f"material.{name}", getattr(self, name), "it must be finite")

    @property
    def shear_modulus(self) -> float:
        """mu = 2 c10 at small strain."""
        return 2 * self.c10

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
        """The material of these constants at small strain, each coefficient a tenth of the one before."""
        c10 = youngs_modulus / (4 * (1 + poissons_ratio))
        return cls(c10, c10 / 10, c10 / 100, youngs_modulus / (3 * (1 - 2 * poissons_ratio)))

    @property
    def parameters(self) -> FloatArray:
        """c10, c20, c30 and kappa."""
        return np.array([self.c10, self.c20, self.c30, self.bulk_modulus], dtype=np.float64)

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of energy density, stress and tangent."""
        return _compiled()

    def out_of_plane_stress(self, deformation_gradient: FloatArray) -> FloatArray:
        """Cauchy stress sigma_33 = (2/3) W'(x) J^(-5/3) (2 - F:F) + kappa (J - 1) (...) for F (..., 2, 2).

        W'(x) = c10 + 2 c20 x + 3 c30 x^2.
        """
        square = np.square(deformation_gradient).sum(axis=(-2, -1))
        J = np.linalg.det(deformation_gradient)
        x = J ** (-2 / 3) * (square + 1) - 3
        slope = self.c10 + 2 * self.c20 * x + 3 * self.c30 * x**2
        stress: FloatArray = 2 / 3 * slope * J ** (-5 / 3) * (2 - square) + self.bulk_modulus * (J - 1)
        return stress


@cache
def _compiled() -> BatchFunction:
    return compile_batch(MATERIAL_SIGNATURE, _yeoh)


def _yeoh(
    F: FloatArray,
    parameters: FloatArray,
    count: int,
    energy: FloatArray,
    P: FloatArray,
    A: FloatArray,
    tangent: bool,
) -> None:
    c10 = parameters[0]
    c20 = parameters[1]
    c30 = parameters[2]
    kappa = parameters[3]
    for n in range(count):
        F00 = F[0, 0, n]
        F01 = F[0, 1, n]
        F10 = F[1, 0, n]
        F11 = F[1, 1, n]
        J = F00 * F11 - F01 * F10
        # an inverted point has no energy: nan tells the solver, which then finds the point
        scale = J ** (-2.0 / 3.0) if J > 0.0 else np.nan
        inverse_J = 1.0 / J
        # F_33 = 1 makes I1 = F:F + 1
        first = scale * (F00 * F00 + F01 * F01 + F10 * F10 + F11 * F11 + 1.0)
        x = first - 3.0
        energy[n] = ((c30 * x + c20) * x + c10) * x + 0.5 * kappa * (J - 1.0) ** 2
        slope = (3.0 * c30 * x + 2.0 * c20) * x + c10
        curvature = 6.0 * c30 * x + 2.0 * c20
        # P = a F + p C with a = 2 d psi/d(F:F), p = d psi/dJ and the cofactors C = dJ/dF
        x_J = -2.0 / 3.0 * inverse_J * first
        a = 2.0 * slope * scale
        p = slope * x_J + kappa * (J - 1.0)
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
        # dP_iJ/dF_kL = a d_ik d_JL + F_iJ H_kL + C_iJ D_kL + p dC_iJ/dF_kL,
        # H = 2 da/d(F:F) F + da/dJ C and D = da/dJ F + dp/dJ C
        a_F = 4.0 * curvature * scale * scale
        a_J = 2.0 * scale * (curvature * x_J - 2.0 / 3.0 * inverse_J * slope)
        p_J = curvature * x_J * x_J + 10.0 / 9.0 * inverse_J * inverse_J * slope * first + kappa
        H00 = a_F * F00 + a_J * C00
        H01 = a_F * F01 + a_J * C01
        H10 = a_F * F10 + a_J * C10
        H11 = a_F * F11 + a_J * C11
        D00 = a_J * F00 + p_J * C00
        D01 = a_J * F01 + p_J * C01
        D10 = a_J * F10 + p_J * C10
        D11 = a_J * F11 + p_J * C11
        A[0, 0, 0, 0, n] = a + F00 * H00 + C00 * D00
        A[0, 0, 0, 1, n] = F00 * H01 + C00 * D01
        A[0, 0, 1, 0, n] = F00 * H10 + C00 * D10
        A[0, 0, 1, 1, n] = F00 * H11 + C00 * D11 + p
        A[0, 1, 0, 0, n] = A[0, 0, 0, 1, n]
        A[0, 1, 0, 1, n] = a + F01 * H01 + C01 * D01
        A[0, 1, 1, 0, n] = F01 * H10 + C01 * D10 - p
        A[0, 1, 1, 1, n] = F01 * H11 + C01 * D11
        A[1, 0, 0, 0, n] = A[0, 0, 1, 0, n]
        A[1, 0, 0, 1, n] = A[0, 1, 1, 0, n]
        A[1, 0, 1, 0, n] = a + F10 * H10 + C10 * D10
        A[1, 0, 1, 1, n] = F10 * H11 + C10 * D11
        A[1, 1, 0, 0, n] = A[0, 0, 1, 1, n]
        A[1, 1, 0, 1, n] = A[0, 1, 1, 1, n]
        A[1, 1, 1, 0, n] = A[1, 0, 1, 1, n]
        A[1, 1, 1, 1, n] = a + F11 * H11 + C11 * D11
