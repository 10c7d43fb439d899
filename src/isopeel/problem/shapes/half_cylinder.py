"""The half cylinder: a half disc that touches the substrate with the lowest point of its arc."""

from dataclasses import dataclass
from math import pi
from typing import ClassVar

from isopeel.problem.shapes.base import check_positive, parameter_at_length
from isopeel.problem.shapes.blending import arc, blended, line
from isopeel.quantities import Length
from isopeel.splines.nurbs import NurbsSurface


@dataclass(frozen=True)
class HalfCylinder:
    """Half disc of a `radius` whose lowest point is the origin, with its flat face on top, at y = radius.

    The sides are arcs: "bottom" from -45 to 45 degrees about the lowest point, "left" and "right" from there
    up to the flat face. Where two arcs meet the outline has no corner, so that the Jacobian vanishes at the
    two ends of "bottom", and only there. Raises InputError unless the radius is positive.
    """

    name: ClassVar[str] = "half-cylinder"

    radius: Length

    def __post_init__(self) -> None:
        """Check the radius."""
        check_positive(radius=self.radius)

    def surface(self) -> NurbsSurface:
        """One biquadratic patch with exact arcs."""
        return blended(
            left=arc(self.radius, -pi / 4, -pi / 2),
            right=arc(self.radius, pi / 4, pi / 2),
            bottom=arc(self.radius, -pi / 4, pi / 4),
            top=line((-self.radius, self.radius), (self.radius, self.radius)),
        )

    def parameter_at(self, length: float) -> float:
        """The parameter of the lower side at an arc length from its left end; InputError beyond its ends."""
        return parameter_at_length(self.surface().boundary("bottom"), length)
