"""A matrix in band storage, for symmetric factors or with room for those of a pivoted LU."""

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import inlined

#: Storage of a matrix: its lower half, or the whole band with room for the fill of a pivoted LU.
Storage = Literal["symmetric", "general"]


def _entry_place(stride: Any, diagonal: Any, row: Any, column: Any) -> Any:
    """Return the index of entry (row, column) in a flattened workspace.

    The stride is the width of the workspace minus one, and `diagonal` is the index of the diagonal in a row:
    if it is not zero, entries above the diagonal are stored too.
    """
    return stride * column + diagonal + row


#: The same in compiled code.
entry_place = inlined(_entry_place)


@dataclass(frozen=True, eq=False)
class BandMatrix:
    """Matrix in LAPACK's band storage, transposed: row j of `entries` is column j of the matrix.

    symmetric: entries[j, i - j] = A_ij for i >= j (pbtrf, lower); general: entries[j, 2 b + i - j] with
    half-bandwidth b, where the first b columns are for the fill of gbtrf.
    """

    workspace: FloatArray  # (n + 1, width); the last row is not used
    half_bandwidth: int
    storage: Storage

    @classmethod
    def zeros(cls, count: int, half_bandwidth: int, storage: Storage) -> "BandMatrix":
        """Return a zero matrix of `count` rows."""
        width = half_bandwidth + 1 if storage == "symmetric" else 3 * half_bandwidth + 1
        return cls(np.zeros((count + 1, width)), half_bandwidth, storage)

    def zeroed(self) -> "BandMatrix":
        """Return a zero matrix of the same size, in the same workspace: this matrix is zero, too."""
        self.workspace.fill(0.0)
        return replace(self)

    @property
    def entries(self) -> FloatArray:
        """The entries (n, width)."""
        return self.workspace[:-1]

    @property
    def diagonal(self) -> int:
        """Index of the diagonal in a row of the workspace: zero if only the lower half is stored."""
        return 0 if self.storage == "symmetric" else 2 * self.half_bandwidth

    def add(self, rows: IntArray, columns: IntArray, values: FloatArray) -> None:
        """Add values to entries; in a symmetric matrix, entries above the diagonal are not stored."""
        stride = self.workspace.shape[1] - 1
        np.add.at(self.workspace.reshape(-1), _entry_place(stride, self.diagonal, rows, columns), values)

    def add_outer(self, vector: FloatArray, size: float) -> bool:
        """Add size x vector vector^T to a symmetric matrix, if it fits the band; return whether it does."""
        (places,) = np.nonzero(vector)
        if self.storage != "symmetric" or np.ptp(places) > self.half_bandwidth:
            return False
        row, column = np.meshgrid(places, places, indexing="ij")
        lower = row >= column
        i, j = row[lower], column[lower]
        self.add(i, j, size * vector[i] * vector[j])
        return True
