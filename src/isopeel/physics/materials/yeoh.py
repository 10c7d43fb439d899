"""The compressible Yeoh material."""

from typing import Annotated, Self

from isopeel.common.quantities import Finite, Meaning, Positive, Stress
from isopeel.physics.differentiation import Scalar
from isopeel.physics.materials.isotropic import Isotropic, material


@material
class Yeoh(Isotropic):
    """Yeoh solid of decoupled (isochoric and volumetric) form.

    psi = c10 x + c20 x^2 + c30 x^3 + kappa/2 (J - 1)^2 with x = J^(-2/3) I1 - 3 and the bulk modulus kappa
    (Holzapfel, Nonlinear Solid Mechanics, Secs. 6.4 and 6.5; Yeoh, Rubber Chem. Technol. 66, 1993). Codes
    that want D1 write kappa = 2/D1, and no D2, D3. Raises InputError unless c10 > 0 and kappa > 0.
    """

    c10: Annotated[
        Positive[Stress],
        Meaning("constant of I1 - 3; half of the shear modulus with all others zero", "0.2 MPa"),
    ]
    c20: Annotated[Finite[Stress], Meaning("constant of (I1 - 3)^2", "-2 kPa")]
    c30: Annotated[Finite[Stress], Meaning("constant of (I1 - 3)^3", "0.1 kPa")]
    bulk_modulus: Annotated[Positive[Stress], Meaning("bulk modulus", "100 MPa")]

    @classmethod
    def like(cls, youngs_modulus: float, poissons_ratio: float) -> Self:
        """The material of these constants at small strain, each coefficient a tenth of the one before."""
        c10 = youngs_modulus / (4 * (1 + poissons_ratio))
        return cls(c10, c10 / 10, c10 / 100, youngs_modulus / (3 * (1 - 2 * poissons_ratio)))

    @staticmethod
    def stored_energy(I1: Scalar, J: Scalar, c10: float, c20: float, c30: float, kappa: float) -> Scalar:
        """Return psi."""
        x = J ** (-2 / 3) * I1 - 3
        return ((c30 * x + c20) * x + c10) * x + kappa / 2 * (J - 1) ** 2
