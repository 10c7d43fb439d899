"""Roots of functions: between two places, and near a complex number.

They are those of `brentq` and `newton` in `scipy.optimize`, to the bit. To import `scipy.optimize` takes a
tenth of a short run.
"""

from collections.abc import Callable
from math import copysign, inf, isnan

import numpy as np

#: Relative tolerance, about four units of round-off.
_LEAST = 8.881784197001252e-16
#: Distance of the first two places of the secant method, and relative to the first one.
_APART = 1e-4


def brent(
    function: Callable[[float], float],
    start: float,
    end: float,
    *,
    absolute: float = 2e-12,
    relative: float = _LEAST,
    most: int = 100,
) -> float:
    """Return a root of a continuous function between places where it has different signs.

    By Brent's method (Algorithms for Minimization without Derivatives, 1973, ch. 4): interpolation, and
    bisection where that converges slowly. The error is at most absolute + relative |root|. Raises ValueError
    where the signs are equal or a value is nan, and ArithmeticError after too many (`most`) iterations.
    """
    last, best = float(start), float(end)
    at_last, at_best = _value(function, last), _value(function, best)
    if at_last == 0:
        return last
    if at_best == 0:
        return best
    if copysign(1, at_last) == copysign(1, at_best):
        raise ValueError(f"a function has the same sign at {last} and at {best}")
    opposite = at_opposite = step = before = 0.0
    for _ in range(most):
        if at_last != 0 and at_best != 0 and copysign(1, at_last) != copysign(1, at_best):
            opposite, at_opposite = last, at_last
            step = before = best - last
        if abs(at_opposite) < abs(at_best):
            last, best, opposite = best, opposite, best
            at_last, at_best, at_opposite = at_best, at_opposite, at_best
        least = (absolute + relative * abs(best)) / 2
        half = (opposite - best) / 2
        if at_best == 0 or abs(half) < least:
            return best
        tried = inf
        if abs(before) > least and abs(at_best) < abs(at_last):
            if last == opposite:
                # by a line through two places
                tried = -at_best * (best - last) / (at_best - at_last)
            else:
                # by a hyperbola through three
                slope = (at_last - at_best) / (last - best)
                other = (at_opposite - at_best) / (opposite - best)
                below = other * slope * (at_opposite - at_last)
                above = -at_best * (at_opposite * other - at_last * slope)
                tried = above / below if below else inf
        if 2 * abs(tried) < min(abs(before), 3 * abs(half) - least):
            before, step = step, tried
        else:
            before = step = half
        last, at_last = best, at_best
        best += step if abs(step) > least else copysign(least, half)
        at_best = _value(function, best)
    raise ArithmeticError(f"there is no root after {most} iterations")


def secant(function: Callable[[complex], complex], start: complex, *, absolute: float, most: int) -> complex:
    """Return a root of an analytic function near a complex number, by the secant method.

    The last step is at most `absolute`. Raises ArithmeticError if it is not found within the `most`
    iterations.
    """
    last, place = np.complex128(start), np.complex128(start) * (1 + _APART) + _APART
    at_last, at = function(last), function(place)
    if abs(at) < abs(at_last):
        last, place, at_last, at = place, last, at, at_last
    for _ in range(most):
        if at == at_last:
            break
        # the smaller value is divided by the larger one
        if abs(at) > abs(at_last):
            found = (-at_last / at * place + last) / (1 - at_last / at)
        else:
            found = (-at / at_last * last + place) / (1 - at / at_last)
        if abs(found - place) <= absolute:
            return complex(found)
        last, at_last, place, at = place, at, found, function(found)
    raise ArithmeticError(f"no root was found near {start}")


def _value(function: Callable[[float], float], place: float) -> float:
    value = float(function(place))
    if isnan(value):
        raise ValueError(f"a function is nan at {place}")
    return value
