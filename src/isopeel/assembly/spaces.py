"""The functions of all bodies of a problem, numbered one body after another."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from isopeel.common.arrays import FloatArray, IntArray, frozen
from isopeel.common.errors import InputError
from isopeel.problem import Boundary, Problem
from isopeel.problem.boundary import ROUND_OFF
from isopeel.splines.nurbs import Side
from isopeel.splines.rows import RowSpace

#: In arrays of the unknowns of coefficients: of a component that is held or prescribed.
HELD = -1
#: Spaces of the displacement by names of bodies, or that of the only one.
SpaceOfBodies = RowSpace | Mapping[str, RowSpace]


def spaces_by_name(problem: Problem, given: SpaceOfBodies) -> dict[str, RowSpace]:
    """Return the spaces of a problem by names of bodies, in their order.

    Raises InputError where there are not as many as bodies.
    """
    if isinstance(given, RowSpace):
        given = {body.name: given for body in problem.bodies[:1]}
    names = [body.name for body in problem.bodies]
    if set(given) != set(names):
        raise InputError("space", ", ".join(given), f"each body needs one: {', '.join(names)}")
    return {name: given[name] for name in names}


def part_of_body(
    problem: Problem, space: SpaceOfBodies, displacement: FloatArray, body: str
) -> tuple[RowSpace, FloatArray]:
    """Return the space of a body, and its part (functions, 2) of coefficients (size, 2) of all bodies.

    Raises InputError for coefficients of other spaces.
    """
    spaces = spaces_by_name(problem, space)
    check_coefficients(spaces, displacement)
    start = sum(spaces[name].size for name in list(spaces)[: list(spaces).index(body)])
    return spaces[body], displacement[start : start + spaces[body].size]


def check_coefficients(spaces: Mapping[str, RowSpace], displacement: FloatArray) -> None:
    """Raise InputError unless coefficients are those (size, 2) of all spaces."""
    size = sum(space.size for space in spaces.values())
    if displacement.shape != (size, 2):
        raise InputError("displacement", displacement.shape, f"the space has {size} functions")


@dataclass(frozen=True, eq=False)
class Spaces:
    """Spaces by names of bodies, with the weights of their shapes, and where each has its functions."""

    problem: Problem
    of: Mapping[str, RowSpace]
    places: Mapping[str, slice]

    @classmethod
    def on(cls, problem: Problem, given: SpaceOfBodies) -> Self:
        """Take the spaces of a problem. Raises InputError where there are not as many as bodies."""
        named = spaces_by_name(problem, given)
        names = list(named)
        spaces = {body.name: named[body.name].weighted(body.shape) for body in problem.bodies}
        ends = np.cumsum([space.size for space in spaces.values()]).tolist()
        starts = [0, *ends[:-1]]
        return cls(problem, spaces, dict(zip(names, map(slice, starts, ends), strict=True)))

    @property
    def size(self) -> int:
        """Number of all functions."""
        return sum(space.size for space in self.of.values())

    def side(self, body: str, side: Side) -> IntArray:
        """Functions that do not vanish on a side of a body, in the order of its parameter."""
        functions: IntArray = self.places[body].start + self.of[body].side_functions(side)
        return functions

    def boundary(self, boundary: Boundary) -> IntArray:
        """Functions that do not vanish on a part of a side, in the order of its parameter."""
        space, side = self.of[boundary.body], boundary.side
        along = {"bottom": space.rows[0], "top": space.rows[-1]}.get(side, space.across)
        ends = along.breakpoints
        # an end at a breakpoint meets it to round-off only, and takes no element more
        start, end = boundary.start + ROUND_OFF, boundary.end - ROUND_OFF
        (elements,) = np.nonzero((ends[1:] > start) & (ends[:-1] < end))
        first, last = along.first_functions[elements[[0, -1]]]
        return self.side(boundary.body, side)[first : last + along.degree + 1]

    def control_points(self) -> FloatArray:
        """Coefficients (size, 2) of the bodies as they are; read-only."""
        return self._control_points

    @cached_property
    def _control_points(self) -> FloatArray:
        bodies = self.problem.bodies
        found = [self.of[body.name].interpolate(body.shape.evaluate) for body in bodies]
        return frozen(np.concatenate(found))
