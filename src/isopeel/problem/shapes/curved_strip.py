"""The curved strip: it lies on a cylinder, or inside a hollow cylinder."""

from dataclasses import dataclass
from math import cos, pi, sin, tan
from typing import Annotated, ClassVar, Literal, TypeAlias, get_args

import numpy as np

from isopeel.common.errors import InputError
from isopeel.common.quantities import Length, Meaning, Positive
from isopeel.common.units import length_text
from isopeel.problem.shapes.base import check_positive, parameter_at_length
from isopeel.splines.nurbs import NurbsSurface, Side
from isopeel.splines.space import SplineSpace

#: The direction in which the ends of a strip point: down, as on a cylinder, or up, as in a hollow one.
Bend: TypeAlias = Literal["down", "up"]


@dataclass(frozen=True)
class CurvedStrip:
    """Strip of constant height whose lower face is an arc with a `length` and a `radius`.

    The arc starts at the origin along +x and bends down, about (0, -radius), or up, about (0, radius).
    Raises InputError unless all lengths are positive, the angle length / radius is below pi and a strip that
    bends up is lower than its radius.
    """

    name: ClassVar[str] = "curved-strip"
    usual_hold: ClassVar[Side] = "left"

    length: Annotated[Positive[Length], Meaning("length of the lower face", "200 nm")]
    height: Annotated[Positive[Length], Meaning("height: the thickness of the strip", "10 nm")]
    radius: Annotated[Positive[Length], Meaning("radius of the lower face", "200 nm")]
    bends: Annotated[
        Bend, Meaning("direction of the ends: down as on a cylinder, up as in a hollow", "down")
    ] = "down"

    def __post_init__(self) -> None:
        """Check the lengths and the bend."""
        check_positive(length=self.length, height=self.height, radius=self.radius)
        if self.bends not in get_args(Bend):
            raise InputError("body.bends", self.bends, f"it must be {' or '.join(get_args(Bend))}")
        if not self.length / self.radius < pi:
            allowed = f"it must be below pi radii, {length_text(pi * self.radius)}"
            raise InputError("body.length", self.length, allowed)
        if self.bends == "up" and not self.height < self.radius:
            allowed = f"it must be below the radius, {length_text(self.radius)}"
            raise InputError("body.height", self.height, allowed)

    def surface(self) -> NurbsSurface:
        """Return one patch of exact quadratic arcs, weights 1, cos(angle/2), 1 (The NURBS Book, Sec. 7.3)."""
        angle, outwards = self.length / self.radius, 1 if self.bends == "down" else -1
        middle = cos(angle / 2)
        points = np.zeros((3, 2, 2))
        for j, y in enumerate((0.0, self.height)):
            radius = self.radius + outwards * y
            # relative to the origin, not to the centre: its distance may be large, and cost digits
            drop = outwards * 2 * radius * sin(angle / 2) ** 2
            points[:, j] = [0, y], [radius * tan(angle / 2), y], [radius * sin(angle), y - drop]
        weights = np.repeat([[1.0], [middle], [1.0]], 2, axis=1)
        return NurbsSurface((SplineSpace.uniform(2, 1, 1), SplineSpace.uniform(1, 0, 1)), points, weights)

    def adhering_part(self, length: float) -> tuple[float, float]:
        """Return the parameters of a length from the left end; raises InputError beyond the right end."""
        return 0.0, parameter_at_length(self.surface().boundary("bottom"), length)
