"""Start values for Newton's method."""

from collections.abc import Sequence

import numpy as np

from isopeel.arrays import FloatArray


def extrapolate(history: Sequence[tuple[float, FloatArray]], parameter: float, count: int) -> FloatArray:
    """Evaluate the polynomial in the parameter through past states (parameter, unknowns (count,)).

    Lagrange's formula; zeros where there is no past state.
    """
    start = np.zeros(count)
    for k, (node, values) in enumerate(history):
        others = [other for j, (other, _) in enumerate(history) if j != k]
        start += values * np.prod([(parameter - other) / (node - other) for other in others])
    return start
