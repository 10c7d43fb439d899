"""Why a step finds no equilibrium: a limit point of the curve before its parameter, or the cause as it is."""

from itertools import islice

from isopeel.solve.continuation import curve_from, follow_curve
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.path import Path

#: Most points of the curve to find a limit point: a step of the parameter has about ten at most.
_MOST_SEARCHED = 40


def diagnosed(path: Path, error: ConvergenceError, parameter: float) -> ConvergenceError:
    """Return the error, with a limit point as its cause where the curve has one before the parameter."""
    if not path.history or path.history[-1].parameter == parameter:
        return error
    step = parameter - path.history[-1].parameter
    try:
        steps = follow_curve(path, curve_from(path, parameter), step, [parameter])
        for one in islice(steps, _MOST_SEARCHED):
            for at, value in one.crossings:
                if value is None:
                    return _at_limit(path, error, parameter, at.parameter)
            if one.crossings:
                # the curve continues to the parameter
                break
    except ConvergenceError:
        # the curve cannot be followed: the cause stays as it is
        return error
    return error


def _at_limit(path: Path, error: ConvergenceError, parameter: float, limit: float) -> ConvergenceError:
    """Return the error of a step to a parameter beyond a limit point."""
    column = path.system.problem.drive.parameter_column
    at = column.text(column.shown(limit))
    if path.system.control.raises_load:
        reason = f"the largest load is reached: no equilibrium was found beyond {at}, a limit point"
        return ConvergenceError(reason, error.iterations, parameter, "limit load")
    reason = f"the path turns back at {at}; {error.reason}"
    turned = ConvergenceError(reason, error.iterations, parameter, "limit point")
    turned.displacement = error.displacement
    return turned
