"""Compiled: extrapolation of a path from its accepted states, and the selection of the predictor.

A path is a curve (p(s), y(s)), known at some places s. Polynomials in s extrapolate it. Where a front peels
elements of equal length, y(s) follows from y(s - P) *translated* by one element (see
`solve.translation_predictor`): y(s) = C y(s - P) + d(s), where the rest d(s) changes little and is
extrapolated by a polynomial. Names: s is the path measure (`measure`), p the parameter, P the period. The
predictor with the smallest errors at the last states is selected.
"""

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.compilation import compiled, compiled_reordered

#: States that a polynomial passes through, at most.
MOST_STATES = 8
#: The number of last states at which each predictor is judged.
TRIES = 3
_FEWEST_OF_ENERGY = 3
#: States that the polynomial of the rest d passes through, at most.
_MOST_OF_REST = 5
#: States around a place that are interpolated there; 8 to 12 are no better.
_AROUND = 6
#: A translation predictor is not used where it predicts a growth of the path measure per parameter above this
#: factor times the least one of the last steps. Then a limit point lies ahead, beyond which the path may have
#: jumped a period ago, while it still has an equilibrium here. Steps of L1 at 200 x 10 elements grow by up to
#: 1.8 times the least before a jump, and by 2.6 times at least with one.
_JUMP = 2.5
_ITERATIONS = 40
_FARTHEST = 4.0  # last steps
_CLOSE = 1e-12  # to the end of the step, of the step
_PLACED = 1e-6  # of the last step

_BY_PARAMETER, _BY_ENERGY, _TRANSLATION = range(3)


@compiled
def select_predictor(
    parameters: FloatArray,
    ahead: FloatArray,
    energies: FloatArray,
    samples: FloatArray,
    misses: FloatArray,
    target: float,
) -> tuple[FloatArray, bool]:
    """Return weights (2, n) of the states and of the translated states, whose sum predicts the target.

    The arguments are the parameters (n,) of the accepted states, the newest at the end; the parameters
    `ahead` (n,) of the translated states; the adhesive energies (n,); and samples (n, 2, m) of each state and
    of the translated one, by which states are compared: nan where nothing can be translated. Each polynomial,
    in either path measure and through 1 to MOST_STATES states, and each translation predictor is judged by
    the mean logarithm of its errors at the last states. The second value returned is whether the path measure
    of the selected predictor is the energy.

    The errors of polynomials are stored in misses (n, 2, MOST_STATES), by path measure and number of states:
    nan where they have not been evaluated yet.
    """
    n, m = samples.shape[0], samples.shape[2]
    weights, trial, difference = np.zeros((2, n)), np.zeros((2, n)), np.empty(m)
    weights[0, n - 1] = 1.0
    best, best_count, best_kind = np.inf, 1, _BY_PARAMETER
    # the same number for all predictors
    tries = max(1, min(TRIES, n - MOST_STATES))
    for kind in (_BY_PARAMETER, _BY_ENERGY, _TRANSLATION):
        measure = parameters if kind == _BY_PARAMETER else energies
        period = _period(measure, samples) if kind == _TRANSLATION else 0.0
        if kind == _TRANSLATION and period == 0.0:
            break
        fewest = _FEWEST_OF_ENERGY if kind == _BY_ENERGY else 1
        most = _MOST_OF_REST if kind == _TRANSLATION else MOST_STATES
        for count in range(fewest, min(n - 1, most) + 1):
            score = 0.0
            for last in range(n - tries, n):
                missed = np.nan if kind == _TRANSLATION else misses[last, kind, count - 1]
                if np.isnan(missed):
                    missed = np.inf
                    there = parameters[last]
                    if _extrapolate(measure, parameters, ahead, last, there, count, period, trial) != 0.0:
                        missed = _missed(samples, trial, last, difference)
                    if kind != _TRANSLATION:
                        misses[last, kind, count - 1] = missed
                # the logarithm of an exact prediction must be finite
                score += np.log(missed + 1e-300) / tries
                if score == np.inf:
                    break
            if not score < best:
                continue
            rise = _extrapolate(measure, parameters, ahead, n, target, count, period, trial)
            if rise == 0.0 or (kind == _TRANSLATION and _jumps(measure, parameters, target, rise)):
                continue
            best, best_count, best_kind = score, count, kind
            _copy(trial, weights)
    # where the polynomial through all earlier states was the best one, one more state may improve it
    if best_count == n - 1 < MOST_STATES and best_kind != _TRANSLATION:
        measure = parameters if best_kind == _BY_PARAMETER else energies
        if _extrapolate(measure, parameters, ahead, n, target, n, 0.0, trial) != 0.0:
            _copy(trial, weights)
    return weights, best_kind != _BY_PARAMETER


@compiled
def _copy(values: FloatArray, to: FloatArray) -> None:
    """Copy weights (2, n). Numba takes seconds to compile the assignment of arrays."""
    for kind in range(2):
        for i in range(values.shape[1]):
            to[kind, i] = values[kind, i]


@compiled_reordered
def _missed(samples: FloatArray, weights: FloatArray, n: int, difference: FloatArray) -> float:
    """Return the squared error at state n of the weights of the n states before; set difference (m,)."""
    for j in range(len(difference)):
        difference[j] = samples[n, 0, j]
    for kind in range(2):
        for i in range(n):
            if weights[kind, i] != 0.0:
                for j in range(len(difference)):
                    difference[j] -= weights[kind, i] * samples[i, kind, j]
    total = 0.0
    for j in range(len(difference)):
        total += difference[j] ** 2
    return total


@compiled
def _jumps(measure: FloatArray, parameters: FloatArray, target: float, rise: float) -> bool:
    """Return whether the path measure grows much more per parameter to the target than in the last steps."""
    n = len(measure)
    least = np.inf
    for k in range(max(1, n - TRIES), n):
        least = min(least, abs((measure[k] - measure[k - 1]) / (parameters[k] - parameters[k - 1])))
    return not abs(rise / (target - parameters[n - 1])) < _JUMP * least


@compiled
def _extrapolate(
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
    first = _steady(measure, n)
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
            place = _around(s, first, n, s[start + k] - ago)
            if place < 0:
                return 0.0
            rest[k] -= _before(s, translated, place, s[start + k] - ago, basis)[0]
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
                if (translated[j] + _horner(rest, s, start, at)[0] - step) * step >= 0.0:
                    high = at
                    break
                low = at
        if high == 0.0:
            return 0.0
    for _ in range(_ITERATIONS):
        value, slope = _horner(rest, s, start, at)
        if period > 0.0:
            before, rise = _before(s, translated, _around(s, first, n, at - ago), at - ago, basis)
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
            place = _around(s, first, n, before)
            lagrange(s, place, _AROUND, before, basis)
            for i in range(_AROUND):
                weights[1, place + i] += share * basis[0, i]
    return float(at * unit)


@compiled
def _steady(measure: FloatArray, n: int) -> int:
    """Return the first of n states from which on the path measure is monotonic up to the last one."""
    first = n - 1
    if first > 0:
        last = measure[first] - measure[first - 1]
        while first > 0 and (measure[first] - measure[first - 1]) * last > 0.0:
            first -= 1
    return first


@compiled
def _around(nodes: FloatArray, first: int, n: int, at: float) -> int:
    """Return the first of the _AROUND rising nodes, from `first` to n, nearest to a place; -1 beyond all."""
    if n - first < _AROUND or not nodes[first] <= at <= nodes[n - 1]:
        return -1
    while first < n - _AROUND and nodes[first + _AROUND] - at < at - nodes[first]:
        first += 1
    return first


@compiled
def _horner(form: FloatArray, nodes: FloatArray, start: int, at: float) -> tuple[float, float]:
    """Return value and slope of a polynomial in Newton's form (n,), whose nodes begin at a start."""
    last = len(form) - 1
    value, slope = form[last], 0.0
    for i in range(last - 1, -1, -1):
        slope = slope * (at - nodes[start + i]) + value
        value = value * (at - nodes[start + i]) + form[i]
    return value, slope


@compiled
def _before(
    nodes: FloatArray, values: FloatArray, start: int, at: float, basis: FloatArray
) -> tuple[float, float]:
    """Return value and slope of the polynomial through _AROUND values from a start on."""
    lagrange(nodes, start, _AROUND, at, basis)
    value, slope = 0.0, 0.0
    for i in range(_AROUND):
        value += basis[0, i] * values[start + i]
        slope += basis[1, i] * values[start + i]
    return value, slope


@compiled
def slope(measure: FloatArray, parameters: FloatArray, values: FloatArray) -> float:
    """Return the derivative by the parameter, at the last state, of values (n,) at the states of a path.

    It is that of the polynomial in the path measure through the last states along which this is monotonic.
    Returns zero where there is no state before the last, and at a limit point of the parameter, where there
    is no such derivative.
    """
    last = len(measure) - 1
    first = _steady(measure, last + 1)
    basis = np.empty((2, len(measure)))
    lagrange(measure, first, last - first, measure[last], basis)
    # of the polynomial (s - last) q(s) + f(last), with q through the difference quotients
    along, parameter = 0.0, 0.0
    for k in range(first, last):
        weight = basis[0, k - first] / (measure[k] - measure[last])
        along += weight * (values[k] - values[last])
        parameter += weight * (parameters[k] - parameters[last])
    # the last step gives the sign of the derivative
    onwards = parameter * (measure[last] - measure[last - 1]) * (parameters[last] - parameters[last - 1])
    return along / parameter if last > 0 and onwards > 0.0 else 0.0


@compiled
def lagrange(nodes: FloatArray, start: int, count: int, at: float, basis: FloatArray) -> None:
    """Set basis (2, count) to values and slopes, at a place, of Lagrange's polynomials of `count` nodes."""
    for i in range(count):
        value, slope = 1.0, 0.0
        for k in range(count):
            if k != i:
                scale = 1.0 / (nodes[start + i] - nodes[start + k])
                slope = (slope * (at - nodes[start + k]) + value) * scale
                value *= (at - nodes[start + k]) * scale
        basis[0, i], basis[1, i] = value, slope


@compiled
def _period(measure: FloatArray, samples: FloatArray) -> float:
    """Return the period after which a translated state equals the last one; zero where none does.

    The nearest translated state must be closer to the last state than the state before that is. The
    Gauss-Newton method finds the place between the states.
    """
    n, m = samples.shape[0], samples.shape[2]
    first = _steady(measure, n)
    if n - first < _AROUND:
        return 0.0
    least, nearest = _square(samples, n - 2, 0), -1
    # the latest such state, not one of an earlier period
    for k in range(n - 2, first - 1, -1):
        missed = _square(samples, k, 1)
        if missed < least:
            least, nearest = missed, k
        elif nearest >= 0:
            break
    if nearest < 0:
        return 0.0
    unit = measure[n - 1] - measure[n - 2]
    s = np.empty(n)
    for k in range(first, n):
        s[k] = (measure[k] - measure[n - 1]) / unit
    # the place is next to the nearest state
    reach = max(s[min(nearest + 1, n - 1)] - s[max(nearest - 1, first)], 1.0)
    at = s[nearest]
    basis = np.empty((2, _AROUND))
    last_product = 0.0
    for _ in range(_ITERATIONS):
        place = _around(s, first, n, at)
        if place < 0:
            return 0.0
        lagrange(s, place, _AROUND, at, basis)
        product, square = 0.0, 0.0
        for j in range(m):
            left, rise = samples[n - 1, 0, j], 0.0
            for i in range(_AROUND):
                left -= basis[0, i] * samples[place + i, 1, j]
                rise += basis[1, i] * samples[place + i, 1, j]
            product += left * rise
            square += rise * rise
        # where the rest is not small the method may oscillate
        change = product / square / (2.0 if product * last_product < 0.0 else 1.0)
        last_product = product
        at += change
        if not abs(at - s[nearest]) < reach:
            return 0.0
        if abs(change) < _PLACED:
            return float(-at * abs(unit))
    return 0.0


@compiled
def _square(samples: FloatArray, k: int, kind: int) -> float:
    """Return the squared distance of the last state from another, as it is (0) or translated (1)."""
    last = samples.shape[0] - 1
    total = 0.0
    for j in range(samples.shape[2]):
        total += (samples[last, 0, j] - samples[k, kind, j]) ** 2
    return total
