"""The bilinear cohesive law, its kinks rounded."""

from dataclasses import dataclass
from typing import ClassVar, Self

from isopeel.common.arrays import FloatArray
from isopeel.common.quantities import Length, Number, Stress, SurfaceEnergy
from isopeel.physics.adhesion.trapezoidal import Trapezoidal
from isopeel.physics.batch import BatchFunction


@dataclass(frozen=True)
class Bilinear:
    """Attraction that rises linearly with the opening and falls linearly to zero.

    The normal part of the law of Alfano and Crisfield (Int. J. Numer. Methods Eng. 50, 2001): `Trapezoidal`
    without a plateau, which says what the constants mean and what is refused.
    """

    name: ClassVar[str] = "bilinear"
    strength: Stress
    work_of_adhesion: SurfaceEnergy
    rise: Number
    rounding: Number = 0.5
    equilibrium_gap: Length = 0.0

    def __post_init__(self) -> None:
        """Check the constants."""
        self._trapezoidal()

    @classmethod
    def like(cls, strength: float, work_of_adhesion: float, equilibrium_gap: float) -> Self:
        """The law of this strength, work and gap."""
        return cls(strength, work_of_adhesion, 0.2, equilibrium_gap=equilibrium_gap)

    @property
    def parameters(self) -> FloatArray:
        """Those of the trapezoidal law."""
        return self._trapezoidal().parameters

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of potential, traction and its derivative."""
        return self._trapezoidal().kernel

    def _trapezoidal(self) -> Trapezoidal:
        return Trapezoidal(
            self.strength, self.work_of_adhesion, self.rise, 0.0, self.rounding, self.equilibrium_gap
        )
