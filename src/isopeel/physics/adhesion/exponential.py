"""The exponential cohesive law."""

from typing import Annotated

import numpy as np

from isopeel.common.quantities import Length, Meaning, NotNegative, Positive, Stress, SurfaceEnergy
from isopeel.physics.adhesion.normal import NormalLaw, normal_law


@normal_law
class Exponential(NormalLaw):
    """Normal traction T(x) = -W/d^2 x exp(-x/d) over the opening x: strongest, W/(e d), at x = d.

    The normal part of the law of Xu and Needleman (J. Mech. Phys. Solids 42, 1994); linear in compression, at
    the initial stiffness W/d^2. The opening is the gap less `equilibrium_gap` (length), whatever the
    curvature of the substrate.

    strength: largest attraction, a stress; work_of_adhesion: W, the energy per area to part the surfaces.
    Raises InputError unless both are positive.
    """

    strength: Annotated[Positive[Stress], Meaning("largest attraction", "0.5 MPa")]
    work_of_adhesion: Annotated[
        Positive[SurfaceEnergy], Meaning("energy per area that separates the surfaces", "25 J/m^2")
    ]
    equilibrium_gap: Annotated[
        NotNegative[Length], Meaning("gap at which the law neither attracts nor repels", "0.3 nm")
    ] = 0.0

    @property
    def characteristic_length(self) -> float:
        """d = W / (e strength), the opening of strongest attraction."""
        return float(self.work_of_adhesion / (np.e * self.strength))

    def constants(self) -> tuple[float, ...]:
        """W, d and the initial stiffness."""
        W, d = self.work_of_adhesion, self.characteristic_length
        return W, d, W / (d * d)

    @staticmethod
    def at_point(opening: float, W: float, d: float, stiffness: float) -> tuple[float, float, float]:
        """Return potential, traction and its derivative."""
        if opening <= 0.0:
            return 0.5 * stiffness * opening * opening - W, -stiffness * opening, -stiffness
        z = opening / d
        decay = np.exp(-z)
        return -W * (1.0 + z) * decay, -stiffness * opening * decay, -stiffness * (1.0 - z) * decay
