"""A Cholesky factor in single precision, where that suffices."""

from typing import NamedTuple

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.matrix.band import BandMatrix
from isopeel.matrix.cholesky import BandCholesky, energy

#: Of the energy of a solution: an iteration corrects what is left, and learns what it is.
_ENOUGH = 0.01
GOLDEN_RATIO = (1 + 5**0.5) / 2


class Approximate(NamedTuple):
    """A factor, a motion (count,) that two inverse iterations lead to, and what that needs by the matrix."""

    factor: BandCholesky
    soft: FloatArray
    needed: float


def approximate(matrix: BandMatrix) -> Approximate:
    """Return a factor of a symmetric matrix whose solutions are right to about a hundredth in energy.

    It is kept in single precision where that suffices for the softest motions, which suffer most: inverse
    iterations lead to them. Raises NotPositiveDefiniteError.
    """
    factor = BandCholesky.of(matrix.entries, np.float32)
    # multiples of the golden ratio, less what is whole of them: it has a share of all motions
    anything = np.mod(np.arange(factor.count) * GOLDEN_RATIO, 1.0) - 0.5
    start = factor.solve(anything)
    soft = factor.solve(start)
    needed = energy(matrix.entries, soft)
    suffices = abs(needed - float(soft @ start)) < _ENOUGH * needed
    if not suffices:
        factor = BandCholesky.of(matrix.entries, np.float64)
    return Approximate(factor, soft, needed)
