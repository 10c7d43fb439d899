"""The tapered strip: a flat lower face, and a height that changes linearly."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from isopeel.common.quantities import Length, Meaning, Positive
from isopeel.problem.shapes.base import check_length, check_positive
from isopeel.splines.nurbs import NurbsSurface, Side
from isopeel.splines.space import SplineSpace


@dataclass(frozen=True)
class TaperedStrip:
    """Strip of `height` at its left and `end_height` at its right end, with a flat lower face.

    Raises InputError unless all lengths are positive.
    """

    name: ClassVar[str] = "tapered-strip"
    usual_hold: ClassVar[Side] = "left"

    length: Annotated[Positive[Length], Meaning("length along x", "200 nm")]
    height: Annotated[Positive[Length], Meaning("height of the left end", "5 nm")]
    end_height: Annotated[Positive[Length], Meaning("height of the right end", "20 nm")]

    def __post_init__(self) -> None:
        """Check the lengths."""
        check_positive(length=self.length, height=self.height, end_height=self.end_height)

    def surface(self) -> NurbsSurface:
        """Return one bilinear patch."""
        linear = SplineSpace.uniform(1, 0, 1)
        left, right = [[0.0, 0.0], [0.0, self.height]], [[self.length, 0.0], [self.length, self.end_height]]
        return NurbsSurface((linear, linear), np.array([left, right]), np.ones((2, 2)))

    def adhering_part(self, length: float) -> tuple[float, float]:
        """Return the parameters of a length from the left end; raises InputError beyond the right end."""
        check_length(length, self.length)
        return 0.0, length / self.length
