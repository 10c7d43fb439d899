"""The strip: a rectangle."""

from dataclasses import dataclass
from typing import ClassVar

from isopeel.common.quantities import Length
from isopeel.problem.shapes.base import check_length, check_positive
from isopeel.splines.nurbs import NurbsSurface, Side, rectangle


@dataclass(frozen=True)
class Strip:
    """Rectangle of a length and a height. Raises InputError unless both are positive."""

    name: ClassVar[str] = "strip"
    usual_hold: ClassVar[Side] = "left"

    length: Length
    height: Length

    def __post_init__(self) -> None:
        """Check the lengths."""
        check_positive(length=self.length, height=self.height)

    def surface(self) -> NurbsSurface:
        """Return one bilinear patch."""
        return rectangle(self.length, self.height)

    def adhering_part(self, length: float) -> tuple[float, float]:
        """Return the parameters of a length from the left end; raises InputError beyond the right end."""
        check_length(length, self.length)
        return 0.0, length / self.length
