"""The quarter cylinder: the right half of a half cylinder, for symmetric problems."""

from dataclasses import dataclass
from math import pi
from typing import Annotated, ClassVar

from isopeel.common.quantities import Length, Meaning, Positive
from isopeel.problem.shapes.base import check_positive, parameter_at_length
from isopeel.problem.shapes.blending import arc, blended, line
from isopeel.splines.nurbs import NurbsSurface, Side


@dataclass(frozen=True)
class QuarterCylinder:
    """Quarter disc of a `radius`: the right half of the half cylinder, with the line of symmetry as "left".

    The sides "bottom", from the lowest point at the origin, and "right" are arcs of 45 degrees. The outline
    has no corner where they meet. So the Jacobian vanishes there, and only there. Raises InputError unless
    the radius is positive.
    """

    name: ClassVar[str] = "quarter-cylinder"
    usual_hold: ClassVar[Side] = "left"

    radius: Annotated[Positive[Length], Meaning("radius", "100 nm")]

    def __post_init__(self) -> None:
        """Check the radius."""
        check_positive(radius=self.radius)

    def surface(self) -> NurbsSurface:
        """Return one biquadratic patch with exact arcs."""
        return blended(
            left=line((0.0, 0.0), (0.0, self.radius)),
            right=arc(self.radius, pi / 4, pi / 2),
            bottom=arc(self.radius, 0.0, pi / 4),
            top=line((0.0, self.radius), (self.radius, self.radius)),
        )

    def adhering_part(self, length: float) -> tuple[float, float]:
        """Return the parameters of a length from the left end; raises InputError beyond the right end."""
        return 0.0, parameter_at_length(self.surface().boundary("bottom"), length)
