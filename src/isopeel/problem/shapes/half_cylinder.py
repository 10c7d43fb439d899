"""The half cylinder: a half disc that touches the substrate with the lowest point of its arc."""

from dataclasses import dataclass
from math import pi, sin
from typing import Annotated, ClassVar

from isopeel.common.quantities import Length, Meaning, Positive
from isopeel.problem.shapes.base import ROUND_OFF, check_length, check_positive
from isopeel.problem.shapes.blending import arc, blended, line
from isopeel.splines.nurbs import NurbsSurface, Side


@dataclass(frozen=True)
class HalfCylinder:
    """Half disc of a `radius` whose lowest point is the origin, with its flat face on top, at y = radius.

    The sides are arcs: "bottom" from -45 to 45 degrees about the lowest point, "left" and "right" from there
    up to the flat face. The outline has no corner where two arcs meet. So the Jacobian vanishes at the two
    ends of "bottom", and only there. Raises InputError unless the radius is positive.
    """

    name: ClassVar[str] = "half-cylinder"
    usual_hold: ClassVar[Side] = "top"

    radius: Annotated[Positive[Length], Meaning("radius", "100 nm")]

    def __post_init__(self) -> None:
        """Check the radius."""
        check_positive(radius=self.radius)

    def surface(self) -> NurbsSurface:
        """Return one biquadratic patch with exact arcs."""
        return blended(
            left=arc(self.radius, -pi / 4, -pi / 2),
            right=arc(self.radius, pi / 4, pi / 2),
            bottom=arc(self.radius, -pi / 4, pi / 4),
            top=line((-self.radius, self.radius), (self.radius, self.radius)),
        )

    def adhering_part(self, length: float) -> tuple[float, float]:
        """Return the parameters of a length about the lowest point; raises InputError beyond the ends."""
        total = self.radius * pi / 2
        check_length(length, total * (1 + ROUND_OFF))
        # on an arc in standard form, t / (1 - t) is the ratio of the sines of half the angles on both sides
        half_angle = max(0.0, (total - length) / self.radius / 4)
        before, after = sin(half_angle), sin(pi / 4 - half_angle)
        return before / (before + after), after / (before + after)
