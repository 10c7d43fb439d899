"""Inertia of a symmetric band matrix: how many of its eigenvalues are negative."""

from dataclasses import dataclass

import numpy as np
from numba import njit

from isopeel.arrays import FloatArray
from isopeel.assembly.system import BandMatrix
from isopeel.solve.linear import SingularError

#: Largest pivot over the largest entry that was there: beyond it half of the digits are lost.
_MOST_GROWTH = 1e8


@dataclass(frozen=True, eq=False)
class BandLDL:
    """A = L D L^T without pivoting of a symmetric matrix, definite or not. It overwrites the entries.

    By Sylvester's law of inertia A has as many negative eigenvalues as D has negative entries. Without
    pivoting the factor exists unless a leading minor vanishes, and is as exact as its entries have not
    grown (Golub and Van Loan, Matrix Computations, Sec. 4.4): growth is therefore checked.
    """

    entries: FloatArray  # (n, b + 1): D in the first column, the columns of L below it
    negative: int  # eigenvalues

    @classmethod
    def of(cls, matrix: BandMatrix) -> "BandLDL":
        """Factorize a matrix in symmetric storage; raises SingularError where its entries grow too much."""
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


@njit(cache=True)
def _factorize(entries: FloatArray, most: float) -> bool:
    n, width = entries.shape
    for j in range(n):
        pivot = entries[j, 0]
        if not 0.0 < abs(pivot) <= most:
            return False
        rows = min(width, n - j)
        for k in range(1, rows):
            share = entries[j, k] / pivot
            if share != 0.0:
                target = entries[j + k]
                for i in range(k, rows):
                    target[i - k] -= share * entries[j, i]
        for k in range(1, rows):
            entries[j, k] /= pivot
    return True


@njit(cache=True)
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
