"""The strip: a rectangle."""

from dataclasses import dataclass
from typing import ClassVar

from isopeel.problem.shapes.base import check_length, check_positive
from isopeel.quantities import Length
from isopeel.splines.nurbs import NurbsSurface, rectangle


@dataclass(frozen=True)
class Strip:
    """Rectangle of a length and a height. Raises InputError unless both are positive."""

    name: ClassVar[str] = "strip"

    length: Length
    height: Length

    def __post_init__(self) -> None:
        """Check the lengths."""
        check_positive(length=self.length, height=self.height)

    def surface(self) -> NurbsSurface:
        """One bilinear patch."""
        return rectangle(self.length, self.height)

    def parameter_at(self, length: float) -> float:
        """The parameter of the lower side at a length from its left end; InputError beyond its ends."""
        check_length(length, self.length)
        return length / self.length
