"""Adhesion by an interaction of two powers of the gap."""

from math import inf
from typing import Annotated

from isopeel.common.quantities import Length, Meaning, Number, Positive, SurfaceEnergy
from isopeel.physics.adhesion.normal import NormalLaw, normal_law


@normal_law
class LennardJones(NormalLaw):
    """Traction T(r) = C [(r_eq/r)^m - (r_eq/r)^n], repulsion positive; C from the work of adhesion.

    W = C r_eq (m - n)/((m - 1) (n - 1)). With the exponents 9 and 3, for half spaces of Lennard-Jones
    molecules, C = 8 W/(3 r_eq) (Greenwood, Proc. R. Soc. Lond. A 453, 1997): `VanDerWaals` on a flat
    substrate. The traction is continued by its tangent below the equilibrium gap. The law is that of a flat
    substrate, whatever the curvature of the substrate.

    work_of_adhesion: W, energy per area to part the surfaces; equilibrium_gap: r_eq, a length. Raises
    InputError unless both are positive and m > n > 1.
    """

    work_of_adhesion: Annotated[
        Positive[SurfaceEnergy], Meaning("energy per area that separates the surfaces", "0.05 J/m^2")
    ]
    equilibrium_gap: Annotated[
        Positive[Length], Meaning("gap at which the law neither attracts nor repels", "0.3 nm")
    ]
    repulsive_exponent: Annotated[
        Number, Meaning("exponent of the repulsive traction, larger than that of the attractive one", 9.0)
    ] = 9.0
    attractive_exponent: Annotated[Number, Meaning("exponent of the attractive traction, above 1", 3.0)] = 3.0

    def check(self) -> None:
        """Check the exponents."""
        if not 1 < self.attractive_exponent < inf:
            raise self.error("attractive_exponent", "it must be larger than 1")
        if not self.attractive_exponent < self.repulsive_exponent < inf:
            raise self.error("repulsive_exponent", "it must be larger than the attractive one")

    @property
    def strength(self) -> float:
        """Largest attraction C (n/m)^(n/(m - n)) (1 - n/m), at (r_eq/r)^(m - n) = n/m."""
        stress, m, n = self.constants()
        return float(stress * (n / m) ** (n / (m - n)) * (1 - n / m))

    def constants(self) -> tuple[float, float, float]:
        """C, m and n."""
        m, n = self.repulsive_exponent, self.attractive_exponent
        return self.work_of_adhesion / self.equilibrium_gap * (m - 1) * (n - 1) / (m - n), m, n

    @staticmethod
    def at_point(
        gap: float, equilibrium_gap: float, stress: float, m: float, n: float
    ) -> tuple[float, float, float]:
        """Return potential, traction and its derivative."""
        below = min(gap - equilibrium_gap, 0.0)
        r = max(gap, equilibrium_gap)
        repulsion = stress * (equilibrium_gap / r) ** m
        attraction = stress * (equilibrium_gap / r) ** n
        slope = (n * attraction - m * repulsion) / r
        # Phi(r) = integral of T from r to infinity
        potential = r * (repulsion / (m - 1.0) - attraction / (n - 1.0))
        return potential - 0.5 * slope * below * below, repulsion - attraction + slope * below, slope
