"""The trapezoidal cohesive law, its kinks rounded."""

from typing import Annotated, Self

from isopeel.common.quantities import Length, Meaning, NotNegative, Number, Positive, Stress, SurfaceEnergy
from isopeel.physics.adhesion.normal import NormalLaw, normal_law


@normal_law
class Trapezoidal(NormalLaw):
    """Attraction that rises linearly with the opening, stays, and falls linearly to zero.

    The law of Tvergaard and Hutchinson (J. Mech. Phys. Solids 40, 1992): `rise` and `plateau` are shares of
    the opening that ends it. This law is averaged over an opening of +- `rounding` times its rise, which puts
    parabolas in the place of its kinks: sharp ones make Newton's method jump to and fro for ever. The average
    has the given strength and work, and rises linearly over the first 1 - `rounding` of the rise; compression
    has the same stiffness. The opening is the gap less `equilibrium_gap` (length), whatever the curvature of
    the substrate.

    strength: largest attraction, a stress; work_of_adhesion: energy per area to part the surfaces. Raises
    InputError unless both are positive, 0 < rise, 0 <= plateau, rise + plateau < 1, and 0 < rounding is at
    most 1 and 1 / (2 rise).
    """

    strength: Annotated[Positive[Stress], Meaning("largest attraction", "0.5 MPa")]
    work_of_adhesion: Annotated[
        Positive[SurfaceEnergy], Meaning("energy per area that separates the surfaces", "25 J/m^2")
    ]
    rise: Annotated[
        Number,
        Meaning(
            "opening of the largest attraction, divided by the final opening, between 0 and 1",
            0.1,
        ),
    ]
    plateau: Annotated[
        Number,
        Meaning("fraction of the final opening over which the attraction is constant", 0.5),
    ]
    rounding: Annotated[
        Number,
        Meaning("half width of the rounded kinks, divided by the opening of the largest attraction", 0.5),
    ] = 0.5
    equilibrium_gap: Annotated[
        NotNegative[Length], Meaning("gap at which the law neither attracts nor repels", "0.3 nm")
    ] = 0.0

    def check(self) -> None:
        """Check the shares."""
        if not 0 < self.rise < 1:
            raise self.error("rise", "it must lie in (0, 1)")
        if not 0 <= self.plateau < 1 - self.rise:
            raise self.error("plateau", "it must be at least 0 and less than 1 - rise")
        if not 0 < self.rounding <= min(1, 0.5 / self.rise):
            raise self.error("rounding", "it must be in (0, 1], at most 1 / (2 rise)")

    @classmethod
    def like(cls, strength: float, work_of_adhesion: float, equilibrium_gap: float) -> Self:
        """The law of this strength, work and gap."""
        return cls(strength, work_of_adhesion, 0.2, 0.4, equilibrium_gap=equilibrium_gap)

    def constants(self) -> tuple[float, ...]:
        """Work W, slopes of rise and fall, half-width of the average, openings of the kinks."""
        up, down = 1 / self.rise, 1 / (1 - self.rise - self.plateau)
        width = self.rounding * self.rise
        # what the average leaves of a sharp law of strength 1 that ends at 1: its peak is lower where the
        # average around it meets rise and fall, its work lacks the corners
        overlap = max(2 * width - self.plateau, 0.0)
        peak = 1 - overlap**2 / (4 * width) * up * down / (up + down)
        work = (1 + self.plateau) / 2 - width**2 * up / 6
        stress = self.strength / peak
        length = self.work_of_adhesion / (stress * work)
        slopes = (slope * (stress / length) for slope in (up, down))
        openings = (share * length for share in (width, self.rise, self.rise + self.plateau, 1.0))
        return self.work_of_adhesion, *slopes, *openings

    @staticmethod
    def at_point(
        opening: float,
        W: float,
        rise: float,
        fall: float,
        width: float,
        first: float,
        second: float,
        end: float,
    ) -> tuple[float, float, float]:
        """Return potential, traction and its derivative."""
        # the straight line at one end and a ramp from each kink on; beginning at the nearer end, where the
        # line is the rise or zero, few terms cancel
        side, Phi, T, dT = -1.0, 0.0, 0.0, 0.0
        if opening <= first:
            side, Phi, T, dT = 1.0, 0.5 * rise * opening * opening - W, -rise * opening, -rise
        for kink, change in ((first, -rise), (second, -fall), (end, fall)):
            past = side * (opening - kink)
            if past >= width:
                Phi += side * change * (0.5 * past * past + width * width / 6.0)
                T -= change * past
                dT -= side * change
            elif not past <= -width:  # nan stays nan
                share = 0.5 + 0.5 * past / width
                Phi += side * change * width * width * share**3 / 1.5
                T -= change * width * share * share
                dT -= side * change * share
        return Phi, T, dT
