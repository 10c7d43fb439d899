"""Solutions with the Cholesky factor of a band, by blocks of columns.

LAPACK's pbtrs takes one column after another, each of which must wait for the last. Here the inverses of the
diagonal blocks are made once, and what a block takes off the rows below is one product of a matrix and a
vector, which runs in vector registers: a factor that is kept is used hundreds of times.
"""

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray

from isopeel.arrays import FloatArray

# reordered sums let loops run in vector registers
_compiled = njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "nsz"})

#: In single or in double precision.
Floats: TypeAlias = NDArray[np.floating[Any]]

#: Columns of a block; the loops below are written out for as many.
_COLUMNS = 8


@dataclass(frozen=True, eq=False)
class BlockedFactor:
    """L of A = L L^T, a band matrix of n rows: its diagonal blocks' inverses, and what lies below them.

    In single precision solutions take half of the memory, and so about half of the time.
    """

    panels: Floats  # (blocks, 8, rows below)
    inverses: Floats  # (blocks, 8, 8), column by column
    count: int

    @classmethod
    def of(cls, lower: FloatArray, precision: type[np.floating[Any]]) -> "BlockedFactor":
        """Take L (half-bandwidth + 1, n), stored as by LAPACK's pbtrf, lower, and keep it in a precision."""
        width, n = lower.shape
        blocks = -(-n // _COLUMNS)
        # whole vector registers
        below = -(-(width - 1) // _COLUMNS) * _COLUMNS
        panels = np.empty((blocks, _COLUMNS, below), precision)
        inverses = np.zeros((blocks, _COLUMNS, _COLUMNS), precision)
        _take(lower.T, panels, inverses)
        return cls(panels, inverses, n)

    def solve(self, right_side: FloatArray) -> FloatArray:
        """Solve A x = right side (n,)."""
        blocks, _, below = self.panels.shape
        x = np.empty(blocks * _COLUMNS + below, self.panels.dtype)
        solution = np.empty(self.count)
        _solve(self.panels, self.inverses, right_side, x, solution)
        return solution


@_compiled
def _take(columns: FloatArray, panels: Floats, inverses: Floats) -> None:
    """Fill panels and inverses from the columns (n, width) of L."""
    n, width = columns.shape
    blocks, _, below = panels.shape
    for block in range(blocks):
        start = block * _COLUMNS
        for c in range(_COLUMNS):
            column = start + c
            panel = panels[block, c]
            inverse = inverses[block, c]
            panel.fill(0.0)
            if column >= n:
                # beyond the matrix, the identity
                inverse[c] = 1.0
                continue
            offset = _COLUMNS - c
            for i in range(min(below, width - offset, n - column - offset)):
                panel[i] = columns[column, offset + i]
            inverse[c] = 1.0 / columns[column, 0]
            for row in range(c + 1, min(_COLUMNS, n - start)):
                total = 0.0
                for k in range(max(c, row - width + 1), row):
                    total += columns[start + k, row - k] * inverse[k]
                inverse[row] = -total / columns[start + row, 0]


@_compiled
def _solve(panels: Floats, inverses: Floats, right_side: FloatArray, x: Floats, solution: FloatArray) -> None:
    """Solve L L^T solution = right side; x has room for all blocks and the rows below the last one."""
    blocks, _, below = panels.shape
    n = len(right_side)
    # single precision ends at 1e38, which units of a problem could pass
    largest = 0.0
    for i in range(n):
        largest = max(largest, abs(right_side[i]))
    largest = largest if largest > 0.0 else 1.0
    for i in range(n):
        x[i] = right_side[i] / largest
    x[n:].fill(0.0)
    part = np.empty(_COLUMNS, x.dtype)
    zero = 0 * x[0]
    for block in range(blocks):
        start = block * _COLUMNS
        part.fill(zero)
        for c in range(_COLUMNS):
            for row in range(_COLUMNS):
                part[row] += inverses[block, c, row] * x[start + c]
        for row in range(_COLUMNS):
            x[start + row] = part[row]
        rest = x[start + _COLUMNS : start + _COLUMNS + below]
        y0, y1, y2, y3, y4, y5, y6, y7 = (
            part[0],
            part[1],
            part[2],
            part[3],
            part[4],
            part[5],
            part[6],
            part[7],
        )
        L = panels[block]
        L0, L1, L2, L3, L4, L5, L6, L7 = L[0], L[1], L[2], L[3], L[4], L[5], L[6], L[7]
        for i in range(below):
            rest[i] -= (
                L0[i] * y0
                + L1[i] * y1
                + L2[i] * y2
                + L3[i] * y3
                + L4[i] * y4
                + L5[i] * y5
                + L6[i] * y6
                + L7[i] * y7
            )
    for block in range(blocks - 1, -1, -1):
        start = block * _COLUMNS
        rest = x[start + _COLUMNS : start + _COLUMNS + below]
        L = panels[block]
        L0, L1, L2, L3, L4, L5, L6, L7 = L[0], L[1], L[2], L[3], L[4], L[5], L[6], L[7]
        s0, s1, s2, s3, s4, s5, s6, s7 = zero, zero, zero, zero, zero, zero, zero, zero
        for i in range(below):
            value = rest[i]
            s0 += L0[i] * value
            s1 += L1[i] * value
            s2 += L2[i] * value
            s3 += L3[i] * value
            s4 += L4[i] * value
            s5 += L5[i] * value
            s6 += L6[i] * value
            s7 += L7[i] * value
        for c, total in enumerate((s0, s1, s2, s3, s4, s5, s6, s7)):
            part[c] = x[start + c] - total
        for c in range(_COLUMNS):
            total = zero
            for row in range(_COLUMNS):
                total += inverses[block, c, row] * part[row]
            x[start + c] = total
    for i in range(n):
        solution[i] = largest * x[i]
