"""The exponential joint law of opening and sliding."""

from typing import Annotated

import numpy as np

from isopeel.common.quantities import Finite, Meaning, Number, Positive, Stress, SurfaceEnergy
from isopeel.physics.joints.base import JointLaw, joint_law


@joint_law
class XuNeedleman(JointLaw):
    """The potential of Xu and Needleman (J. Mech. Phys. Solids 42, 1994), reversible:

        E = W + W exp(-x) {(1 - r + x) (1 - q)/(r - 1) - [q + (r - q)/(r - 1) x] exp(-z^2)},

    with x = d_n/delta_n, z = d_t/delta_t, delta_n = W/(e strength), and delta_t = q W/((e/2)^(1/2)
    shear_strength). W is the work of pure opening and q W that of pure sliding at d_n = 0; r is the opening x
    at which the faces are free of normal traction after they have slid apart. In compression the law stays
    exponential.

    For q other than 1 the energy does not grow along every path to separation, so that a joint that slides
    may push its faces apart or pull them together (van den Bosch, Schreurs and Geers, Eng. Fract. Mech. 73,
    2006). Raises InputError where strengths or works are not positive, or r is 1.
    """

    strength: Annotated[Positive[Stress], Meaning("largest normal traction, in opening alone", "10 MPa")]
    shear_strength: Annotated[
        Positive[Stress], Meaning("largest tangential traction, in sliding alone", "10 MPa")
    ]
    work_of_adhesion: Annotated[
        Positive[SurfaceEnergy], Meaning("energy per area of separation by opening", "100 J/m^2")
    ]
    q: Annotated[
        Positive[Number], Meaning("energy of separation by sliding, divided by that by opening", 1.0)
    ] = 1.0
    r: Annotated[
        Finite[Number],
        Meaning(
            "opening after sliding apart without a normal traction, over the characteristic opening",
            0.0,
        ),
    ] = 0.0

    def check(self) -> None:
        """Check the opening after sliding."""
        if self.r == 1.0:
            raise self.error("r", "it must not be 1")

    @property
    def doubt(self) -> str:
        """For q other than 1."""
        if self.q == 1.0:
            return ""
        return (
            f"with q = {self.q:g} the energy of the law does not grow along every path to separation, so that"
            " faces that slide may push each other apart or pull each other together; it does with q = 1"
        )

    def constants(self) -> tuple[float, ...]:
        """W, both lengths, q, and the factors of (1 - r + x) and of -x exp(-z^2)."""
        W, q, r = self.work_of_adhesion, self.q, self.r
        delta_n = W / (np.e * self.strength)
        delta_t = q * W / (np.sqrt(np.e / 2) * self.shear_strength)
        return W, delta_n, delta_t, q, r, (1 - q) / (r - 1), (r - q) / (r - 1)

    @staticmethod
    def at_point(
        opening: float,
        sliding: float,
        W: float,
        delta_n: float,
        delta_t: float,
        q: float,
        r: float,
        of_opening: float,
        of_both: float,
    ) -> tuple[float, ...]:
        """Return energies and derivatives."""
        x, z = opening / delta_n, sliding / delta_t
        decay, hold = np.exp(-x), np.exp(-z * z)
        kept = q + of_both * x
        P = (1.0 - r + x) * of_opening - kept * hold
        P_x = of_opening - of_both * hold
        d_hold, dd_hold = -2.0 * z * hold, (4.0 * z * z - 2.0) * hold
        scale = W * decay
        return (
            W + scale * P,
            0.0,
            scale * (P_x - P) / delta_n,
            -scale * kept * d_hold / delta_t,
            scale * (P - 2.0 * P_x) / delta_n**2,
            scale * (kept - of_both) * d_hold / (delta_n * delta_t),
            -scale * kept * dd_hold / delta_t**2,
        )
