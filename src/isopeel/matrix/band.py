"""A matrix in band storage, for symmetric factors or with room for those of a pivoted LU."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from isopeel.common.arrays import FloatArray

#: Storage of a matrix: its lower half, or the whole band with room for the fill of a pivoted LU.
Storage = Literal["symmetric", "general"]


@dataclass(frozen=True, eq=False)
class BandMatrix:
    """Matrix in LAPACK's band storage, transposed: row j of `entries` holds column j of the matrix.

    symmetric: entries[j, i - j] = A_ij for i >= j (pbtrf, lower); general: entries[j, 2 b + i - j] with
    half-bandwidth b, whose first b columns are left free for gbtrf.
    """

    workspace: FloatArray  # (n + 1, width); the last row holds nothing
    half_bandwidth: int
    storage: Storage

    @property
    def entries(self) -> FloatArray:
        """(n, width)."""
        return self.workspace[:-1]

    def add_outer(self, vector: FloatArray, size: float) -> bool:
        """Add size x vector vector^T to a symmetric matrix, where the band has room for it; say whether."""
        (places,) = np.nonzero(vector)
        if self.storage != "symmetric" or np.ptp(places) > self.half_bandwidth:
            return False
        row, column = np.meshgrid(places, places, indexing="ij")
        lower = row >= column
        i, j = row[lower], column[lower]
        self.entries[j, i - j] += size * vector[i] * vector[j]
        return True
