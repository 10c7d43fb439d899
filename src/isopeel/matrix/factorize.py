"""The choice of the factor of a band matrix."""

import numpy as np

from isopeel.matrix.band import BandMatrix
from isopeel.matrix.cholesky import BandCholesky
from isopeel.matrix.factor import Factor
from isopeel.matrix.lu import BandLU


def factorize(matrix: BandMatrix) -> Factor:
    """Return the Cholesky factor in symmetric storage; the LU factor in general storage, which overwrites it.

    Raises NotPositiveDefiniteError, SingularError.
    """
    if matrix.storage == "symmetric":
        return BandCholesky.of(matrix.entries, np.float64)
    return BandLU.of(matrix)
