"""Path control: where a step finds no equilibrium, a path ends, cuts the step, jumps or follows its curve."""

from collections.abc import Generator, Iterable, Iterator, Sequence
from contextlib import nullcontext
from itertools import pairwise
from time import perf_counter

import numpy as np
from threadpoolctl import ThreadpoolController

from isopeel.common.interrupts import check, deferred
from isopeel.matrix.factor import SingularError
from isopeel.solve.balance import NO_MISFIT, Misfit
from isopeel.solve.bifurcation import change_branch
from isopeel.solve.branch import LEAST_REST
from isopeel.solve.continuation import (
    CALM_COSINE,
    LEAST_COSINE,
    SHORTEST,
    USUAL_TANGENTS,
    Curve,
    Point,
)
from isopeel.solve.newton import ConvergenceError
from isopeel.solve.path import Path
from isopeel.solve.step import AcceptedState, Found, Kind, Step

#: Halvings of a step after which its branch counts as ended.
_HALVINGS = 4
#: Most halvings of a step where the last step was short, as after a bifurcation.
_MOST_HALVINGS = 8
#: Most points of the curve to find a limit point: a step of the parameter has about ten at most.
_MOST_SEARCHED = 40
#: Most points of one stretch of the curve.
_MOST_POINTS = 5000
#: Share of the parameter in the tangent above which the curve is regular; it is 0.7 at the start of a
#: stretch.
_REGULAR = 0.5
#: Distances from a limit point at which jumps are started, in first radii of the curve.
_PUSHES = (0.25, 1.0, 4.0)


def follow_path(path: Path, parameters: Iterable[float], passed: Sequence[float]) -> Iterator[Step]:
    """Yield the steps of a path through parameters, with the path control of its settings.

    `passed` are values of the parameter that the path has met before.
    """
    path_control = path.settings.path_control
    found: Iterator[Found]
    if path_control == "newton":
        found = _plain(path, parameters)
    elif path_control == "auto":
        found = _cut(path, parameters)
    else:
        found = _along_the_curve(path, [*passed, *parameters], len(passed), jumps=path_control == "jump")
    libraries = ThreadpoolController().select(user_api="blas")
    threaded = any(library["num_threads"] > 1 for library in libraries.info())
    while True:
        began = perf_counter()
        # for narrow bands and short vectors, starting threads costs more than they gain
        with deferred(), libraries.limit(limits=1) if threaded else nullcontext():
            check()
            try:
                one = next(found, None)
            except ConvergenceError as error:
                raise error.located(path.system) from error.__cause__
            if one is None:
                return
            step = path.step(one, began)
        yield step


def _plain(path: Path, parameters: Iterable[float]) -> Iterator[Found]:
    for parameter in parameters:
        try:
            yield _without_gain(path, path.equilibrium(parameter))
        except ConvergenceError as error:
            raise _diagnosed(path, error, parameter) from error


def _diagnosed(path: Path, error: ConvergenceError, parameter: float) -> ConvergenceError:
    """Return the error, with a limit point as its cause where the curve has one before the parameter."""
    if not path.history or path.history[-1].parameter == parameter:
        return error
    step = parameter - path.history[-1].parameter
    try:
        curve = Curve(path.system, path.settings, path.last_exact(), path.history[-1].parameter, step)
        point, radius = curve.start, curve.radius
        for _ in range(_MOST_SEARCHED):
            point, found, radius = _next(path, curve, point, radius, step, [parameter])
            for k, at in found:
                if k is None:
                    return _at_limit(path, error, parameter, at.parameter)
            if found:
                # the curve continues to the parameter
                break
    except (ConvergenceError, SingularError):
        # the curve cannot be followed: the cause stays as it is
        return error
    return error


def _at_limit(path: Path, error: ConvergenceError, parameter: float, limit: float) -> ConvergenceError:
    """Return the error of a step to a parameter beyond a limit point."""
    column = path.system.problem.drive.parameter_column
    at = f"{column.shown(limit):.6g} {column.unit}"
    if path.system.control.raises_load:
        reason = f"the largest load is reached: no equilibrium is near above {at}, a limit point of the load"
        return ConvergenceError(reason, error.iterations, parameter, "limit load")
    reason = f"the path turns back at {at}; {error.reason}"
    turned = ConvergenceError(reason, error.iterations, parameter, "limit point")
    turned.displacement = error.displacement
    return turned


def _cut(path: Path, parameters: Iterable[float]) -> Iterator[Found]:
    """Yield steps that are halved where they fail, and grow again; where the smallest step fails, a jump.

    A step fails where it finds no equilibrium, or one whose energy does not come from the work of the drive.
    A cut step is a step of its own: a path continues from there bit for bit, and an irreversible joint has
    opened there. Where stability is lost, the path changes to the stable branch.
    """
    for parameter, is_last in _with_last(parameters):
        last = path.history[-1].parameter if path.history else parameter
        size = whole = parameter - last
        path.branch.forget()
        has_bifurcated = False
        while True:
            whole_rest = abs(size) >= (1 - LEAST_REST) * abs(parameter - last)
            aim = parameter if whole_rest else last + size
            end = path.branch.end_before(aim)
            at_end = end is not None and end.last == last
            if end is not None:
                # step directly to the last known state of the branch, and continue from there
                aim = end.beyond if at_end else end.last
                size = size if at_end else aim - last
            kind: Kind = "requested" if aim == parameter else "between"
            cuts = bool(whole) and (size == whole or abs(size) > _shortest(path, whole))
            try:
                if at_end:
                    found = _fallen(path, aim, kind)
                else:
                    found = _balanced(path, path.equilibrium(aim, kind, soon=cuts), cuts=cuts)
            except ConvergenceError as error:
                if at_end:
                    path.branch.assume_continues()
                    continue
                if cuts:
                    size = min(abs(size), abs(parameter - last)) / 2 * np.sign(whole)
                    continue
                found = _fallen(path, aim, kind, error)
            if found.kind == "jump":
                # a new branch begins with whole steps
                size = whole / 2
            if found.parameter != aim:
                # a state inside the step
                aim, size = found.parameter, found.parameter - last
            size *= 2
            whole_rest = aim == parameter
            if found.negative is None:
                found = found._replace(negative=path.negative_eigenvalues(found))
            if found.negative is None and is_last and whole_rest:
                # count at the last state only to see instability: a longer path would not count here, and
                # a stable state must be stored as there
                found = found._replace(negative=path.negative_eigenvalues(found, always=True) or None)
            if found.negative:
                for over in change_branch(path, found):
                    whole_rest = over.kind != "bifurcation" and over.parameter == parameter
                    if over.kind == "bifurcation" and has_bifurcated:
                        # its branches have nearly the same energy: a step has met the unstable one again
                        over = over._replace(kind="between")
                    has_bifurcated |= over.kind == "bifurcation"
                    last, before = over.parameter, last
                    yield over._replace(resumes=whole_rest)
                size = 2 * (last - before) or whole
            else:
                yield found._replace(resumes=whole_rest)
                last = aim
            if whole_rest:
                break


def _fallen(path: Path, parameter: float, kind: Kind, error: ConvergenceError | None = None) -> Found:
    """Return the state that a path jumps to where its branch ends or its smallest step fails (`error`)."""
    found = path.jump(parameter) if error is None else _jump_after_failure(path, error, parameter)
    # the descent may have found the state that Newton's method did not find: then it is no jump
    smooth = found.kind == "jump" and path.moves_to(parameter) and path.is_smooth(found)
    return found._replace(kind=kind) if smooth else found


def _with_last(parameters: Iterable[float]) -> Iterator[tuple[float, bool]]:
    """Yield each value, and whether it is the last one."""
    values = iter(parameters)
    value = next(values, None)
    while value is not None:
        following = next(values, None)
        yield value, following is None
        value = following


def _shortest(path: Path, whole: float) -> float:
    """Return the size at which a step is not halved again: a share of a whole step or of a shorter last one.

    Where a body buckles, for example, steps must be small against the distance from the bifurcation.
    """
    made = [abs(other.parameter - one.parameter) for one, other in pairwise(path.history[-2:])]
    least = abs(whole) * 0.5**_MOST_HALVINGS
    return max(min([abs(whole), *made]) * 0.5**_HALVINGS, least)


def _without_gain(path: Path, found: Found) -> Found:
    """Return an equilibrium that has gained no energy without work; raises ConvergenceError otherwise.

    A step to another branch of less energy is accepted, as in published studies; one of more energy is not.
    """
    misfit = path.misfit(found)
    if misfit is NO_MISFIT:
        return found
    if not misfit.gains:
        return found._replace(is_balanced=misfit.fits)
    misfit, _ = path.branch.verified(found, by_order=True)
    if misfit.gains:
        raise _unbalanced(path, found, misfit)
    return found._replace(is_balanced=True)


def _balanced(path: Path, found: Found, *, cuts: bool) -> Found:
    """Return an equilibrium whose energy comes from the work of the drive; raises ConvergenceError otherwise.

    Where the ends of the step do not suffice to decide: if the step may be cut (`cuts`), the error makes the
    path cut it; if not, the branch inside the step is followed, and its first state is returned. A step whose
    misfit may be the error of the trapezoidal rule stays whole.
    """
    misfit = path.misfit(found)
    if misfit is NO_MISFIT:
        return found
    inside: list[Found] = []
    if not misfit.fits and (misfit.is_slight or not cuts):
        misfit, inside = path.branch.verified(found, by_order=not cuts)
    if not misfit.fits:
        raise _unbalanced(path, found, misfit)
    return inside[0] if len(inside) > 1 and not misfit.is_slight else found._replace(is_balanced=True)


def _unbalanced(path: Path, found: Found, misfit: Misfit) -> ConvergenceError:
    path.forget()
    energy = f"{abs(misfit.gained):.3g} E0 L0^3"
    if misfit.gains:
        reason = f"the energy grows by {energy} without work of the drive: it is another branch"
    elif misfit.gained < 0:
        reason = f"the step releases an energy of {energy}: it passes a jump, or is too long"
    else:
        reason = "the step has met another branch"
    return ConvergenceError(reason, found.result.iterations, found.parameter, "energy without work")


def _jump_after_failure(path: Path, error: ConvergenceError, parameter: float) -> Found:
    """Return the state that a path jumps to where its smallest step fails.

    Where its branch continues to the parameter after all, the first state on the branch is returned; likewise
    where the branch continues less far and no jump is found. Raises ConvergenceError with the cause of
    failure.
    """
    if not path.has_energy:
        raise _diagnosed(path, error, parameter) from error
    inside = path.branch.followed(parameter, by_order=True) if path.history else []
    if inside and inside[-1].parameter == parameter:
        return inside[0]
    try:
        return path.jump(parameter)
    except ConvergenceError as failure:
        if inside and failure.cause == "energy without work":
            return inside[0]
        cause = _diagnosed(path, error, parameter)
        if failure.cause == "long fall" and cause.cause != "limit load":
            raise failure from error
        raise (failure if cause is error else cause) from failure


def _along_the_curve(path: Path, values: Sequence[float], index: int, *, jumps: bool) -> Iterator[Found]:
    """Yield steps of the parameter where the path is regular, and steps of the arc length elsewhere.

    A step of the parameter is cheap, by its chord tangent. Along the arc length each value is met as often as
    the curve passes it, until the curve is regular again.
    """
    while index < len(values):
        if not path.history or path.history[-1].parameter == values[index]:
            try:
                yield _without_gain(path, path.equilibrium(values[index]))
            except ConvergenceError:
                # a stage that releases what was held begins with a jump, whatever the path control
                if not path.has_energy:
                    raise
                yield path.jump_from(path.guesses(values[index]), values[index])
            index += 1
        elif found := path.regular(values[index]):
            yield found
            index += 1
        else:
            index = yield from _stretch(path, values, index, jumps=jumps)


def _stretch(path: Path, values: Sequence[float], index: int, *, jumps: bool) -> Generator[Found, None, int]:
    """Yield points of the curve until it is regular again or jumps; return the index of the next value."""
    step = values[index] - path.history[-1].parameter
    curve = Curve(path.system, path.settings, path.last_exact(), path.history[-1].parameter, step)
    first, end = _leg(values, index, step)
    forwards = np.sign(step)
    point, radius = curve.start, curve.radius
    for _ in range(_MOST_POINTS):
        curve.system = path.system
        ahead, found, radius = _next(path, curve, point, radius, step, values[first:end])
        for k, at in found:
            if k is None:
                yield Found(at.parameter, at.result, "limit point", at.negative, resumes=False)
                if jumps and point.negative == 0:
                    yield _jump(path, curve, at)._replace(resumes=False)
                    # the next value lies beyond the limit point
                    while index < end and (values[index] - at.parameter) * forwards <= 0:
                        index += 1
                    return index
                continue
            calm = abs(curve.share(at)) > _REGULAR and at.negative in (0, None)
            ends = first + k >= index and at.turning * forwards > 0 and (calm or first + k == end - 1)
            yield Found(values[first + k], at.result, "requested", at.negative, resumes=ends)
            if ends:
                return first + k + 1
        point = ahead
        if point.parameter not in values[first:end]:
            yield Found(point.parameter, point.result, "between", point.negative, resumes=False)
    raise ConvergenceError(
        f"{_MOST_POINTS} points of the curve do not reach the next value",
        (),
        point.parameter,
        "iteration limit",
    )


def _next(
    path: Path, curve: Curve, point: Point, radius: float, step: float, values: Sequence[float]
) -> tuple[Point, list[tuple[int | None, Point]], float]:
    """Return the next point of the curve, the values and limit points before it, and the next radius.

    It passes values of the parameter, given by their indices, and limit points, given by None. Raises
    ConvergenceError where the shortest step fails.
    """
    while True:
        try:
            new = curve.beyond(point, radius)
            cosine = curve.straightness(point, new)
            if cosine < LEAST_COSINE or (
                path.has_energy
                and not path.fits(_accepted_state(path, point), _accepted_state(path, new), step)
            ):
                reason = "the curve turns too sharply for the shortest step"
                raise ConvergenceError(reason, new.iterations, point.parameter, "stalled residual")
            found = _met_between(curve, point, new, values)
        except (ConvergenceError, SingularError) as error:
            radius /= 2
            if radius >= SHORTEST * curve.radius:
                continue
            if isinstance(error, ConvergenceError):
                raise
            raise ConvergenceError(str(error), (), point.parameter, "singular tangent") from error
        if cosine > CALM_COSINE:
            radius *= float(np.clip(USUAL_TANGENTS / new.tangents, 0.5, 2.0))
        # a longer step could miss a snap-back
        return new, found, min(radius, curve.radius)


def _met_between(
    curve: Curve, point: Point, new: Point, values: Sequence[float]
) -> list[tuple[int | None, Point]]:
    limit = curve.limit_point(point, new) if (new.turning > 0) != (point.turning > 0) else None
    ends = [point, new] if limit is None else [point, limit, new]
    found: list[tuple[int | None, Point]] = []
    for one, other in pairwise(ends):
        passed = _passed(values, one.parameter, other.parameter)
        found += [(k, curve.at_parameter(one, other, values[k])) for k in passed]
        if other is limit:
            found.append((None, other))
    return found


def _jump(path: Path, curve: Curve, limit: Point) -> Found:
    """Return the stable equilibrium that a descent of the energy reaches from a limit point."""
    energy = _accepted_state(path, limit).energy
    for push in _PUSHES:
        start = limit.unknown_values + push * curve.radius * limit.along
        found = path.jump_from([start, limit.unknown_values], limit.parameter)
        result = found.result
        reached, _ = path.system.potential(
            result.equilibrium, result.displacement, result.load, limit.parameter
        )
        if reached < energy:
            return found
    raise ConvergenceError(
        "no other stable equilibrium was found beyond the limit point", (), limit.parameter, "limit point"
    )


def _accepted_state(path: Path, point: Point) -> AcceptedState:
    return path.accepted_state(
        point.parameter, point.unknown_values, point.displacement, point.load, point.equilibrium
    )


def _leg(values: Sequence[float], index: int, step: float) -> tuple[int, int]:
    """Return first and end of the values around an index that follow in the direction of a step."""
    first, end = index, index + 1
    while first > 0 and (values[first] - values[first - 1]) * step > 0:
        first -= 1
    while end < len(values) and (values[end] - values[end - 1]) * step > 0:
        end += 1
    return first, end


def _passed(values: Sequence[float], one: float, other: float) -> list[int]:
    """Return the indices of the values beyond one parameter, up to another, in the order of passing."""
    found = [
        k for k, value in enumerate(values) if 0 < (value - one) * np.sign(other - one) <= abs(other - one)
    ]
    return sorted(found, key=lambda k: abs(values[k] - one))
