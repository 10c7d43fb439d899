"""Bifurcations: where a path loses its stability, and how it changes to the stable branch.

Beyond a bifurcation the old branch continues smoothly, and a method that solves equations stays on it. A body
leaves it at the least disturbance: a film buckles, a tape that is pulled back folds over. The bifurcation is
located by bisection between a stable and an unstable state. A state beyond it is disturbed along the motion
that lowers its energy; from there a descent of the energy reaches the stable branch.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from isopeel.assembly.sizes import extent
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.physics.batch import evaluate_substrate
from isopeel.problem import Boundary
from isopeel.solve.balance import MISFIT, on_one_branch, released
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.descent import potential_energy
from isopeel.solve.jumps import jump_from
from isopeel.solve.newton import newton
from isopeel.solve.path import Path
from isopeel.solve.stability import critical_motion, stability
from isopeel.solve.step import AcceptedState, Found

#: Accuracy of a bifurcation, as a share of the step in which stability is lost or of the parameter, whichever
#: is less. A bifurcation within a millionth of the step from its start counts as at the start.
LOCATED = 1e-3
_SMALLEST = 1e-6
#: Most halvings to locate it.
_MOST_HALVINGS = 30
#: Distance beyond the bifurcation at which the other branch is first looked for, as a share of the rest of
#: the step. There the distance of the two branches goes with the root of this distance, and the energy still
#: decreases along the critical motion only. The ends of six paths, of which five buckle, are the same to
#: seven digits for 1/128 to 1. With a small share the curve has more rows where the branches part.
_BEYOND = 1 / 32
#: Size of the first disturbance, as a share of the body's size; it is doubled as long as the energy
#: decreases.
_DISTURBANCE = 1e-5
_MOST_DOUBLINGS = 16
#: Most disturbances in a row, where the state that the first one reaches is unstable too.
_MOST_ROUNDS = 4
#: Two branches are mirror images where their energies differ by less than this share of the energy released.
_ALIKE = 1e-6
#: Largest distance of the states on both sides of a bifurcation, as a share of the change in the step.
_NEAR = 0.1


class Bracket(NamedTuple):
    """The last stable state of a branch, if that is known, and an unstable one of the same or another."""

    stable: Found | None
    unstable: Found


def change_branch(path: Path, found: Found) -> Iterator[Found]:
    """Yield the states from the bifurcation to a stable equilibrium, given an unstable one.

    The stable equilibrium lies at or before the parameter of the unstable one. If there was a stable state
    before, the bifurcation is yielded first. If the unstable equilibrium is not on the branch of the path, a
    stable state of this branch is yielded instead. Raises ConvergenceError if no stable branch is found.
    """
    path.solver.drop_tangent()
    if not path.history or path.history[-1].parameter == found.parameter:
        yield _stable(path, found.result.unknown_values, found.parameter)
        return
    bracket = _located(path, found)
    if bracket.stable is not None:
        yield bracket.stable
        if bracket.stable.kind != "bifurcation":
            return
    begin = path.history[-1]
    start, end = bracket.unstable, found
    rest = end.parameter - begin.parameter
    offset = rest * _BEYOND
    if abs(offset) < abs(start.parameter - begin.parameter):
        # closer to the bifurcation the state may still be stable
        offset = start.parameter - begin.parameter
    while True:
        at = end.parameter if abs(offset) >= abs(rest) else begin.parameter + offset
        try:
            jumped = _stable(path, _unstable(path, start, end, at), at)
            break
        except ConvergenceError:
            if at == end.parameter:
                raise
            offset *= 2
    state = path.accepted_state(jumped.result)
    work = max(abs(begin.rate), abs(state.rate)) * abs(at - begin.parameter)
    # on the branch that begins at the bifurcation the energy comes from the work; else it is a jump
    smooth = released(begin, state) <= path.gain_allowed + MISFIT * work
    kind = found.kind if at == end.parameter else "between"
    yield jumped._replace(kind=kind if smooth else "jump", is_elsewhere=True)


def _located(path: Path, found: Found) -> Bracket:
    low, high = _sides(path, found)
    if low is None:
        return Bracket(None, high)
    begin, step, stable = low, high.parameter - low.parameter, None
    for _ in range(_MOST_HALVINGS):
        width = high.parameter - low.parameter
        enough = max(_SMALLEST * abs(step), LOCATED * min(abs(step), abs(high.parameter)))
        parameter = low.parameter + width / 2
        if abs(width) <= enough or parameter in (low.parameter, high.parameter):
            break
        middle, is_stable = _between(path, begin, low, high, parameter)
        if middle is None:
            break
        if is_stable:
            low, stable = path.accepted_state(middle.result), middle
        else:
            high = middle
    n = path.system.constraints.count
    apart = np.abs(high.result.unknown_values - low.unknown_values)[:n].max()
    moved = np.abs(found.result.unknown_values - begin.unknown_values)[:n].max()
    if apart > _NEAR * moved:
        return Bracket(stable, high)
    if stable is None and low.parameter == path.history[-1].parameter:
        # stability is lost at the last step
        try:
            result = newton(path.system, low.exact, low.parameter, path.settings)
            stable = Found(result)
        except ConvergenceError:
            pass
    if stable is not None:
        stable = stable._replace(kind="bifurcation", negative=0)
    return Bracket(stable, high)


def _sides(path: Path, found: Found) -> tuple[AcceptedState | None, Found]:
    """Return the last stable state of a path, if known, and the first unstable one."""
    high = found
    # earlier states of an irreversible joint had another damage
    states = path.history[-1:] if path.system.irreversible else path.history
    for state in reversed(states):
        known = stability(path.system, state.unknown_values, state.parameter)
        if known is not None and known.negative == 0:
            return state, high
        try:
            result = newton(path.system, state.exact, state.parameter, path.settings)
        except ConvergenceError:
            break
        high = Found(result, "between", resumes=False)
    return None, high


def _between(
    path: Path, begin: AcceptedState, low: AcceptedState, high: Found, parameter: float
) -> tuple[Found | None, bool]:
    """Return an equilibrium between two others, and whether it is a stable one of the branch of the first."""
    # first extrapolate the branch of the stable state: the unstable one may be of another branch
    if low is not begin:
        share = (parameter - low.parameter) / (low.parameter - begin.parameter)
        starts = [low.unknown_values + share * (low.unknown_values - begin.unknown_values)]
    else:
        starts = [path.solver.parabola(parameter)]
    share = (parameter - low.parameter) / (high.parameter - low.parameter)
    chord = low.unknown_values + share * (high.result.unknown_values - low.unknown_values)
    starts += [low.unknown_values, chord]
    first = None
    for start in starts:
        try:
            result = newton(path.system, start, parameter, path.settings)
        except ConvergenceError:
            continue
        found = Found(result, "between", 0, resumes=False)
        first = first or found
        # the energy of a neighbouring branch differs by a share of the work
        if on_one_branch(low, path.accepted_state(result)):
            return found, path.solver.negative_eigenvalues(result, always=True) == 0
    return first, False


def _unstable(path: Path, start: Found, end: Found, parameter: float) -> FloatArray:
    """Return the unknowns (count,) of an unstable state between two others, or of the first of these."""
    one, other = start.result.unknown_values, end.result.unknown_values
    for known, y in ((start, one), (end, other)):
        if parameter == known.parameter:
            return y
    share = (parameter - start.parameter) / (end.parameter - start.parameter)
    for y in (one + share * (other - one), one):
        try:
            return newton(path.system, y, parameter, path.settings).unknown_values
        except ConvergenceError:
            continue
    return one


def _stable(path: Path, y: FloatArray, parameter: float) -> Found:
    """Return the stable equilibrium that a descent of the energy reaches from an unstable one, y (count,).

    Raises ConvergenceError.
    """
    for _ in range(_MOST_ROUNDS):
        known = stability(path.system, y, parameter)
        if known is None or known.negative == 0:
            break
        motion = critical_motion(path.system, known.factor)
        energy = potential_energy(path.system, y, parameter)
        tried: list[tuple[float, Found]] = []
        for sign in (1.0, -1.0):
            start = _disturbed(path, y, sign * motion, parameter)
            try:
                jumped = jump_from(path, [start], parameter)
            except ConvergenceError:
                continue
            tried.append((path.accepted_state(jumped.result).energy, jumped))
        tried = [one for one in tried if one[0] < energy or not np.isfinite(energy)]
        if not tried:
            raise ConvergenceError(
                "it is unstable, and no stable equilibrium is found near it", (), parameter, "instability"
            )
        best = _preferred(path, tried, energy)
        if path.solver.negative_eigenvalues(best.result, always=True) == 0:
            return best._replace(negative=0)
        y = best.result.unknown_values
    raise ConvergenceError(
        "it is unstable, and so is the state that the descent of the energy reaches",
        (),
        parameter,
        "instability",
    )


def _disturbed(path: Path, y: FloatArray, motion: FloatArray, parameter: float) -> FloatArray:
    """Return the unknowns (count,) moved along a motion as far as the energy decreases."""
    size = _DISTURBANCE * extent(path.system.problem)
    best = potential_energy(path.system, y + size * motion, parameter)
    for _ in range(_MOST_DOUBLINGS):
        further = potential_energy(path.system, y + 2 * size * motion, parameter)
        if not further < best:
            break
        size, best = 2 * size, further
    return y + size * motion


def _preferred(path: Path, tried: list[tuple[float, Found]], energy: float) -> Found:
    """Return the preferred stable state of both sides: outside the substrate, of less energy, or away."""
    if len(tried) == 1:
        return tried[0][1]
    (one, first), (other, second) = tried
    gaps = [_gaps(path.system, found.result.displacement) for _, found in tried]
    depths = [-float(one_side.min(initial=0.0)) for one_side in gaps]
    if abs(depths[0] - depths[1]) > _DISTURBANCE * extent(path.system.problem):
        return first if depths[0] < depths[1] else second
    if abs(one - other) > _ALIKE * (energy - min(one, other)):
        return first if one < other else second
    return first if float(gaps[0].sum()) > float(gaps[1].sum()) else second


def _gaps(system: System, displacement: FloatArray) -> FloatArray:
    """Return the gaps (n,) of the control points to the nearest substrate, for u (size, 2).

    Bodies without a substrate have none.
    """
    gaps, points = np.full(len(displacement), np.inf), system.spaces.control_points()
    for interface in system.problem.interfaces:
        if isinstance(interface.against, Boundary):
            continue
        place, substrate = system.spaces.places[interface.boundary.body], interface.substrate
        position = points[place] + displacement[place]
        gap = evaluate_substrate(substrate.kernel, substrate.parameters, position)[0]
        gaps[place] = np.minimum(gaps[place], gap)
    return gaps[gaps < np.inf]
