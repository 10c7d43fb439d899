"""Two equal beams that are bonded to each other and crack at one end: end-notched and mixed-mode flexure.

A lever puts the load P at the distance c beyond the middle of a span 2 L: it presses the middle down by
P (c + L)/L, and lifts the upper beam at the cracked end by P c/L. Without a lever, c = 0, the test is
end-notched flexure. All per unit width.
"""

from dataclasses import dataclass
from math import sqrt

#: Of the root correction chi h: its share in sliding.
_IN_SLIDING = 0.42


@dataclass(frozen=True)
class BondedBeams:
    """Two beams of one height on supports at a distance of 2 x `half_span`, loaded by a lever.

    The moduli are those along and across the beam, E' = E/(1 - nu^2) both of an isotropic one in plane
    strain, and of shear. The beams rotate at the root of the crack, which lengthens it by chi h in opening
    and 0.42 chi h in sliding (Williams, Compos. Sci. Technol. 35, 1989; Wang and Williams, 43, 1992):
    chi^2 = E'/(11 mu) [3 - 2 (Gamma/(1 + Gamma))^2], Gamma = 1.18 E'/mu. The factor 0.42 is a fit.
    """

    modulus: float
    shear_modulus: float
    height: float
    half_span: float
    lever: float = 0.0

    @property
    def root_rotation(self) -> float:
        """Return chi h, a length."""
        ratio = self.modulus / self.shear_modulus
        gamma = 1.18 * ratio
        return self.height * sqrt(ratio / 11 * (3 - 2 * (gamma / (1 + gamma)) ** 2))

    def release(self, load: float, crack: float) -> tuple[float, float]:
        """Return the energy release rates G_I and G_II under a load, at a crack from the support.

        G_I = 3 a^2 P^2 (3 c - L)^2/(4 h^3 L^2 E') and G_II = 9 a^2 P^2 (c + L)^2/(16 h^3 L^2 E'), each with
        its corrected a (Reeder and Crews, AIAA J. 28, 1990). With a lever shorter than L/3 the beams press on
        each other, and G_I vanishes.
        """
        opening, sliding = self._rates
        turned = self.root_rotation
        return (
            3 * opening * (load * (crack + turned)) ** 2,
            3 * sliding * (load * (crack + _IN_SLIDING * turned)) ** 2,
        )

    def compliance(self, crack: float) -> float:
        """Return the displacement of the load over the load; with the shear of the uncracked beam.

        Its derivative is 2 (G_I + G_II)/P^2.
        """
        opening, sliding = self._rates
        L, h, turned = self.half_span, self.height, self.root_rotation
        pressed = (1 + self.lever / L) ** 2
        whole = pressed * (L**3 / (4 * self.modulus * h**3) + 0.3 * L / (self.shear_modulus * h))
        return whole + 2 * (opening * (crack + turned) ** 3 + sliding * (crack + _IN_SLIDING * turned) ** 3)

    @property
    def _rates(self) -> tuple[float, float]:
        """A third of G/(P a)^2 in both modes."""
        L, c, stiffness = self.half_span, self.lever, self.modulus * self.height**3
        opening = max(3 * c - L, 0.0) ** 2 / (4 * L**2 * stiffness)
        return opening, 3 * (c + L) ** 2 / (16 * L**2 * stiffness)
