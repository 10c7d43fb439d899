"""Names for the array types that signatures use."""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int64]
BoolArray: TypeAlias = NDArray[np.bool_]


def frozen(array: NDArray[np.generic] | list[float] | tuple[float, ...]) -> FloatArray:
    """Return a read-only float copy of an array, for the fields of immutable objects."""
    copy = np.array(array, dtype=np.float64)
    copy.setflags(write=False)
    return copy
