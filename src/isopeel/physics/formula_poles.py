"""Where a formula has a pole: a value without bound, which the places that it is tried at need not meet."""

from collections.abc import Callable

import numpy as np

from isopeel.common.arrays import FloatArray

#: Of its size at a place of the grid, what a function must grow to nearby to have a pole there. A peak that
#: is so narrow could not be resolved by any mesh.
_GROWTH = 1e6
#: Each takes a third off an interval: from a thousandth of a place to its round-off.
_STEPS = 64


def poles(function: Callable[[FloatArray], FloatArray], places: FloatArray) -> FloatArray:
    """The poles (k,) of a function near some of the places (n,), both in ascending order.

    Around each place where the size of the function is larger than at both its neighbours, the largest size
    is searched for: at a pole it grows without bound. Poles closer together than the places may be missed.
    """

    def size_at(where: FloatArray) -> FloatArray:
        with np.errstate(all="ignore"):
            return np.nan_to_num(np.abs(function(where)), nan=-1.0, posinf=np.inf)

    sizes = size_at(places)
    finite = np.isfinite(sizes) & (sizes >= 0)
    before, here, after = sizes[:-2], sizes[1:-1], sizes[2:]
    peaks = 1 + np.flatnonzero(
        finite[:-2] & finite[2:] & (np.isinf(here) | ((here >= before) & (here >= after) & (here > 0)))
    )
    low, high = places[peaks - 1], places[peaks + 1]
    for _ in range(_STEPS):
        third = (high - low) / 3
        left_is_larger = size_at(low + third) > size_at(high - third)
        low, high = np.where(left_is_larger, low, low + third), np.where(left_is_larger, high - third, high)
    found = (low + high) / 2
    # the middle may be the pole itself, to round-off, or lie beside it
    largest = np.max([size_at(low), size_at(found), size_at(high), sizes[peaks]], axis=0)
    grown = np.isinf(sizes[peaks]) | (largest / _GROWTH > sizes[peaks])
    exact: FloatArray = np.where(np.isinf(sizes[peaks]), places[peaks], found)[grown]
    return exact
