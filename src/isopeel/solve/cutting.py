"""Path control `auto`: a step that fails is cut; where the smallest step fails, the path jumps."""

from collections.abc import Iterable, Iterator
from itertools import pairwise

import numpy as np

from isopeel.solve.balance import on_one_branch
from isopeel.solve.bifurcation import change_branch
from isopeel.solve.branch import LEAST_REST, Branch
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.diagnosis import diagnosed
from isopeel.solve.jumps import jump
from isopeel.solve.path import Path
from isopeel.solve.step import Found, Kind
from isopeel.solve.verification import balanced

#: Halvings of a step after which its branch counts as ended.
_HALVINGS = 4
#: Most halvings of a step where the last step was short, as after a bifurcation.
_MOST_HALVINGS = 8


def cut_steps(path: Path, parameters: Iterable[float]) -> Iterator[Found]:
    """Yield steps that are halved where they fail, and grow again; where the smallest step fails, a jump.

    A step fails where it finds no equilibrium, or one whose energy does not come from the work of the drive.
    A cut step is a step of its own: a path continues from there bit for bit, and an irreversible joint has
    opened there. Where stability is lost, the path changes to the stable branch.
    """
    for parameter, is_last in _with_last(parameters):
        yield from _steps_to(path, parameter, is_last=is_last)


def _steps_to(path: Path, parameter: float, *, is_last: bool) -> Iterator[Found]:
    """Yield the steps from the last state to a requested parameter."""
    last = path.history[-1].parameter if path.history else parameter
    size = whole = parameter - last
    branch = Branch(path)
    has_bifurcated = False
    while True:
        reaches = abs(size) >= (1 - LEAST_REST) * abs(parameter - last)
        aim = parameter if reaches else last + size
        end = branch.end_before(aim)
        at_end = end is not None and end.last == last
        if end is not None:
            # step directly to the last known state of the branch, and continue from there
            aim = end.beyond if at_end else end.last
            size = size if at_end else aim - last
        kind: Kind = "requested" if aim == parameter else "between"
        cuts = bool(whole) and (size == whole or abs(size) > _shortest(path, whole))
        try:
            if at_end:
                found = _as_step(path, jump(path, aim), kind)
            else:
                found = Found(path.solver.equilibrium(aim, soon=cuts), kind)
                found = balanced(path, branch, found, cuts=cuts)
        except ConvergenceError as error:
            if at_end:
                branch.assume_continues()
                continue
            if cuts:
                size = min(abs(size), abs(parameter - last)) / 2 * np.sign(whole)
                continue
            found = _as_step(path, _jump_after_failure(path, branch, error, aim), kind)
        if found.kind == "jump":
            # a new branch begins with whole steps
            size = whole
        else:
            # the state may lie inside the step
            size = 2 * (size if found.parameter == aim else found.parameter - last)
        found = _counted(path, found, is_last=is_last and found.parameter == parameter)
        leaves_branch = False
        for one in change_branch(path, found) if found.negative else [found]:
            reaches = one.kind != "bifurcation" and one.parameter == parameter
            if one.kind == "bifurcation" and has_bifurcated:
                # its branches have nearly the same energy: a step has met the unstable one again
                one = one._replace(kind="between")
            has_bifurcated |= one.kind == "bifurcation"
            leaves_branch |= one.leaves_branch
            last, before = one.parameter, last
            yield one._replace(resumes=reaches)
        if reaches:
            return
        if found.negative:
            size = 2 * (last - before) or whole
        branch = Branch(path, None if leaves_branch else branch.end)


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


def _as_step(path: Path, found: Found, kind: Kind) -> Found:
    """Return a jump as it is, or as a step of a kind where its energy is that of the branch.

    Then the descent has found the state that Newton's method did not find.
    """
    if found.kind != "jump" or not path.history or path.history[-1].parameter == found.parameter:
        return found
    smooth = path.misfit(found.result).fits and on_one_branch(
        path.history[-1], path.accepted_state(found.result)
    )
    return found._replace(kind=kind) if smooth else found


def _jump_after_failure(path: Path, branch: Branch, error: ConvergenceError, parameter: float) -> Found:
    """Return the state that a path jumps to where its smallest step fails.

    Where its branch continues to the parameter after all, the first state on the branch is returned; likewise
    where the branch continues less far and no jump is found. Raises ConvergenceError with the cause of
    failure.
    """
    if not path.system.has_potential:
        raise diagnosed(path, error, parameter) from error
    inside = branch.followed(parameter, by_order=True) if path.history else []
    if inside and inside[-1].parameter == parameter:
        return inside[0]
    try:
        return jump(path, parameter)
    except ConvergenceError as failure:
        if error.cause == "held load":
            raise error from failure
        if inside and failure.cause == "energy without work":
            return inside[0]
        cause = diagnosed(path, error, parameter)
        if failure.cause == "long fall" and cause.cause != "limit load":
            raise failure from error
        raise (failure if cause is error else cause) from failure


def _counted(path: Path, found: Found, *, is_last: bool) -> Found:
    """Return an equilibrium with its negative eigenvalues, where they can be known at little cost.

    At the last state of a path they are counted in any case, but only to see instability: a longer path would
    not count here, and a stable state must be stored as there.
    """
    if found.negative is None:
        found = found._replace(negative=path.solver.negative_eigenvalues(found.result))
    if found.negative is None and is_last:
        found = found._replace(negative=path.solver.negative_eigenvalues(found.result, always=True) or None)
    return found
