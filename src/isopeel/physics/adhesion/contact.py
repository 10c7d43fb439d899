"""Contact without adhesion: a law that only repels."""

from typing import Annotated

from isopeel.common.quantities import Length, Meaning, NotNegative, Positive, StressPerLength
from isopeel.physics.adhesion.normal import NormalLaw, normal_law


@normal_law
class Contact(NormalLaw):
    """Normal traction T(x) = -k x over an overlap, x < 0, and none over an opening x > 0.

    The penalty method per reference area (Wriggers, Computational Contact Mechanics, Sec. 6.3): bodies
    overlap by p/k under a pressure p. The opening x is the gap less `equilibrium_gap` (length).

    penetration: the largest overlap (length) that is allowed, see `isopeel.physics.adhesion.augmented`. If it
    is None there are no multipliers, and bodies overlap by p/k.
    stiffness: k, a stress per length. If it is None, the assembly chooses it from the bodies and their meshes
    (`isopeel.assembly.contact`); until then the law has no values, and raises InputError. It also raises
    InputError unless stiffness and penetration are positive.
    """

    stiffness: Annotated[
        Positive[StressPerLength] | None,
        Meaning("pressure per overlap", "1 GPa/mm", usual="chosen from the bodies and their meshes"),
    ] = None
    equilibrium_gap: Annotated[NotNegative[Length], Meaning("gap at which contact begins", "0.3 nm")] = 0.0
    penetration: Annotated[
        Positive[Length] | None,
        Meaning(
            "largest overlap that is left by multipliers",
            "0.01 nm",
            usual="none, without multipliers",
            see="theory/adhesion.md#contact-without-adhesion",
        ),
    ] = None

    @property
    def work_of_adhesion(self) -> float:
        """Zero: nothing holds the surfaces together."""
        return 0.0

    def constants(self) -> tuple[float, ...]:
        """The stiffness."""
        if self.stiffness is None:
            raise self.error(
                "stiffness", "it is chosen where bodies have meshes; give a value, such as 10 E/h"
            )
        return (self.stiffness,)

    @staticmethod
    def at_point(opening: float, stiffness: float) -> tuple[float, float, float]:
        """Return potential, traction and its derivative."""
        # surfaces that touch are stiff already, so that a first step finds what a load presses against
        if opening > 0.0:
            return 0.0, 0.0, 0.0
        return 0.5 * stiffness * opening * opening, -stiffness * opening, -stiffness
