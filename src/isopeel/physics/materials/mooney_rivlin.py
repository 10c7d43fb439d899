"""The compressible Mooney-Rivlin material."""

from typing import Annotated, Self

from isopeel.common.errors import InputError
from isopeel.common.quantities import Finite, Meaning, Positive, Stress
from isopeel.physics.differentiation import Scalar
from isopeel.physics.materials.isotropic import Isotropic, material


@material
class MooneyRivlin(Isotropic):
    """Mooney-Rivlin solid of decoupled (isochoric and volumetric) form.

    psi = c10 (J^(-2/3) I1 - 3) + c01 (J^(-4/3) I2 - 3) + kappa/2 (J - 1)^2 with the bulk modulus kappa
    (Holzapfel, Nonlinear Solid Mechanics, Secs. 6.4 and 6.5; Mooney, J. Appl. Phys. 11, 1940). Codes that
    want D1 write kappa = 2/D1. Raises InputError unless c10 + c01 > 0, which is half the shear modulus,
    and kappa > 0.
    """

    c10: Annotated[
        Finite[Stress],
        Meaning("constant of I1 - 3; half of the shear modulus with all others zero", "0.2 MPa"),
    ]
    c01: Annotated[Finite[Stress], Meaning("constant of I2 - 3", "0.05 MPa")]
    bulk_modulus: Annotated[Positive[Stress], Meaning("bulk modulus", "100 MPa")]

    def check(self) -> None:
        """Check that the state of rest is stable."""
        if not self.c10 + self.c01 > 0:
            allowed = "it must be positive: it is half the shear modulus at rest"
            raise InputError("material.c10 + c01", self.c10 + self.c01, allowed)

    @classmethod
    def like(cls, youngs_modulus: float, poissons_ratio: float) -> Self:
        """The material of these constants at small strain, c10 = c01."""
        quarter = youngs_modulus / (8 * (1 + poissons_ratio))
        return cls(quarter, quarter, youngs_modulus / (3 * (1 - 2 * poissons_ratio)))

    @staticmethod
    def stored_energy(I1: Scalar, I2: Scalar, J: Scalar, c10: float, c01: float, kappa: float) -> Scalar:
        """Return psi."""
        scale = J ** (-2 / 3)
        return c10 * (scale * I1 - 3) + c01 * (scale * scale * I2 - 3) + kappa / 2 * (J - 1) ** 2
