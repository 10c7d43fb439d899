"""Dugdale's law of constant attraction, its ends smoothed."""

from typing import Annotated, Self

from isopeel.common.quantities import Length, Meaning, NotNegative, Number, Positive, Stress, SurfaceEnergy
from isopeel.physics.adhesion.normal import NormalLaw, normal_law


@normal_law
class Dugdale(NormalLaw):
    """Constant attraction up to a critical opening W / strength, reached and left smoothly.

    The law of Dugdale (J. Mech. Phys. Solids 8, 1960), for adhesion by Maugis (J. Colloid Interface Sci. 150,
    1992). Over the first a = `transition` * W / strength of the opening x it rises as u (3 - u^2)/2, u = x/a,
    and over the last a it falls as 1 - v^2 (3 - 2 v), with v from 0 to 1; W stays the work. So the traction
    has no kinks, and goes on into compression with its initial stiffness, 3/2 strength / a. The opening is
    the gap less `equilibrium_gap` (length), whatever the curvature of the substrate.

    strength: largest attraction, a stress; work_of_adhesion: energy per area to part the surfaces. Raises
    InputError unless both are positive and 0 < transition <= 8/9, where no plateau is left.
    """

    strength: Annotated[Positive[Stress], Meaning("largest attraction", "0.5 MPa")]
    work_of_adhesion: Annotated[
        Positive[SurfaceEnergy], Meaning("energy per area that separates the surfaces", "25 J/m^2")
    ]
    transition: Annotated[
        Number,
        Meaning(
            "opening over which the attraction rises and falls, over work / strength, at most 8/9",
            0.1,
        ),
    ]
    equilibrium_gap: Annotated[
        NotNegative[Length], Meaning("gap at which the law neither attracts nor repels", "0.3 nm")
    ] = 0.0

    def check(self) -> None:
        """Check the transition."""
        if not 0 < self.transition <= 8 / 9:
            raise self.error("transition", "it must lie in (0, 8/9]")

    @classmethod
    def like(cls, strength: float, work_of_adhesion: float, equilibrium_gap: float) -> Self:
        """The law of this strength, work and gap."""
        return cls(strength, work_of_adhesion, 0.3, equilibrium_gap)

    def constants(self) -> tuple[float, ...]:
        """Strength, work W, the length a of rise and fall, the opening at which the fall begins."""
        critical = self.work_of_adhesion / self.strength
        # rise and fall take 5/8 and 1/2 of what a constant attraction over their length takes
        start = critical * (1 - self.transition / 8)
        return self.strength, self.work_of_adhesion, self.transition * critical, start

    @staticmethod
    def at_point(
        opening: float, strength: float, W: float, length: float, start: float
    ) -> tuple[float, float, float]:
        """Return potential, traction and its derivative."""
        u = opening / length
        rest = 1.0 - (opening - start) / length
        stiffness = 1.5 * strength / length
        if u <= 0.0:
            return 0.75 * strength * opening * u - W, -1.5 * strength * u, -stiffness
        if u < 1.0:
            potential = strength * opening * u * (0.75 - 0.125 * u * u) - W
            return potential, -0.5 * strength * u * (3.0 - u * u), -stiffness * (1.0 - u * u)
        if rest >= 1.0:
            return strength * (opening - 0.375 * length) - W, -strength, 0.0
        if rest <= 0.0:
            return 0.0, 0.0, 0.0
        potential = -strength * length * rest**3 * (1.0 - 0.5 * rest)
        slope = 6.0 * strength / length * rest * (1.0 - rest)
        return potential, -strength * rest * rest * (3.0 - 2.0 * rest), slope
