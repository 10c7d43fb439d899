"""Van der Waals adhesion: the Lennard-Jones interaction integrated over a half space."""

from typing import Annotated, Self

import numpy as np

from isopeel.common.quantities import Energy, Length, Meaning, Positive
from isopeel.physics.adhesion.normal import NormalLaw, normal_law


@normal_law
class VanDerWaals(NormalLaw):
    """Traction of a substrate on a facing surface, by the Lennard-Jones potential.

    T(r) = A_H/(2 pi r0^3) [f1/45 (r0/r)^9 - f2/3 (r0/r)^3], repulsion positive, with the factors
    f1 = (1 + 9/4 k r + 9/7 k^2 r^2)/(1 + k r)^2 and f2 = (1 + 3 k r + 3 k^2 r^2)/(1 + k r)^2 of a substrate
    of curvature k = 1/R; continued by its tangent below the equilibrium gap (Sauer and Wriggers, Comput.
    Methods Appl. Mech. Eng. 198, 2009; Sauer, Int. J. Numer. Methods Eng. 87, 2011). The factors describe
    how the layers of a body around a sphere of radius R grow with their distance; they have a pole at the
    centre of a hollow substrate. Where the curvature varies along a substrate the force has no potential, and
    its tangent lacks the change of the curvature.

    hamaker_constant: energy; equilibrium_distance: r0 of the Lennard-Jones potential, a length.
    """

    hamaker_constant: Annotated[
        Positive[Energy], Meaning("Hamaker constant of body and substrate", "1e-19 J")
    ]
    equilibrium_distance: Annotated[
        Positive[Length],
        Meaning("distance of two molecules at which they neither attract nor repel", "0.4 nm"),
    ]

    @classmethod
    def like(cls, _strength: float, work_of_adhesion: float, equilibrium_gap: float) -> Self:
        """The law of this work and gap, which give its strength."""
        distance = equilibrium_gap * 15 ** (1 / 6)
        return cls(work_of_adhesion * 16 * np.pi * distance**2 / 15 ** (1 / 3), distance)

    @property
    def equilibrium_gap(self) -> float:
        """r_eq = r0 / 15^(1/6) of a flat substrate."""
        return float(self.equilibrium_distance / 15 ** (1 / 6))

    @property
    def work_of_adhesion(self) -> float:
        """W = A_H 15^(1/3) / (16 pi r0^2) of a flat substrate."""
        return float(self.hamaker_constant * 15 ** (1 / 3) / (16 * np.pi * self.equilibrium_distance**2))

    @staticmethod
    def at_point(gap: float, curvature: float, A_H: float, r0: float) -> tuple[float, float, float]:
        """Return potential, traction and its derivative."""
        strength = A_H / (2.0 * np.pi * r0**3)
        # equilibrium: (r0/r)^6 = 15 f2/f1; f2/f1 varies so slowly with r that the iteration gains a digit or
        # more each time, and it is exact at once on a flat substrate
        r_eq = r0 / 15.0 ** (1.0 / 6.0)
        if curvature != 0.0:
            for _ in range(50):
                z = curvature * r_eq
                ratio = (1.0 + 3.0 * z + 3.0 * z * z) / (1.0 + 2.25 * z + 9.0 / 7.0 * z * z)
                last = r_eq
                r_eq = r0 / (15.0 * ratio) ** (1.0 / 6.0)
                if abs(r_eq - last) <= 1e-16 * r0:
                    break
        below = min(gap - r_eq, 0.0)
        r = max(gap, r_eq)
        x = r0 / r
        z = curvature * r
        x3 = x * x * x
        x9 = x3 * x3 * x3
        f1 = (1.0 + 2.25 * z + 9.0 / 7.0 * z * z) / (1.0 + z) ** 2
        f2 = (1.0 + 3.0 * z + 3.0 * z * z) / (1.0 + z) ** 2
        # r df/dr
        df1 = z * (0.25 + 9.0 / 28.0 * z) / (1.0 + z) ** 3
        df2 = z * (1.0 + 3.0 * z) / (1.0 + z) ** 3
        T = strength * (f1 / 45.0 * x9 - f2 / 3.0 * x3)
        dT = strength / r * ((df1 - 9.0 * f1) / 45.0 * x9 - (df2 - 3.0 * f2) / 3.0 * x3)
        # Phi(r) = integral of T from r to infinity, in closed form
        Phi = (
            strength
            * r
            * ((1.0 / 8.0 + 9.0 / 56.0 * z) / (1.0 + z) / 45.0 * x9 - (0.5 + 1.5 * z) / (1.0 + z) / 3.0 * x3)
        )
        return Phi - T * below - 0.5 * dT * below * below, T + dT * below, dT
