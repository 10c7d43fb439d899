"""Start values for Newton's method."""

from collections.abc import Mapping

import numpy as np

from isopeel.arrays import FloatArray


def extrapolate(history: Mapping[float, FloatArray], parameter: float, count: int) -> FloatArray:
    """Evaluate the polynomial in the parameter through past states: unknowns (count,) at each parameter.

    Lagrange's formula; zeros where there is no past state.
    """
    start = np.zeros(count)
    for node, values in history.items():
        factors = [(parameter - other) / (node - other) for other in history if other != node]
        start += values * np.prod(factors)
    return start
