"""Direct solvers for band matrices."""

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.blas import dsbmv
from scipy.linalg.lapack import dgbtrf, dgbtrs, dpbtrf, dpbtrs, spbtrf, spbtrs

from isopeel.arrays import FloatArray, IntArray
from isopeel.assembly.system import BandMatrix

#: Of the energy of a solution: an iteration corrects what is left, and learns what it is.
_ENOUGH = 0.01
#: Narrower bands are factorized as quickly in double precision.
_WIDE = 40


class Factor(Protocol):
    """A factorized matrix."""

    def solve(self, right_side: FloatArray) -> FloatArray:
        """Solve for a right side (n,)."""
        ...


class NotPositiveDefiniteError(ArithmeticError):
    """Cholesky met a pivot that is not positive."""


class SingularError(ArithmeticError):
    """LU met a pivot that is zero."""


@dataclass(frozen=True, eq=False)
class BandCholesky:
    """A = L L^T of a symmetric matrix, by LAPACK pbtrf. It overwrites the matrix's entries."""

    entries: FloatArray

    @classmethod
    def of(cls, matrix: BandMatrix) -> "BandCholesky":
        """Factorize; raises NotPositiveDefiniteError."""
        entries, info = dpbtrf(matrix.entries.T, lower=1, overwrite_ab=1)
        if info != 0:
            raise NotPositiveDefiniteError(f"pivot {info} is not positive")
        return cls(entries)

    def solve(self, right_side: FloatArray) -> FloatArray:
        """Solve for a right side (n,)."""
        solution: FloatArray = dpbtrs(self.entries, right_side, lower=1)[0]
        return solution


@dataclass(frozen=True, eq=False)
class SingleBandCholesky:
    """The same in single precision, in half of the memory and so in about half of the time.

    Its solutions are near the exact ones where the matrix is not too ill-conditioned; see `approximate`.
    """

    entries: NDArray[np.float32]

    @classmethod
    def of(cls, matrix: BandMatrix) -> "SingleBandCholesky":
        """Factorize, which leaves the matrix's entries as they are; raises NotPositiveDefiniteError."""
        entries, info = spbtrf(matrix.entries.astype(np.float32).T, lower=1, overwrite_ab=1)
        if info != 0:
            raise NotPositiveDefiniteError(f"pivot {info} is not positive")
        return cls(entries)

    def solve(self, right_side: FloatArray) -> FloatArray:
        """Solve for a right side (n,)."""
        # single precision ends at 1e38, which units of a problem could pass
        largest = float(np.abs(right_side).max()) or 1.0
        scaled = (right_side / largest).astype(np.float32)
        solution: NDArray[np.float32] = spbtrs(self.entries, scaled, lower=1)[0]
        return largest * solution.astype(np.float64)


def approximate(matrix: BandMatrix) -> Factor:
    """A factor of a symmetric matrix whose solutions are right to about a hundredth in energy.

    In single precision where that pays, and suffices for the softest motions, which suffer most: two inverse
    iterations lead to them. The entries may be overwritten. Raises NotPositiveDefiniteError.
    """
    if matrix.half_bandwidth < _WIDE:
        return BandCholesky.of(matrix)
    try:
        factor = SingleBandCholesky.of(matrix)
    except NotPositiveDefiniteError:
        return BandCholesky.of(matrix)
    start = factor.solve(np.random.default_rng(0).standard_normal(len(matrix.entries)))
    soft = factor.solve(start)
    energy = float(soft @ dsbmv(matrix.half_bandwidth, 1.0, matrix.entries.T, soft, lower=1))
    if abs(energy - float(soft @ start)) < _ENOUGH * energy:
        return factor
    return BandCholesky.of(matrix)


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
    """Cholesky in symmetric storage, LU in general storage; the entries are overwritten."""
    return BandCholesky.of(matrix) if matrix.storage == "symmetric" else BandLU.of(matrix)
