"""Start values along a path, and what its past tells of its slope.

A path is a curve (p(s), y(s)): parameter and unknowns. Polynomials in s through its last points lead on, to
where p(s) is the parameter that is asked for. The parameter itself may be s. Where a front peels, the
adhesive energy is the better measure of the way: it grows steadily with the front, while the parameter halts
at limit points, and hesitates near them.
"""

from collections.abc import Mapping

import numpy as np
from numba import njit

from isopeel.arrays import FloatArray

#: States that a polynomial leads through, at most.
MOST_STATES = 8
#: The last states that each polynomial is tried on.
TRIES = 3
_FEWEST_OF_ENERGY = 3
#: States that a slope is taken from, at most: more of them gain nothing over their own errors.
SLOPE_STATES = 5
_ITERATIONS = 20
_FARTHEST = 4.0  # last steps
_CLOSE = 1e-12  # to the end of the step, of the step

# a quotient of what does not change is no number, and leads nowhere
_compiled = njit(cache=True, error_model="numpy")


def extrapolate(history: Mapping[float, FloatArray], parameter: float, count: int) -> FloatArray:
    """Evaluate the polynomial in the parameter through past states: unknowns (count,) at each parameter.

    Lagrange's formula; zeros where there is no past state.
    """
    start = np.zeros(count)
    weights = _lagrange(np.array(list(history)), parameter)
    for weight, values in zip(weights, history.values(), strict=True):
        start += weight * values
    return start


@_compiled
def best_weights(
    parameters: FloatArray, energies: FloatArray, samples: FloatArray, target: float
) -> tuple[FloatArray, bool]:
    """Weights (n,) of past states whose sum leads to the target, of the polynomial that did best so far.

    Past are the parameters (n,) and adhesive energies (n,) of states, the newest at the end, and numbers
    that tell how well a state is met, samples (n, m). Each polynomial, in either measure of the way and
    through 1 to MOST_STATES states, is judged by the mean logarithm of what it would have missed the last
    states by. The second value is whether its measure is the energy.
    """
    n, m = samples.shape
    weights = np.zeros(n)
    weights[n - 1] = 1.0
    trial = np.zeros(n)
    best = np.inf
    best_count, by_energy = 1, False
    # the same for all, however few states there are
    tries = max(1, min(TRIES, n - MOST_STATES))
    for energy in (False, True):
        way = energies if energy else parameters
        for count in range(_FEWEST_OF_ENERGY if energy else 1, min(n - 1, MOST_STATES) + 1):
            score = 0.0
            for last in range(n - tries, n):
                first = last - count
                if not _lead(way[first:last], parameters[first:last], parameters[last], trial[:count]):
                    score = np.inf
                    break
                missed = 0.0
                for i in range(m):
                    difference = samples[last, i]
                    for k in range(count):
                        difference -= trial[k] * samples[first + k, i]
                    missed += difference**2
                # a state that is met to the last digit is met no better than to round-off
                score += np.log(missed + 1e-300) / tries
            if score < best:
                best, best_count, by_energy = score, count, energy
    # where all states that there were met the last one best, one more may do better
    if best_count == n - 1 < MOST_STATES:
        best_count = n
    way = energies if by_energy else parameters
    first = n - best_count
    if _lead(way[first:], parameters[first:], target, trial[:best_count]):
        weights[n - 1] = 0.0
        for k in range(best_count):
            weights[first + k] = trial[k]
    return weights, by_energy


@_compiled
def _lead(way: FloatArray, parameters: FloatArray, target: float, weights: FloatArray) -> bool:
    """Set the weights (n,) of Lagrange's polynomials of the way where the parameter is the target.

    Says whether there is such a place, not far ahead.
    """
    n = len(way)
    if n == 1:
        weights[0] = 1.0
        return True
    unit = way[n - 1] - way[n - 2]
    s = np.empty(n)
    for i in range(n):
        if i > 0 and not (way[i] - way[i - 1]) * unit > 0.0:
            return False
        s[i] = (way[i] - way[n - 1]) / unit
    step = target - parameters[n - 1]
    # Newton's form of p(s), by divided differences
    form = np.empty(n)
    for i in range(n):
        form[i] = parameters[i] - parameters[n - 1]
    for order in range(1, n):
        for i in range(n - 1, order - 1, -1):
            form[i] = (form[i] - form[i - 1]) / (s[i] - s[i - order])
    at = step / (parameters[n - 1] - parameters[n - 2])
    for _ in range(_ITERATIONS):
        value, slope = form[n - 1], 0.0
        for i in range(n - 2, -1, -1):
            slope = slope * (at - s[i]) + value
            value = value * (at - s[i]) + form[i]
        if not slope * step > 0.0 or not 0.0 < at < _FARTHEST:
            return False
        at += (step - value) / slope
        if abs(step - value) <= _CLOSE * abs(step):
            break
    else:
        return False
    for i in range(n):
        weights[i] = 1.0
        for k in range(n):
            if k != i:
                weights[i] *= (at - s[k]) / (s[i] - s[k])
    return True


def slope(way: FloatArray, parameters: FloatArray, values: FloatArray) -> float:
    """Derivative by the parameter of what has these values (n,) at the states of a path, at the last of them.

    That of the polynomial in the way through the last states, up to SLOPE_STATES, along which it has grown or
    fallen steadily. Zero where there is no state before the last, and at a limit point of the parameter,
    where there is no such derivative.
    """
    way = way[-SLOPE_STATES:]
    steps = np.diff(way)
    (turns,) = np.nonzero(steps * steps[-1:] <= 0)
    count = len(way) - (turns[-1] + 1 if len(turns) else 0)
    if count < 2:
        return 0.0
    *past, last = way[-count:]
    nodes = np.array(past)
    # of the polynomial (s - last) q(s) + f(last), with q through the difference quotients
    weights = _lagrange(nodes, last) / (nodes - last)
    along, parameter = (float(weights @ (f[-count:-1] - f[-1])) for f in (values, parameters))
    # of which the last step tells the sign
    onwards = parameter * steps[-1] * (parameters[-1] - parameters[-2]) > 0
    return along / parameter if onwards else 0.0


def _lagrange(nodes: FloatArray, at: float) -> FloatArray:
    """Values at a point of Lagrange's polynomials of nodes (n,)."""
    differences = nodes[:, None] - nodes
    np.fill_diagonal(differences, 1.0)
    factors = (at - nodes) / differences
    np.fill_diagonal(factors, 1.0)
    weights: FloatArray = factors.prod(axis=1)
    return weights
