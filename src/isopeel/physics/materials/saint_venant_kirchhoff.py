"""The Saint Venant-Kirchhoff material."""

from isopeel.physics.differentiation import Scalar
from isopeel.physics.materials.isotropic import Hookean, material


@material
class SaintVenantKirchhoff(Hookean):
    """Hooke's law between E = (F^T F - I)/2 and S: large rotations, moderate strains.

    psi = lambda/2 (tr E)^2 + mu E:E, hence S = lambda tr(E) I + 2 mu E and P = F S (Holzapfel, Nonlinear
    Solid Mechanics, Sec. 6.5), with tr E = (I1 - 3)/2 and E:E = (I1^2 - 2 I2 - 2 I1 + 3)/4. It softens in
    compression, has no stiffness left at the stretch 1/sqrt(3), and stays finite where J <= 0, so that only
    det F shows an inverted point. Raises InputError unless E > 0 and -1 < nu < 1/2.
    """

    @staticmethod
    def stored_energy(I1: Scalar, I2: Scalar, mu: float, lame: float) -> Scalar:
        """Return psi."""
        return lame / 8 * (I1 - 3) ** 2 + mu / 4 * (I1**2 - 2 * I2 - 2 * I1 + 3)
