"""Path control `continuation` and `jump`: where a path is not regular, it is followed as a curve."""

from collections.abc import Generator, Iterator, Sequence
from itertools import islice

import numpy as np

from isopeel.assembly.sizes import extent
from isopeel.solve.arc_length import Curve, Point
from isopeel.solve.balance import can_be_joined
from isopeel.solve.continuation import curve_from, follow_curve
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.descent import AWAY
from isopeel.solve.jumps import jump_from
from isopeel.solve.newton import NewtonResult, newton
from isopeel.solve.path import Path
from isopeel.solve.step import Found
from isopeel.solve.verification import without_gain

#: Most points of one stretch of the curve.
_MOST_POINTS = 5000
#: Share of the parameter in the tangent above which the curve is regular; it is 0.7 at the start of a
#: stretch.
_REGULAR = 0.5
#: Distances from a limit point at which jumps are started, in first radii of the curve.
_PUSHES = (0.25, 1.0, 4.0)
#: An equilibrium is well predicted where the parabola misses it by at most this share of the step's change.
_WELL_PREDICTED = 0.3


def along_curve(path: Path, values: Sequence[float], index: int, *, jumps: bool) -> Iterator[Found]:
    """Yield steps of the parameter where the path is regular, and steps of the arc length elsewhere.

    They meet the requested values from an index on. A step of the parameter is cheap, by its chord tangent.
    Along the arc length each value is met as often as the curve passes it, until the curve is regular again;
    with `jumps`, the path leaves the curve at the first limit point where stability is lost.
    """
    while index < len(values):
        parameter = values[index]
        if not path.history or path.history[-1].parameter == parameter:
            try:
                yield without_gain(path, Found(path.solver.equilibrium(parameter)))
            except ConvergenceError as error:
                # a stage that releases what was held begins with a jump, whatever the path control
                yield _jump_at_first(path, error, parameter)
            index += 1
        elif found := _regular(path, parameter):
            yield found
            index += 1
        else:
            index = yield from _stretch(path, values, index, jumps=jumps)


def _jump_at_first(path: Path, error: ConvergenceError, parameter: float) -> Found:
    """Return the state that a path jumps to where its first step fails; raises ConvergenceError."""
    if not path.system.has_potential:
        raise error
    try:
        return jump_from(path, path.solver.starts(parameter), parameter)
    except ConvergenceError as failure:
        raise (error if error.cause == "held load" else failure) from failure


def _regular(path: Path, parameter: float) -> Found | None:
    """Return the equilibrium where the path is clearly regular up to the parameter, else None.

    For forces with a potential the energy decides: on one branch a step releases nothing but the error of the
    trapezoidal rule. For other forces, and an unknown load, the parabola through the last states must predict
    the equilibrium well.
    """
    solver, last = path.solver, path.history[-1]
    found = solver.by_chord_tangent(parameter) if solver.has_chord_tangent else _predicted(path, parameter)
    if found is None:
        return None
    if path.system.has_potential:
        step = parameter - last.parameter
        if not can_be_joined(last, path.accepted_state(found), step, path.gain_allowed):
            solver.drop_tangent()
            return None
    return Found(found, negative=solver.negative_eigenvalues(found))


def _predicted(path: Path, parameter: float) -> NewtonResult | None:
    """Return the equilibrium by Newton's method, or None where the parabola does not predict it well."""
    guess = path.solver.parabola(parameter)
    try:
        found = newton(path.system, guess, parameter, path.settings)
    except ConvergenceError:
        return None
    missed = np.abs(found.unknown_values - guess).max()
    moved = np.abs(found.unknown_values - path.history[-1].unknown_values).max()
    return found if missed <= _WELL_PREDICTED * moved else None


def _stretch(path: Path, values: Sequence[float], index: int, *, jumps: bool) -> Generator[Found, None, int]:
    """Yield points of the curve until it is regular again or jumps; return the index of the next value."""
    step = values[index] - path.history[-1].parameter
    curve = curve_from(path, values[index])
    first, end = _leg(values, index, step)
    forwards = np.sign(step)
    point, far = curve.start, AWAY * extent(path.system.problem)
    for one in islice(follow_curve(path, curve, step, values[first:end]), _MOST_POINTS):
        for at, k in one.crossings:
            if k is None:
                yield Found(at.result, "limit point", at.negative, resumes=False)
                if jumps and one.begin.negative == 0:
                    yield _jump(path, curve, at)._replace(resumes=False)
                    # the next value lies beyond the limit point
                    while index < end and (values[index] - at.parameter) * forwards <= 0:
                        index += 1
                    return index
                continue
            calm = abs(curve.share(at)) > _REGULAR and at.negative in (0, None)
            ends = first + k >= index and at.turning * forwards > 0 and (calm or first + k == end - 1)
            yield Found(at.result, "requested", at.negative, resumes=ends)
            if ends:
                return first + k + 1
        point = one.end
        if path.system.control.raises_load and np.abs(point.result.displacement).max() > far:
            reason = "the body comes off and moves away: no larger load has an equilibrium"
            raise ConvergenceError(reason, (), values[index], "limit load")
        if point.parameter not in values[first:end]:
            yield Found(point.result, "between", point.negative, resumes=False)
    reason = f"{_MOST_POINTS} points of the curve do not reach the next value"
    raise ConvergenceError(reason, (), point.parameter)


def _jump(path: Path, curve: Curve, limit: Point) -> Found:
    """Return the stable equilibrium that a descent of the energy reaches from a limit point."""
    energy = path.accepted_state(limit.result).energy
    for push in _PUSHES:
        start = limit.unknown_values + push * curve.radius * limit.along
        found = jump_from(path, [start, limit.unknown_values], limit.parameter)
        if path.accepted_state(found.result).energy < energy:
            return found
    reason = "no other stable equilibrium was found beyond the limit point"
    raise ConvergenceError(reason, (), limit.parameter, "limit point")


def _leg(values: Sequence[float], index: int, step: float) -> tuple[int, int]:
    """Return first and end of the values around an index that follow in the direction of a step."""
    first, end = index, index + 1
    while first > 0 and (values[first] - values[first - 1]) * step > 0:
        first -= 1
    while end < len(values) and (values[end] - values[end - 1]) * step > 0:
        end += 1
    return first, end
