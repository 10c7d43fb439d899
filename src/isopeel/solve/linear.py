"""Direct solvers for band matrices."""

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from scipy.linalg.lapack import dgbtrf, dgbtrs

from isopeel.assembly.system import BandMatrix
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.solve.blocks import BlockedFactor, energy

#: Of the energy of a solution: an iteration corrects what is left, and learns what it is.
_ENOUGH = 0.01
GOLDEN_RATIO = (1 + 5**0.5) / 2


class Factor(Protocol):
    """A factorized matrix."""

    def solve(self, right_side: FloatArray) -> FloatArray:
        """Solve for a right side (n,)."""
        ...


class SingularError(ArithmeticError):
    """LU met a pivot that is zero."""


class Approximate(NamedTuple):
    """A factor, a motion (count,) that two inverse iterations lead to, and what that needs by the matrix."""

    factor: BlockedFactor
    soft: FloatArray
    needed: float


def approximate(matrix: BandMatrix) -> Approximate:
    """A factor of a symmetric matrix whose solutions are right to about a hundredth in energy.

    It is kept in single precision where that suffices for the softest motions, which suffer most: inverse
    iterations lead to them. Raises NotPositiveDefiniteError.
    """
    factor = BlockedFactor.of(matrix.entries, np.float32)
    # multiples of the golden ratio, less what is whole of them: it has a share of all motions
    anything = np.mod(np.arange(factor.count) * GOLDEN_RATIO, 1.0) - 0.5
    start = factor.solve(anything)
    soft = factor.solve(start)
    needed = energy(matrix.entries, soft)
    suffices = abs(needed - float(soft @ start)) < _ENOUGH * needed
    if not suffices:
        factor = BlockedFactor.of(matrix.entries, np.float64)
    return Approximate(factor, soft, needed)


@dataclass(frozen=True, eq=False)
class BandLU:
    """A = P L U with partial pivoting, by LAPACK gbtrf. It overwrites the matrix's entries."""

    entries: FloatArray
    pivots: IntArray
    half_bandwidth: int

    @classmethod
    def of(cls, matrix: BandMatrix) -> "BandLU":
        """Factorize; raises SingularError."""
        b = matrix.half_bandwidth
        entries, pivots, info = dgbtrf(matrix.entries.T, b, b, overwrite_ab=1)
        if info != 0:
            raise SingularError(f"pivot {info} vanishes")
        return cls(entries, pivots, b)

    def solve(self, right_side: FloatArray) -> FloatArray:
        """Solve for a right side (n,)."""
        b = self.half_bandwidth
        solution: FloatArray = dgbtrs(self.entries, b, b, right_side, self.pivots)[0]
        return solution


class Border(NamedTuple):
    """Column and row that border a matrix, whose corner is zero: [[A, column], [row, 0]]."""

    column: FloatArray  # (n,)
    row: FloatArray  # (n,)


@dataclass(frozen=True, eq=False)
class Bordered:
    """A factorized matrix with a border, by block elimination."""

    inner: Factor
    border: Border
    eliminated: FloatArray  # A^-1 column

    @classmethod
    def of(cls, inner: Factor, border: Border) -> "Bordered":
        """Eliminate the column; raises SingularError."""
        eliminated = inner.solve(border.column)
        if not border.row @ eliminated:
            raise SingularError("the control does not notice the load")
        return cls(inner, border, eliminated)

    def solve(self, right_side: FloatArray) -> FloatArray:
        """Solve for a right side (n + 1,)."""
        column, row = self.eliminated, self.border.row
        partial = self.inner.solve(right_side[:-1])
        last = (row @ partial - right_side[-1]) / (row @ column)
        return np.append(partial - last * column, last)


def factorize(matrix: BandMatrix) -> Factor:
    """Cholesky in symmetric storage; LU in general storage, which overwrites the entries.

    Raises NotPositiveDefiniteError, SingularError.
    """
    if matrix.storage == "symmetric":
        return BlockedFactor.of(matrix.entries, np.float64)
    return BandLU.of(matrix)
