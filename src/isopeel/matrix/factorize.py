"""The factor that suits a band matrix."""

import numpy as np

from isopeel.matrix.band import BandMatrix
from isopeel.matrix.cholesky import BandCholesky
from isopeel.matrix.factor import Factor
from isopeel.matrix.lu import BandLU


def factorize(matrix: BandMatrix) -> Factor:
    """Cholesky in symmetric storage; LU in general storage, which overwrites the entries.

    Raises NotPositiveDefiniteError, SingularError.
    """
    if matrix.storage == "symmetric":
        return BandCholesky.of(matrix.entries, np.float64)
    return BandLU.of(matrix)
