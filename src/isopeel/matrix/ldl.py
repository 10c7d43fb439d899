"""Inertia of a symmetric band matrix: the number of its negative eigenvalues."""

from dataclasses import dataclass

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.compilation import compiled, inner
from isopeel.matrix.band import BandMatrix
from isopeel.matrix.factor import SingularError

#: Largest pivot over the largest original entry; with larger ones half of the digits are lost.
_MOST_GROWTH = 1e8
_COLUMNS = 4


@dataclass(frozen=True, eq=False)
class BandLDL:
    """A = L D L^T without pivoting of a symmetric matrix, definite or not. It overwrites the entries.

    By Sylvester's law of inertia A has as many negative eigenvalues as D has negative entries. Without
    pivoting the factor exists unless a leading principal minor vanishes. Its error is proportional to the
    growth of the entries (Golub and Van Loan, Matrix Computations, Sec. 4.4), which is therefore checked.
    """

    entries: FloatArray  # (n, b + 1): D in the first column, the columns of L below it
    negative: int  # eigenvalues

    @classmethod
    def of(cls, matrix: BandMatrix) -> "BandLDL":
        """Return the factor of a matrix in symmetric storage; SingularError if its entries grow too much."""
        entries = matrix.entries
        largest = float(np.abs(entries[:, 0]).max())
        # a pivot p adds (entry)^2 / p to those after it
        if not _factorize(entries, _MOST_GROWTH * largest):
            raise SingularError("a pivot of the symmetric factor is too small")
        return cls(entries, int(np.count_nonzero(entries[:, 0] < 0)))

    def solve(self, right_side: FloatArray) -> FloatArray:
        """Solve for a right side (n,)."""
        solution = right_side.astype(np.float64, copy=True)
        _substitute(self.entries, solution)
        return solution


@compiled
def _factorize(entries: FloatArray, most: float) -> bool:
    """Factorize four columns at a time, so that the columns after them are read and written once for all."""
    n, width = entries.shape
    shares = np.zeros(_COLUMNS)
    for first in range(0, n, _COLUMNS):
        end = min(first + _COLUMNS, n)
        for j in range(first, end):
            if not 0.0 < abs(entries[j, 0]) <= most:
                return False
            for t in range(j + 1, min(end, j + width)):
                share = entries[j, t - j] / entries[j, 0]
                for i in range(t - j, min(width, n - j)):
                    entries[t, i - t + j] -= share * entries[j, i]
        for t in range(end, min(end - 1 + width, n)):
            for a in range(end - first):
                k = t - first - a
                shares[a] = entries[first + a, k] / entries[first + a, 0] if k < width else 0.0
            # rows that all four columns reach, and the others
            whole = max(min(width - (t - first), n - t), 0) if end - first == _COLUMNS else 0
            if whole > 0:
                _subtract(entries[first:end], t - first, shares, entries[t, :whole])
            for a in range(end - first):
                k = t - first - a
                for i in range(whole, min(width - k, n - t)):
                    entries[t, i] -= shares[a] * entries[first + a, k + i]
        for j in range(first, end):
            for k in range(1, min(width, n - j)):
                entries[j, k] /= entries[j, 0]
    return True


@inner
def _subtract(columns: FloatArray, start: int, shares: FloatArray, target: FloatArray) -> None:
    one, two, three, four = columns[0], columns[1], columns[2], columns[3]
    a, b, c, d = shares[0], shares[1], shares[2], shares[3]
    for i in range(target.size):
        k = start + i
        target[i] -= a * one[k] + b * two[k - 1] + c * three[k - 2] + d * four[k - 3]


@compiled
def _substitute(entries: FloatArray, x: FloatArray) -> None:
    n, width = entries.shape
    for j in range(n):
        for k in range(1, min(width, n - j)):
            x[j + k] -= entries[j, k] * x[j]
    for j in range(n - 1, -1, -1):
        total = x[j] / entries[j, 0]
        for k in range(1, min(width, n - j)):
            total -= entries[j, k] * x[j + k]
        x[j] = total
