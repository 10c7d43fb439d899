"""Jumps: at one value of the parameter, a descent of the energy reaches another stable equilibrium."""

from collections.abc import Sequence

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.solve.augmentation import augmented
from isopeel.solve.balance import MISFIT
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.descent import Descent, descend, potential_energy
from isopeel.solve.newton import newton
from isopeel.solve.path import Path
from isopeel.solve.step import Found

#: Iterations of a descent after which the body without its joint is tried: a jump over some elements takes 10
#: to 170 iterations, the jump of a block that comes off on a fine mesh many hundreds. When this limit was
#: 200, a stamp of 60 x 10 elements came off as a whole where the full descent ends half open.
_FAR = 3000
#: The same under a prescribed load: a longer descent means that the load is too large.
_FAR_UNDER_LOAD = 700


def jump(path: Path, parameter: float) -> Found:
    """Return the equilibrium at a parameter that the last states jump to.

    The energy may grow by the work of the drive at most. Raises ConvergenceError.
    """
    last = path.history[-1] if path.history else None
    failure: ConvergenceError | None = None
    for start in path.solver.starts(parameter):
        try:
            found = jump_from(path, [start], parameter)
        except ConvergenceError as error:
            failure = failure or error
            if error.cause in ("limit load", "long fall"):
                # the descent from another start would go as far
                break
            continue
        if last is None or path.begins:
            return found
        state = path.accepted_state(found.result)
        step = parameter - last.parameter
        # before the jump the drive has done work at the old rate or at the new one
        most = max(last.rate * step, state.rate * step)
        if state.energy <= last.energy + most + path.gain_allowed:
            return found
    reason = "every state that a descent of the energy reaches has more energy than the drive has done work"
    raise failure or ConvergenceError(reason, (), parameter, "energy without work")


def jump_from(path: Path, starts: Sequence[FloatArray], parameter: float) -> Found:
    """Return the stable equilibrium that a descent of the energy reaches: a jump.

    It begins at the first of some starts (count,) at which no element is inverted. Raises ConvergenceError
    where it reaches no equilibrium.
    """
    path.solver.drop_tangent()
    system = path.system
    for start in starts:
        # an extrapolated start may invert elements
        if np.isfinite(potential_energy(system, start, parameter)):
            break
    far = _FAR_UNDER_LOAD if system.control.raises_load else _FAR
    descent = descend(system, start, parameter, far)
    loose = _come_off(path, descent, parameter) if descent.is_unfinished else None
    if loose is not None:
        descent = descend(system, loose, parameter)
    if descent.is_unfinished:
        reason = "the descent of the energy goes far, and has not ended after many steps"
        raise ConvergenceError(reason, (), parameter, "long fall")
    if descent.away:
        reason = "the body comes off and moves away: its energy has no lower bound"
        raise ConvergenceError(reason, (), parameter, "limit load")
    try:
        result = newton(system, descent.unknown_values, parameter, path.settings)
        result = augmented(system, result, path.settings)
    except ConvergenceError as error:
        if not descent.line_search_failed:
            raise
        reason = f"the line search of the descent failed, and {error.reason}"
        raise ConvergenceError(reason, error.iterations, parameter, "line search") from error
    fallen_from, reached = (potential_energy(system, y, parameter) for y in (start, descent.unknown_values))
    # where points of a stiff contact open and close, Newton's method raises the energy a little again; the
    # start may lie below, as an unknown load has not done its work yet
    given_back = MISFIT * max(fallen_from - reached, 0.0) if np.isfinite(fallen_from) else 0.0
    if path.accepted_state(result).energy > reached + path.gain_allowed + given_back:
        reason = "Newton's method leaves the state that the descent of the energy has reached"
        raise ConvergenceError(reason, result.iterations, parameter, "line search")
    return Found(result, "jump", 0)


def _come_off(path: Path, descent: Descent, parameter: float) -> FloatArray | None:
    """Return the unknowns (count,) of the body without its joint where their energy is lower, else None.

    The energy is compared with that of a long descent. A block whose joint opens at an edge comes off as a
    whole, while a descent has to open it point by point. Returns None too where the body is held by its joint
    alone.
    """
    system = path.system
    reached = potential_energy(system, descent.unknown_values, parameter)
    for start in (descent.unknown_values, *(state.unknown_values for state in path.history[-1:])):
        try:
            loose = newton(system.without_joint(), start, parameter, path.settings).unknown_values
        except ConvergenceError:
            continue
        return loose if potential_energy(system, loose, parameter) < reached else None
    return None
