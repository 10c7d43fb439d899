"""Compiled: the period of a path, along which a front peels elements of equal length.

After a period, a state translated by one element (see `solve.translation_predictor`) equals the last state.
"""

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.compilation import inner
from isopeel.solve.polynomials import NODES, first_monotonic, lagrange, nearest_nodes

_ITERATIONS = 40
_PLACED = 1e-6  # of the last step


@inner
def translation_period(measure: FloatArray, samples: FloatArray) -> float:
    """Return the period after which a translated state equals the last one; zero where none does.

    The nearest translated state must be closer to the last state than the state before that is. The
    Gauss-Newton method finds the place between the states.
    """
    n, m = samples.shape[0], samples.shape[2]
    first = first_monotonic(measure, n)
    if n - first < NODES:
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
    basis = np.empty((2, NODES))
    last_product = 0.0
    for _ in range(_ITERATIONS):
        place = nearest_nodes(s, first, n, at)
        if place < 0:
            return 0.0
        lagrange(s, place, NODES, at, basis)
        product, square = 0.0, 0.0
        for j in range(m):
            left, rise = samples[n - 1, 0, j], 0.0
            for i in range(NODES):
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


@inner
def _square(samples: FloatArray, k: int, kind: int) -> float:
    """Return the squared distance of the last state from another, as it is (0) or translated (1)."""
    last = samples.shape[0] - 1
    total = 0.0
    for j in range(samples.shape[2]):
        total += (samples[last, 0, j] - samples[k, kind, j]) ** 2
    return total
