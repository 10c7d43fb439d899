"""Start values for Newton's method, and what the path's past tells of its slope."""

from collections.abc import Mapping

import numpy as np

from isopeel.arrays import FloatArray


def extrapolate(history: Mapping[float, FloatArray], parameter: float, count: int) -> FloatArray:
    """Evaluate the polynomial in the parameter through past states: unknowns (count,) at each parameter.

    Lagrange's formula; zeros where there is no past state.
    """
    start = np.zeros(count)
    weights = _lagrange(np.array(list(history)), parameter)
    for weight, values in zip(weights, history.values(), strict=True):
        start += weight * values
    return start


def best_count(history: Mapping[float, FloatArray], most: int) -> int:
    """How many of the last states to extrapolate from: the number that would have met the last one best.

    `history` holds the states in the order in which they came. The best polynomial is of a high degree where
    the path is smooth, and of a low one where it is not. One more state is tried where all that there were
    met the last one best, up to the `most`.
    """
    *past, last = history
    if not past:
        return 1
    largest = min(most, len(past))
    nodes = np.array(past[-largest:])
    weights = np.zeros((largest, largest))
    for count in range(1, largest + 1):
        weights[count - 1, -count:] = _lagrange(nodes[-count:], last)
    guesses = weights @ np.array([history[node] for node in nodes])
    missed = np.abs(guesses - history[last]).max(axis=1)
    best = int(np.argmin(missed)) + 1
    return best + 1 if best == len(past) < most else best


def slope(history: Mapping[float, FloatArray], covector: FloatArray) -> float:
    """Derivative of covector (count,) . state by the parameter, at the last of the states of a path.

    That of Lagrange's polynomial through all of them; zero where there is no state before the last.
    """
    *past, last = history
    nodes = np.array(past)
    # of the polynomial (x - last) q(x) + f(last), with q through the difference quotients
    weights = _lagrange(nodes, last) / (nodes - last)
    along = np.array([float(covector @ values) for values in history.values()])
    return float(weights @ (along[:-1] - along[-1]))


def _lagrange(nodes: FloatArray, at: float) -> FloatArray:
    """Values at a point of Lagrange's polynomials of nodes (n,)."""
    differences = nodes[:, None] - nodes
    np.fill_diagonal(differences, 1.0)
    factors = (at - nodes) / differences
    np.fill_diagonal(factors, 1.0)
    weights: FloatArray = factors.prod(axis=1)
    return weights
