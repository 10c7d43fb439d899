"""The strip: a rectangle."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from isopeel.common.quantities import Length, Meaning, Positive
from isopeel.problem.shapes.base import check_length, check_positive
from isopeel.splines.nurbs import NurbsSurface, Side, rectangle


@dataclass(frozen=True)
class Strip:
    """Rectangle of a length and a height. Raises InputError unless both are positive."""

    name: ClassVar[str] = "strip"
    usual_hold: ClassVar[Side] = "left"

    length: Annotated[Positive[Length], Meaning("length along x", "200 nm")]
    height: Annotated[Positive[Length], Meaning("height along y: the thickness of the strip", "10 nm")]

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
