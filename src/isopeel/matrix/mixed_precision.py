"""A Cholesky factor in single precision, if that is exact enough."""

from typing import NamedTuple

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.matrix.band import BandMatrix
from isopeel.matrix.cholesky import BandCholesky, energy

#: Allowed error of a solution, as a share of its energy: the iteration corrects the rest.
_ENOUGH = 0.01
GOLDEN_RATIO = (1 + 5**0.5) / 2


class Approximate(NamedTuple):
    """A factor, a motion (count,) after two inverse iterations, and its product with the matrix."""

    factor: BandCholesky
    soft: FloatArray
    needed: float


def approximate(matrix: BandMatrix) -> Approximate:
    """Return a factor of a symmetric matrix whose solutions are right to about a hundredth in energy.

    It is stored in single precision if this is exact enough for the softest motions, whose errors are the
    largest: inverse iterations converge to them. Raises NotPositiveDefiniteError.
    """
    factor = BandCholesky.of(matrix.entries, np.float32)
    # fractional parts of multiples of the golden ratio: a start with a share of all motions
    anything = np.mod(np.arange(factor.count) * GOLDEN_RATIO, 1.0) - 0.5
    start = factor.solve(anything)
    soft = factor.solve(start)
    needed = energy(matrix.entries, soft)
    suffices = abs(needed - float(soft @ start)) < _ENOUGH * needed
    if not suffices:
        factor = BandCholesky.of(matrix.entries, np.float64)
    return Approximate(factor, soft, needed)
