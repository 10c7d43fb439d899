"""Compiled: weights of the accepted states of a path, whose sum extrapolates it.

A path is a curve (p(s), y(s)), known at some places s. Polynomials in s extrapolate it. Where a front peels
elements of equal length, y(s) follows from y(s - P) *translated* by one element (see
`solve.translation_predictor`): y(s) = C y(s - P) + d(s), where the rest d(s) changes little and is
extrapolated by a polynomial. Names: s is the path measure (`measure`), p the parameter, P the period.
"""

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.compilation import inner
from isopeel.solve.polynomials import (
    NODES,
    evaluate_newton_form,
    first_monotonic,
    interpolate,
    lagrange,
    nearest_nodes,
)

#: States that a polynomial passes through, at most.
MOST_STATES = 8
_ITERATIONS = 40
_FARTHEST = 4.0  # last steps
_CLOSE = 1e-12  # to the end of the step, of the step


@inner
def set_weights(
    measure: FloatArray,
    parameters: FloatArray,
    ahead: FloatArray,
    n: int,
    target: float,
    count: int,
    period: float,
    weights: FloatArray,
) -> float:
    """Set the weights of the extrapolation through the last `count` of n states to the target parameter.

    Without a period these are Lagrange's polynomials of the path measure; with one, those of d(s), and
    C y(s - P). Returns the increment of the path measure to the first place where the parameter is the
    target; 0 where there is none within a few steps.
    """
    for kind in range(2):
        for k in range(n):
            weights[kind, k] = 0.0
    if n == 1 or (count == 1 and period == 0.0):
        weights[0, n - 1] = 1.0
        return 1.0
    first = first_monotonic(measure, n)
    if n - first < max(count, 2):
        return 0.0
    start = n - count
    # path measure, in units of the last step, and parameters, both relative to the last state
    unit, here = measure[n - 1] - measure[n - 2], parameters[n - 1]
    s, translated = np.empty(n), np.empty(n)
    for k in range(first if period > 0.0 else start, n):
        s[k] = (measure[k] - measure[n - 1]) / unit
        translated[k] = ahead[k] - here
    ago = period / abs(unit)
    basis = np.empty((2, MOST_STATES))
    rest = np.empty(count)
    for k in range(count):
        rest[k] = parameters[start + k] - here
        if period > 0.0:
            place = nearest_nodes(s, first, n, s[start + k] - ago)
            if place < 0:
                return 0.0
            rest[k] -= interpolate(s, translated, place, s[start + k] - ago, basis)[0]
    # Newton's form of the polynomial, by divided differences
    for order in range(1, count):
        for i in range(count - 1, order - 1, -1):
            rest[i] = (rest[i] - rest[i - 1]) / (s[start + i] - s[start + i - order])
    step = target - here
    at = step / (here - parameters[n - 2])
    low, high = 0.0, _FARTHEST
    if period > 0.0:
        # bracket the target between two translated states
        high = 0.0
        for j in range(first, n):
            if s[j] + ago > 0.0:
                at = s[j] + ago
                if (translated[j] + evaluate_newton_form(rest, s, start, at)[0] - step) * step >= 0.0:
                    high = at
                    break
                low = at
        if high == 0.0:
            return 0.0
    for _ in range(_ITERATIONS):
        value, slope = evaluate_newton_form(rest, s, start, at)
        if period > 0.0:
            before, rise = interpolate(s, translated, nearest_nodes(s, first, n, at - ago), at - ago, basis)
            value, slope = value + before, slope + rise
            if (value - step) * step > 0.0:
                high = at
            else:
                low = at
        if abs(step - value) <= _CLOSE * abs(step):
            break
        at += (step - value) / slope
        if period > 0.0 and not low < at < high:
            at = (low + high) / 2.0
        elif not (slope * step > 0.0 and low < at < high) and period == 0.0:
            return 0.0
    else:
        return 0.0
    lagrange(s, start, count, at, basis)
    for k in range(count):
        weights[0, start + k] = basis[0, k]
    if period > 0.0:
        for k in range(start, n + 1):
            # C y(s - P) at the place, minus its share in each of the rests
            share = -weights[0, k] if k < n else 1.0
            before = (s[k] if k < n else at) - ago
            place = nearest_nodes(s, first, n, before)
            lagrange(s, place, NODES, before, basis)
            for i in range(NODES):
                weights[1, place + i] += share * basis[0, i]
    return float(at * unit)
