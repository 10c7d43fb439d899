"""The bilinear cohesive law, its kinks rounded."""

from typing import Annotated, Self

from isopeel.common.quantities import Length, Meaning, Number, Stress, SurfaceEnergy
from isopeel.physics.adhesion.normal import NormalLaw, normal_law
from isopeel.physics.adhesion.trapezoidal import Trapezoidal


@normal_law
class Bilinear(NormalLaw):
    """Attraction that rises linearly with the opening and falls linearly to zero.

    The normal part of the law of Alfano and Crisfield (Int. J. Numer. Methods Eng. 50, 2001): `Trapezoidal`
    without a plateau, which says what the constants mean and what is refused.
    """

    strength: Annotated[Stress, Meaning("largest attraction", "0.5 MPa")]
    work_of_adhesion: Annotated[
        SurfaceEnergy, Meaning("energy per area that separates the surfaces", "25 J/m^2")
    ]
    rise: Annotated[
        Number,
        Meaning(
            "opening of the largest attraction, divided by the final opening, between 0 and 1",
            0.1,
        ),
    ]
    rounding: Annotated[
        Number,
        Meaning("half width of the rounded kinks, divided by the opening of the largest attraction", 0.5),
    ] = 0.5
    equilibrium_gap: Annotated[
        Length, Meaning("gap at which the law neither attracts nor repels", "0.3 nm")
    ] = 0.0

    def check(self) -> None:
        """Check the constants."""
        self._trapezoidal()

    @classmethod
    def like(cls, strength: float, work_of_adhesion: float, equilibrium_gap: float) -> Self:
        """The law of this strength, work and gap."""
        return cls(strength, work_of_adhesion, 0.2, equilibrium_gap=equilibrium_gap)

    def constants(self) -> tuple[float, ...]:
        """Those of the trapezoidal law."""
        return self._trapezoidal().constants()

    at_point = Trapezoidal.at_point

    def _trapezoidal(self) -> Trapezoidal:
        return Trapezoidal(
            self.strength, self.work_of_adhesion, self.rise, 0.0, self.rounding, self.equilibrium_gap
        )
