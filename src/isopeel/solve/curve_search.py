"""Points between two others of a curve: at a requested parameter, and at a limit point."""

from collections.abc import Callable

import numpy as np

from isopeel.matrix.factor import SingularError
from isopeel.solve.arc_length import Curve, Point
from isopeel.solve.convergence import ConvergenceError

#: Largest share of the parameter in the tangent at a limit point; the error in the parameter is its square.
TURNED = 1e-6
#: Share of the parameter's change in a step to which a value is approached before Newton's method finishes
#: it.
_MET = 1e-10
#: A trial of a root search along the curve is slow if more than this share of the last value remains.
_SLOW = 0.5
#: Number of points that such a search interpolates.
_INTERPOLATED = 4
#: Share of a step to which a limit point is located at a corner of the curve, where the tangent jumps.
_CORNER = 1e-6
#: Most trials of such a search: enough to halve a step down to round-off, even if each second trial is slow.
_MOST_TRIALS = 120


def at_parameter(curve: Curve, one: Point, other: Point, parameter: float) -> Point:
    """Return the point at a parameter between two points without a limit point between them.

    It is found by Newton's method from the chord. Next to a limit point, where there are two solutions,
    Newton's method may find the other one: then the parameter is first approached along the curve. Raises
    ConvergenceError and SingularError.
    """
    share = (parameter - one.parameter) / (other.parameter - one.parameter)
    chord = one.unknown_values + share * (other.unknown_values - one.unknown_values)
    length, rises = curve.distance(one, other), other.parameter > one.parameter
    try:
        found = curve.at_parameter(chord, parameter, other)
        if (found.turning > 0) == rises and 0 <= curve.distance(one, found) <= length:
            return found
    except (ConvergenceError, SingularError):
        pass

    def missed(point: Point) -> float:
        return point.parameter - parameter

    near = _between(curve, one, other, missed, _MET * abs(other.parameter - one.parameter))
    return curve.at_parameter(near.unknown_values, parameter, other)


def limit_point(curve: Curve, one: Point, other: Point) -> Point:
    """Return the limit point between two points, whose tangents point in opposite directions.

    Raises ConvergenceError and SingularError.
    """
    from scipy.interpolate import CubicHermiteSpline

    # the first guess is where the cubic through both points and tangents turns
    length = curve.distance(one, other)
    ends = [0.0, length], [one.parameter, other.parameter], [one.turning, other.turning]
    turns = [float(at) for at in CubicHermiteSpline(*ends).derivative().roots() if 0 < at < length]
    return _between(curve, one, other, curve.share, TURNED, turns[0] if turns else None)


def _between(
    curve: Curve,
    one: Point,
    other: Point,
    function: Callable[[Point], float],
    enough: float,
    guess: float | None = None,
) -> Point:
    """Return the point between two others at which a function is zero; it has opposite signs at these.

    The first trial is at a guess of the distance, if there is one. The next trials follow from inverse
    interpolation of the distance over the function's values, at the four points closest to zero; after a slow
    trial the middle is tried.
    """
    from scipy.interpolate import krogh_interpolate

    tried = [(function(point), curve.distance(one, point), point) for point in (one, other)]
    falls, last, slow = tried[0][0] > 0, np.inf, False
    low, high = 0.0, tried[1][1]
    corner = _CORNER * high if curve.has_corners else 0.0
    for _ in range(_MOST_TRIALS):
        tried = sorted(tried, key=lambda trial: abs(trial[0]))[:_INTERPOLATED]
        values, places, points = zip(*tried, strict=True)
        # values that are equal, as of a load that has vanished to round-off, cannot be interpolated
        known = guess if guess or len(set(values)) < len(values) else krogh_interpolate(values, places, 0.0)
        at, guess = (low + high) / 2 if known is None else float(known), None
        if slow or not low < at < high:
            at = (low + high) / 2
        found = curve.beyond(points[0], (at - places[0]) / curve.cosine(one, points[0]))
        value, at = function(found), curve.distance(one, found)
        if abs(value) <= enough:
            break
        slow, last = not slow and abs(value) > _SLOW * last, abs(value)
        tried.append((value, at, found))
        if (value > 0) == falls:
            low = max(low, at)
        else:
            high = min(high, at)
        if high - low < corner:
            break
    return found
