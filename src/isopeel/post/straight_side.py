"""Straight sides of bodies of constant thickness, with places along a direction."""

from dataclasses import dataclass, replace
from math import hypot

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.problem import Boundary, Problem
from isopeel.splines.nurbs import Side

OPPOSITE: dict[Side, Side] = {"left": "right", "right": "left", "bottom": "top", "top": "bottom"}
#: Deviation from a line, over the length: the round-off of control points.
_ROUND_OFF = 1e-9
_PARAMETERS = np.linspace(0.0, 1.0, 401)


@dataclass(frozen=True, eq=False)
class StraightSide:
    """A straight side that is parallel to the opposite one."""

    side: Boundary  # all of it
    start: FloatArray  # (2,)
    direction: FloatArray  # unit vector (2,) of the rising parameter
    places: FloatArray  # of equally spaced parameters
    height: float  # distance of the opposite side

    def measured(self, origin: FloatArray, along: FloatArray) -> "StraightSide":
        """Return the side with places from an origin (2,) along a unit vector (2,) that is parallel to it."""
        distances = np.abs(self.places - self.places[0])
        places = (self.start - origin) @ along + distances * (self.direction @ along)
        return replace(self, places=places)

    @property
    def ends(self) -> tuple[float, float]:
        """The lowest and the highest place."""
        return float(self.places.min()), float(self.places.max())

    def place(self, parameter: float) -> float:
        """Return the place of a parameter."""
        return float(np.interp(parameter, _PARAMETERS, self.places))

    def parameter(self, place: float) -> float:
        """Return the parameter of a place."""
        rises = self.places[-1] > self.places[0]
        known = (self.places, _PARAMETERS) if rises else (self.places[::-1], _PARAMETERS[::-1])
        return float(np.interp(place, *known))

    def part(self, one: float, other: float) -> Boundary:
        """Return the part between two places."""
        start, end = sorted((self.parameter(one), self.parameter(other)))
        return replace(self.side, start=start, end=end)


def straight_side(problem: Problem, boundary: Boundary) -> StraightSide | None:
    """Return the side of a boundary, with places from its start; None if it is not a StraightSide."""
    shape, side = problem.body_of(boundary.body).shape, boundary.side
    curve, other = (shape.boundary(one).evaluate(_PARAMETERS) for one in (side, OPPOSITE[side]))
    whole = curve[-1] - curve[0]
    length = hypot(*whole)
    direction = whole / length if length else np.array([1.0, 0.0])
    off = [(points - curve[0]) @ np.array([-direction[1], direction[0]]) for points in (curve, other)]
    if not length or max(float(np.ptp(one)) for one in off) > _ROUND_OFF * length:
        return None
    places = (curve - curve[0]) @ direction
    return StraightSide(Boundary(boundary.body, side), curve[0], direction, places, abs(float(off[1].mean())))
