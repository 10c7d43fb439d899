"""L-BFGS pairs: corrections, and the changes of the residual that they made, which update a chord tangent."""

from dataclasses import dataclass
from typing import Any, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import compiled_reordered
from isopeel.matrix.cholesky import BandCholesky, Floats, scaled, solve

#: In single precision: what is learned is no more exact, and half of the memory is read in half of the time.
Singles: TypeAlias = NDArray[np.float32]

#: LbfgsPairs that are kept; more of them learn little more.
MOST_PAIRS = 10
#: Rows of an array of pairs: what is beyond the kept ones is room for the next.
_ROWS = 3 * MOST_PAIRS


@dataclass(frozen=True, eq=False)
class LbfgsPairs:
    """Corrections of the unknowns, and the changes of the residual that they made; the newest at the end.

    They are the rows from `first` up to `end` of arrays that have room for more. Only the newest pairs may be
    followed by others: a `copy` may, wherever they come from.
    """

    rows: Singles  # (2, rows, count): corrections s, changes c
    products: FloatArray  # (rows,) s . c, positive
    first: int = 0
    end: int = 0

    @classmethod
    def none(cls, count: int) -> Self:
        """For a number of unknowns."""
        return cls(np.empty((2, _ROWS, count), np.float32), np.empty(_ROWS))

    @classmethod
    def of(cls, corrections: NDArray[Any], changes: NDArray[Any]) -> Self:
        """Take corrections (k, count) and changes (k, count)."""
        pairs = cls.none(corrections.shape[1])
        for correction, change in zip(corrections, changes, strict=True):
            pairs = pairs.followed_by(correction.astype(np.float64), change.astype(np.float64))
        return pairs

    @property
    def corrections(self) -> Singles:
        """(k, count)."""
        return self.rows[0, self.first : self.end]

    @property
    def changes(self) -> Singles:
        """(k, count)."""
        return self.rows[1, self.first : self.end]

    def copy(self) -> Self:
        """The same, whatever others are followed by."""
        return self.of(self.corrections, self.changes)

    def with_room(self, count: int) -> Self:
        """The same, in other arrays where these have no room for so many more; at most two thirds of all."""
        if self.end + count <= len(self.products):
            return self
        kept, end = slice(self.first, self.end), self.end - self.first
        rows, products = np.empty_like(self.rows), np.empty_like(self.products)
        rows[:, :end], products[:end] = self.rows[:, kept], self.products[kept]
        return type(self)(rows, products, 0, end)

    def followed_by(self, correction: FloatArray, change: FloatArray) -> Self:
        """These and a new pair, if its product is positive; the oldest beyond MOST_PAIRS are left out."""
        pairs = self.with_room(1)
        first, end = follow(pairs.rows, pairs.products, pairs.first, pairs.end, correction, change)
        return self if end == pairs.end else type(self)(pairs.rows, pairs.products, first, end)

    def correction(self, factor: BandCholesky, residual: FloatArray) -> FloatArray:
        """-H r with the inverse H of a kept tangent, updated by the pairs: see `correct`."""
        found = np.empty(len(residual))
        correct(factor.values, factor.starts, self.rows, self.products, self.first, self.end, residual, found)
        return found


@compiled_reordered
def correct(
    values: Floats,
    starts: IntArray,
    rows: Singles,
    products: FloatArray,
    first: int,
    end: int,
    residual: FloatArray,
    correction: FloatArray,
) -> None:
    """Set -H r (n,) with the inverse H of a kept tangent, updated by the pairs: the two-loop recursion.

    Nocedal and Wright, Numerical Optimization, Algorithm 7.4; the kept tangent, of which there are the values
    and starts of the factor, is the initial matrix. All is in the precision of the factor.
    """
    x, largest = scaled(values, starts, residual)
    shares = np.empty(end - first, values.dtype)
    kept = slice(first, end)
    n = len(residual)
    _take_off(rows[0, kept], rows[1, kept], products[kept], x, shares, n)
    solve(values, starts, x)
    _put_back(rows[0, kept], rows[1, kept], products[kept], x, shares, n)
    for i in range(n):
        correction[i] = -largest * x[i]


@compiled_reordered
def follow(
    rows: Singles, products: FloatArray, first: int, end: int, correction: FloatArray, change: FloatArray
) -> tuple[int, int]:
    """Add a pair in the row `end`, if its product is positive; return the first and the end of those kept."""
    products[end] = _keep(correction, change, rows[0, end], rows[1, end])
    if not products[end] > 0.0:
        return first, end
    return max(first, end - MOST_PAIRS + 1), end + 1


@compiled_reordered
def _keep(correction: FloatArray, change: FloatArray, one: Singles, other: Singles) -> float:
    """Round a pair to single precision; return the product of what is kept."""
    total = 0.0
    for i in range(len(correction)):
        one[i] = correction[i]
        other[i] = change[i]
        total += np.float64(one[i]) * np.float64(other[i])
    return total


@compiled_reordered
def _take_off(
    corrections: Singles, changes: Singles, products: FloatArray, x: Floats, shares: Floats, n: int
) -> None:
    """The first loop of the recursion, from the newest pair to the oldest."""
    count = len(products)
    for newer in range(count):
        # of a loop that counts down the compiler does not know that k is a place
        k = count - 1 - newer
        # a Python zero would make the sum double
        total = x.dtype.type(0)
        for i in range(n):
            total += corrections[k, i] * x[i]
        share = x.dtype.type(total / products[k])
        shares[k] = share
        for i in range(n):
            x[i] -= share * changes[k, i]


@compiled_reordered
def _put_back(
    corrections: Singles, changes: Singles, products: FloatArray, x: Floats, shares: Floats, n: int
) -> None:
    """The second loop, from the oldest pair to the newest."""
    for k in range(len(products)):
        total = x.dtype.type(0)
        for i in range(n):
            total += changes[k, i] * x[i]
        share = shares[k] - x.dtype.type(total / products[k])
        for i in range(n):
            x[i] += share * corrections[k, i]
