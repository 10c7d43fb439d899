"""The bilinear cohesive law, its kinks rounded."""

from dataclasses import dataclass

from isopeel.arrays import FloatArray
from isopeel.physics.adhesion.trapezoidal import Trapezoidal
from isopeel.physics.batch import BatchFunction


@dataclass(frozen=True)
class Bilinear:
    """Attraction that rises linearly with the opening and falls linearly to zero.

    The normal part of the law of Alfano and Crisfield (Int. J. Numer. Methods Eng. 50, 2001): `Trapezoidal`
    without a plateau, which says what the constants mean and what is refused.
    """

    strength: float
    work_of_adhesion: float
    rise: float
    rounding: float = 0.5
    equilibrium_gap: float = 0.0

    def __post_init__(self) -> None:
        """Check the constants."""
        self._trapezoidal()

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
