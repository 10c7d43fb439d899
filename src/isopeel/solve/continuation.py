"""Continuation: steps along the curve of a path, whose length adapts, and what they pass."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from isopeel.matrix.factor import SingularError
from isopeel.solve.arc_length import Curve, Point
from isopeel.solve.balance import can_be_joined
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.curve_search import TURNED, at_parameter, limit_point
from isopeel.solve.path import Path

#: Number of tangents that the radius is chosen for.
_USUAL_TANGENTS = 2
#: Least cosine of the angles between the tangents at both ends of a step and its chord.
LEAST_COSINE = 0.8
#: The same where the radius may grow.
CALM_COSINE = 0.95
#: Least radius, as a share of the first radius.
SHORTEST = 2.0**-20
#: Change of the parameter that is round-off, as a share of the largest requested value.
_ROUND_OFF = 1e-14


class Crossing(NamedTuple):
    """A point that a step along the curve passes: at one of the requested values, or a limit point."""

    point: Point
    value: int | None  # index of the requested value; None at a limit point


class CurveStep(NamedTuple):
    """A step along the curve, and what it passes, in this order."""

    begin: Point
    end: Point
    crossings: list[Crossing]


def curve_from(path: Path, parameter: float) -> Curve:
    """Return the curve of a path at its last state, in the direction of a parameter.

    Raises ConvergenceError, also where the tangent is singular there.
    """
    last = path.history[-1].parameter
    try:
        return Curve(path.system, path.settings, path.solver.last_exact(), last, parameter - last)
    except SingularError as error:
        raise ConvergenceError(str(error), (), last, "singular tangent") from error


def follow_curve(path: Path, curve: Curve, step: float, values: Sequence[float]) -> Iterator[CurveStep]:
    """Yield steps along a curve of a path, without end, with their crossings of requested values.

    `step` is a usual step of the parameter. The points may be accepted as steps of the path in between.
    Raises ConvergenceError where the shortest step fails.
    """
    point, radius = curve.start, curve.radius
    while True:
        curve.system = path.system
        found, radius = _next(path, curve, point, radius, step, values)
        yield found
        point = found.end


def _next(
    path: Path, curve: Curve, point: Point, radius: float, step: float, values: Sequence[float]
) -> tuple[CurveStep, float]:
    """Return the next step, halved as often as necessary, and the next radius."""
    while True:
        try:
            new = curve.beyond(point, radius)
            cosine = curve.straightness(point, new)
            if cosine < LEAST_COSINE or not _can_be_joined(path, point, new, step):
                reason = "the curve turns too sharply for the shortest step"
                raise ConvergenceError(reason, new.result.iterations, point.parameter, "stalled residual")
            crossings = _crossings(curve, point, new, values)
        except (ConvergenceError, SingularError) as error:
            radius /= 2
            if radius >= SHORTEST * curve.radius:
                continue
            if isinstance(error, ConvergenceError):
                raise
            raise ConvergenceError(str(error), (), point.parameter, "singular tangent") from error
        if cosine > CALM_COSINE:
            radius *= float(np.clip(_USUAL_TANGENTS / new.tangents, 0.5, 2.0))
        # a longer step could miss a snap-back
        return CurveStep(point, new, crossings), min(radius, curve.radius)


def _can_be_joined(path: Path, point: Point, new: Point, step: float) -> bool:
    if not path.system.has_potential:
        return True
    one, other = (path.accepted_state(end.result) for end in (point, new))
    return can_be_joined(one, other, step, path.gain_allowed)


def _crossings(curve: Curve, point: Point, new: Point, values: Sequence[float]) -> list[Crossing]:
    turns = (new.turning > 0) != (point.turning > 0)
    # a load that has vanished stays zero to round-off, whose sign means nothing
    stays = max(abs(curve.share(point)), abs(curve.share(new))) <= TURNED
    limit = limit_point(curve, point, new) if turns and not stays else None
    ends = [point, new] if limit is None else [point, limit, new]
    found: list[Crossing] = []
    for one, other in pairwise(ends):
        passed = _passed(values, one.parameter, other.parameter)
        found += [Crossing(at_parameter(curve, one, other, values[k]), k) for k in passed]
        if other is limit:
            found.append(Crossing(other, None))
    return found


def _passed(values: Sequence[float], one: float, other: float) -> list[int]:
    """Return the indices of the values beyond one parameter, up to another, in the order of passing."""
    if abs(other - one) <= _ROUND_OFF * np.abs(values).max():
        return []
    found = [
        k for k, value in enumerate(values) if 0 < (value - one) * np.sign(other - one) <= abs(other - one)
    ]
    return sorted(found, key=lambda k: abs(values[k] - one))
