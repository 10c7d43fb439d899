"""The Cholesky factor of a band by blocks of columns, and solutions with it.

LAPACK's pbtrs handles one column after the other, and each waits for the last one. Here the inverses of the
diagonal blocks are computed once, and the effect of a block on the rows below is one matrix-vector product by
a SIMD kernel. This pays, because the factor of a chord tangent is used hundreds of times. The factorization
uses such products too, and writes the form that solutions read.
"""

from dataclasses import dataclass
from typing import Any, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import compiled_reordered, inner_reordered
from isopeel.matrix.factor import NotPositiveDefiniteError
from isopeel.matrix.simd_kernels import COLUMNS, backward, forward, set_product, take_off_product

#: In single or in double precision.
Floats: TypeAlias = NDArray[np.floating[Any]]


@dataclass(frozen=True, eq=False)
class BandCholesky:
    """L of A = L L^T, a band matrix of n rows: the inverses of diagonal blocks, and the blocks below them.

    In single precision, solutions read half of the memory, and so take about half of the time. Columns of
    functions inside C0 elements end with the element: the zeros below are not stored.
    """

    #: For each block: the inverse (8, 8), column by column, and the columns (8, rows below).
    values: Floats
    starts: IntArray  # (blocks + 1,) where those of a block scaled; the rows below are a multiple of 8
    count: int

    @classmethod
    def of(cls, columns: FloatArray, precision: type[np.floating[Any]]) -> Self:
        """Return the factor of A, whose lower half has the columns (n, half-bandwidth + 1).

        It is computed in double precision, and stored in the given precision.
        Raises NotPositiveDefiniteError.
        """
        n = len(columns)
        reach = np.empty(-(-n // COLUMNS), np.int64)
        _find_reach(columns, reach)
        starts = np.append(0, np.cumsum(COLUMNS * (COLUMNS + reach)))
        values = np.empty(starts[-1], precision)
        pivot = _factorize(columns, reach, values, starts)
        if pivot > 0:
            raise NotPositiveDefiniteError(f"pivot {pivot} is not positive")
        return cls(values, starts, n)

    def solve(self, right_side: FloatArray) -> FloatArray:
        """Solve A x = right side (n,)."""
        x, largest = scaled(self.values, self.starts, right_side)
        solve(self.values, self.starts, x)
        return largest * x[: self.count].astype(np.float64)


@compiled_reordered
def _find_reach(columns: FloatArray, reach: IntArray) -> None:
    """Return the number of nonzero rows of L below each block, in multiples of 8, for A (n, width)."""
    n, width = columns.shape
    last = 0
    for block in range(len(reach)):
        beyond = (block + 1) * COLUMNS
        # a column fills the next ones as far as it reaches
        for j in range(beyond - COLUMNS, min(beyond, n)):
            size = min(width, n - j)
            while j + size - 1 > last and columns[j, size - 1] == 0.0:
                size -= 1
            last = max(last, j + size - 1)
        reach[block] = -(-max(last + 1 - beyond, 0) // COLUMNS) * COLUMNS


@compiled_reordered
def _factorize(columns: FloatArray, reach: IntArray, values: Floats, starts: IntArray) -> int:
    """Set the values of L from the columns (n, width) of A; return the first nonpositive pivot, or 0.

    A window on A moves down the band: the blocks that the next block changes.
    """
    blocks, below = len(reach), 0
    for block in range(blocks):
        below = max(below, reach[block])
    beyond = below // COLUMNS
    # column by column: rows from the first of the block on
    window = np.empty((beyond + 1, COLUMNS, COLUMNS + below))
    stride = COLUMNS + below
    inverse = np.zeros((COLUMNS, COLUMNS))
    L = np.empty((COLUMNS, below))
    for block in range(min(beyond, blocks)):
        _enter(columns, block, window[block])
    for block in range(blocks):
        if block + beyond < blocks:
            _enter(columns, block + beyond, window[(block + beyond) % (beyond + 1)])
        here = block % (beyond + 1)
        pivot = _invert(window[here], inverse)
        if pivot > 0:
            return block * COLUMNS + pivot
        rows, start = reach[block], starts[block]
        # L = A inverse^T: entry c of column k of inverse^T is entry k of column c of the inverse
        set_product(window, here * COLUMNS * stride + COLUMNS, stride, inverse, 0, COLUMNS, L, 0, below, rows)
        for c in range(COLUMNS):
            first = start + COLUMNS * COLUMNS + c * rows
            kept = values[first : first + rows]
            for i in range(rows):
                kept[i] = L[c, i]
            for i in range(COLUMNS):
                values[start + c * COLUMNS + i] = inverse[c, i]
        for ahead in range(min(rows // COLUMNS, blocks - 1 - block)):
            target = (block + 1 + ahead) % (beyond + 1)
            offset = ahead * COLUMNS
            first = target * COLUMNS * stride
            take_off_product(L, offset, below, L, offset, below, window, first, stride, rows - offset)
    return 0


@inner_reordered
def _enter(columns: FloatArray, block: int, A: FloatArray) -> None:
    """Set A (8, rows), by columns, to a block of the columns (n, width); beyond all, to the identity."""
    n, width = columns.shape
    A.fill(0.0)
    for c in range(COLUMNS):
        first = block * COLUMNS + c
        if first < n:
            row, column = A[c], columns[first]
            for i in range(min(width, n - first, len(row) - c)):
                row[c + i] = column[i]
        else:
            A[c, c] = 1.0


@inner_reordered
def _invert(A: FloatArray, inverse: FloatArray) -> int:
    """Set the inverse of the Cholesky factor of the first rows of A; return the first failed pivot, or 0."""
    for c in range(COLUMNS):
        if not A[c, c] > 0.0:
            return c + 1
        scale = 1.0 / np.sqrt(A[c, c])
        for row in range(c, COLUMNS):
            A[c, row] *= scale
        for k in range(c + 1, COLUMNS):
            for row in range(k, COLUMNS):
                A[k, row] -= A[c, k] * A[c, row]
    for c in range(COLUMNS):
        inverse[c, c] = 1.0 / A[c, c]
        for row in range(c + 1, COLUMNS):
            total = 0.0
            for k in range(c, row):
                total += A[k, row] * inverse[c, k]
            inverse[c, row] = -total / A[row, row]
    return 0


@compiled_reordered
def energy(columns: FloatArray, x: FloatArray) -> float:
    """Return x . A x for x (n,) and a symmetric matrix, whose lower half has the columns (n, width)."""
    n, width = columns.shape
    total = 0.0
    for j in range(n):
        column, ahead = columns[j], x[j:]
        product = 0.5 * column[0] * x[j]
        for i in range(1, min(width, n - j)):
            product += column[i] * ahead[i]
        total += 2.0 * product * x[j]
    return total


@compiled_reordered
def scaled(values: Floats, starts: IntArray, right_side: FloatArray) -> tuple[Floats, float]:
    """Return the right side (n,) for `solve`, divided by its largest number, and that number.

    The right side has the precision of the factor. Single precision ends at 1e38, which could be exceeded in
    the units of a problem. The array has room for all blocks, and for the rows below the last one.
    """
    blocks, n = len(starts) - 1, len(right_side)
    most = 0
    for block in range(blocks):
        most = max(most, (starts[block + 1] - starts[block]) // COLUMNS)
    x = np.zeros(blocks * COLUMNS + most, values.dtype)
    largest = 0.0
    for i in range(n):
        largest = max(largest, abs(right_side[i]))
    largest = largest if largest > 0.0 else 1.0
    for i in range(n):
        x[i] = right_side[i] / largest
    return x, largest


@compiled_reordered
def solve(values: Floats, starts: IntArray, x: Floats) -> None:
    """Solve L L^T x = right side in place, for the right side of `scaled`."""
    blocks = len(starts) - 1
    for block in range(blocks):
        rows = (starts[block + 1] - starts[block]) // COLUMNS - COLUMNS
        forward(values, starts[block], rows, x, block * COLUMNS)  # type: ignore[call-arg]
    for block in range(blocks - 1, -1, -1):
        rows = (starts[block + 1] - starts[block]) // COLUMNS - COLUMNS
        backward(values, starts[block], rows, x, block * COLUMNS)  # type: ignore[call-arg]
