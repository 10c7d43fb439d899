"""Compiled: which sum of past states leads on best, as the last of them tell.

A path is a curve (p(s), y(s)), known at some places s. Polynomials lead on from there; and where y(s) follows
from what y(s - P) is when it is *carried on* (`isopeel.solve.advance`), a polynomial through the rest, which
changes little: y(s) = C y(s - P) + d(s). Names: the way is s, p the parameter, P the period.
"""

import numpy as np
from numba import njit

from isopeel.arrays import FloatArray

#: States that a polynomial leads through, at most.
MOST_STATES = 8
#: The last states that each polynomial is tried on.
TRIES = 3
_FEWEST_OF_ENERGY = 3
#: States that the rest d of a recurrence is led through, at most.
_MOST_OF_REST = 5
#: States around a place between them that tell what was there; 8 to 12 tell no more.
_AROUND = 6
#: Times the least way per parameter of the last steps: one that takes more has a limit point ahead, beyond
#: which the path may have jumped a period ago, while it still has an equilibrium here. Steps of L1 at
#: 200 x 10 elements take up to 1.8 times as much before a jump, and 2.6 times at least with one.
_JUMP = 2.5
_ITERATIONS = 40
_FARTHEST = 4.0  # last steps
_CLOSE = 1e-12  # to the end of the step, of the step
_PLACED = 1e-6  # of the last step

_BY_PARAMETER, _BY_ENERGY, _RECURRENCE = range(3)

# a quotient of what does not change is no number, and leads nowhere
_compiled = njit(cache=True, error_model="numpy")


@_compiled
def best_weights(
    parameters: FloatArray, energies: FloatArray, samples: FloatArray, target: float
) -> tuple[FloatArray, bool]:
    """Weights (2, n) of past states, as they are and carried on, whose sum leads to the target.

    Past are the parameters (2, n) of states, as they are and carried on, the newest at the end, their
    adhesive energies (n,), and numbers (n, 2, m) that tell how well a state is met; nan where nothing is
    carried on. Each polynomial, in either measure of the way and through 1 to MOST_STATES states, and each
    recurrence is judged by the mean logarithm of what it would have missed the last states by. The second
    value is whether its measure is the energy.
    """
    p = parameters[0]
    n = len(p)
    weights, trial = np.zeros((2, n)), np.empty((2, n))
    weights[0, n - 1] = 1.0
    best, best_count, best_kind = np.inf, 1, _BY_PARAMETER
    # the same for all, however few states there are
    tries = max(1, min(TRIES, n - MOST_STATES))
    for kind in (_BY_PARAMETER, _BY_ENERGY, _RECURRENCE):
        way = p if kind == _BY_PARAMETER else energies
        period = _period(way, samples) if kind == _RECURRENCE else 0.0
        if kind == _RECURRENCE and period == 0.0:
            break
        fewest = _FEWEST_OF_ENERGY if kind == _BY_ENERGY else 1
        most = _MOST_OF_REST if kind == _RECURRENCE else MOST_STATES
        for count in range(fewest, min(n - 1, most) + 1):
            score = 0.0
            for last in range(n - tries, n):
                if _lead(way[:last], parameters[:, :last], p[last], count, period, trial[:, :last]) == 0.0:
                    score = np.inf
                    break
                # a state that is met to the last digit is met no better than to round-off
                score += np.log(_missed(samples, trial[:, :last]) + 1e-300) / tries
            if not score < best:
                continue
            ahead = _lead(way[:n], parameters[:, :n], target, count, period, trial[:, :n])
            if ahead == 0.0 or (kind == _RECURRENCE and _jumps(way, p, ahead / (target - p[n - 1]))):
                continue
            best, best_count, best_kind = score, count, kind
            _copy(trial, weights)
    # where all states that there were met the last one best, one more may do better
    if best_count == n - 1 < MOST_STATES and best_kind != _RECURRENCE:
        way = p if best_kind == _BY_PARAMETER else energies
        if _lead(way[:n], parameters[:, :n], target, n, 0.0, trial[:, :n]) != 0.0:
            _copy(trial, weights)
    return weights, best_kind != _BY_PARAMETER


@_compiled
def _copy(values: FloatArray, to: FloatArray) -> None:
    """Numba takes seconds to compile the assignment of arrays."""
    for kind in range(2):
        for i in range(values.shape[1]):
            to[kind, i] = values[kind, i]


@_compiled
def _missed(samples: FloatArray, weights: FloatArray) -> float:
    """Square of what the weights (2, k) of the first k states miss the next one by."""
    k = weights.shape[1]
    difference = samples[k, 0].copy()
    for kind in range(2):
        for i in range(k):
            if weights[kind, i] != 0.0:
                for j in range(len(difference)):
                    difference[j] -= weights[kind, i] * samples[i, kind, j]
    total = 0.0
    for x in difference:
        total += x * x
    return total


@_compiled
def _jumps(way: FloatArray, parameters: FloatArray, rate: float) -> bool:
    """Whether the way grows by far more per parameter than it lately did."""
    n = len(way)
    least = np.inf
    for k in range(max(1, n - TRIES), n):
        least = min(least, abs((way[k] - way[k - 1]) / (parameters[k] - parameters[k - 1])))
    return not abs(rate) < _JUMP * least


@_compiled
def _lead(
    way: FloatArray, parameters: FloatArray, target: float, count: int, period: float, weights: FloatArray
) -> float:
    """Set the weights (2, n) that lead through the last `count` states to where the parameter is the target.

    Those of Lagrange's polynomials of the way; with a period, of the polynomial d(s), and C y(s - P). Returns
    what the way grows by to there, the first such place; 0 where there is none, not far ahead.
    """
    n = len(way)
    p = parameters[0]
    weights.fill(0.0)
    steady = _steady(way)
    if n == 1 or (count == 1 and period == 0.0):
        weights[0, n - 1] = 1.0
        return 1.0
    if n - steady < max(count, 2):
        return 0.0
    unit = way[n - 1] - way[n - 2]
    s = (way[steady:] - way[n - 1]) / unit
    ago = period / abs(unit)
    carried = parameters[1, steady:] - p[n - 1]
    nodes = s[len(s) - count :]
    rest = p[n - count :] - p[n - 1]
    if period > 0.0:
        for k in range(count):
            place = _around(s, nodes[k] - ago)
            if place < 0:
                return 0.0
            rest[k] -= _polynomial(s, carried, place, nodes[k] - ago)[0]
    # Newton's form of the polynomial, by divided differences
    for order in range(1, count):
        for i in range(count - 1, order - 1, -1):
            rest[i] = (rest[i] - rest[i - 1]) / (nodes[i] - nodes[i - order])
    step = target - p[n - 1]
    at = step / (p[n - 1] - p[n - 2])
    low, high = 0.0, _FARTHEST
    if period > 0.0:
        # between which states, carried on, does the path meet the target?
        high = 0.0
        for j in range(len(s)):
            if s[j] + ago > 0.0:
                at = s[j] + ago
                if (carried[j] + _horner(rest, nodes, at)[0] - step) * step >= 0.0:
                    high = at
                    break
                low = at
        if high == 0.0:
            return 0.0
    for _ in range(_ITERATIONS):
        value, slope = _horner(rest, nodes, at)
        if period > 0.0:
            place = _around(s, at - ago)
            before, rise = _polynomial(s, carried, place, at - ago)
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
    _add_lagrange(nodes, at, 1.0, weights[0, n - count :])
    if period > 0.0:
        for k in range(count + 1):
            # C y(s - P) at the place, less its share in each of the rests
            before = (nodes[k] if k < count else at) - ago
            share = -weights[0, n - count + k] if k < count else 1.0
            place = _around(s, before)
            _add_lagrange(s[place : place + _AROUND], before, share, weights[1, steady + place :])
    return float(at * unit)


@_compiled
def _steady(way: FloatArray) -> int:
    """The first state from which on the way grows, or falls, steadily to the last one."""
    first = len(way) - 1
    if first > 0:
        last = way[first] - way[first - 1]
        while first > 0 and (way[first] - way[first - 1]) * last > 0.0:
            first -= 1
    return first


@_compiled
def _around(nodes: FloatArray, at: float) -> int:
    """The first of the _AROUND rising nodes (n,) nearest to a place; -1 where it is not among them."""
    n = len(nodes)
    if n < _AROUND or not nodes[0] <= at <= nodes[n - 1]:
        return -1
    first = 0
    while first < n - _AROUND and nodes[first + _AROUND] - at < at - nodes[first]:
        first += 1
    return first


@_compiled
def _horner(form: FloatArray, nodes: FloatArray, at: float) -> tuple[float, float]:
    """Value and slope of Newton's form (n,) of a polynomial."""
    last = len(form) - 1
    value, slope = form[last], 0.0
    for i in range(last - 1, -1, -1):
        slope = slope * (at - nodes[i]) + value
        value = value * (at - nodes[i]) + form[i]
    return value, slope


@_compiled
def _polynomial(nodes: FloatArray, values: FloatArray, first: int, at: float) -> tuple[float, float]:
    """Value and slope of the polynomial through _AROUND values from the first on, by Neville's scheme."""
    value, slope = values[first : first + _AROUND].copy(), np.zeros(_AROUND)
    for order in range(1, _AROUND):
        for i in range(_AROUND - order):
            to_one, to_other = at - nodes[first + i], at - nodes[first + i + order]
            size = to_one - to_other
            slope[i] = (value[i + 1] - value[i] + to_one * slope[i + 1] - to_other * slope[i]) / size
            value[i] = (to_one * value[i + 1] - to_other * value[i]) / size
    return value[0], slope[0]


@_compiled
def _add_lagrange(nodes: FloatArray, at: float, size: float, weights: FloatArray) -> None:
    """Add the values at a place of Lagrange's polynomials of nodes (n,), times a size, to weights."""
    for i in range(len(nodes)):
        weight = size
        for k in range(len(nodes)):
            if k != i:
                weight *= (at - nodes[k]) / (nodes[i] - nodes[k])
        weights[i] += weight


@_compiled
def _period(way: FloatArray, samples: FloatArray) -> float:
    """How long ago the path was last where, carried on, it meets the last state; zero where it nowhere was.

    The nearest state must meet it better than the last one but one, as it is; Gauss and Newton's method finds
    the place between the states.
    """
    n = len(way)
    steady = _steady(way)
    if n - steady < _AROUND:
        return 0.0
    goal = samples[n - 1, 0]
    least, nearest = _square(goal, samples[n - 2, 0]), -1
    # the last such time, not one some periods before
    for k in range(n - 2 - steady, -1, -1):
        missed = _square(goal, samples[steady + k, 1])
        if missed < least:
            least, nearest = missed, k
        elif nearest >= 0:
            break
    if nearest < 0:
        return 0.0
    unit = way[n - 1] - way[n - 2]
    s = (way[steady:] - way[n - 1]) / unit
    at = s[nearest]
    unity = np.eye(_AROUND)
    last_product = 0.0
    for _ in range(_ITERATIONS):
        first = _around(s, at)
        if first < 0:
            return 0.0
        left, rise = goal.copy(), np.zeros(len(goal))
        for i in range(_AROUND):
            value, slope = _polynomial(s[first : first + _AROUND], unity[i], 0, at)
            for j in range(len(goal)):
                sample = samples[steady + first + i, 1, j]
                left[j] -= value * sample
                rise[j] += slope * sample
        product, square = 0.0, 0.0
        for j in range(len(goal)):
            product += left[j] * rise[j]
            square += rise[j] * rise[j]
        # where the rest is not small the method may go to and fro
        change = product / square / (2.0 if product * last_product < 0.0 else 1.0)
        last_product = product
        at += change
        # the place is next to the nearest state
        if not abs(at - s[nearest]) < max(s[min(nearest + 1, len(s) - 1)] - s[max(nearest - 1, 0)], 1.0):
            return 0.0
        if abs(change) < _PLACED:
            return float(-at * abs(unit))
    return 0.0


@_compiled
def _square(x: FloatArray, y: FloatArray) -> float:
    """Square of the distance of two vectors (m,)."""
    total = 0.0
    for j in range(len(x)):
        total += (x[j] - y[j]) ** 2
    return total
