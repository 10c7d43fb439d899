"""L-BFGS pairs, which update a chord tangent: corrections, and the changes of the residual that they made."""

from dataclasses import dataclass
from typing import Any, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import compiled_reordered, inner_reordered
from isopeel.matrix.cholesky import BandCholesky, Floats, scaled, solve

#: Pairs are stored in single precision: the update is no more exact, and half of the memory takes half of the
#: time to read.
Singles: TypeAlias = NDArray[np.float32]

#: Most pairs that are stored; more of them gain little.
MOST_PAIRS = 10
#: Rows of an array of pairs: the rows beyond the stored pairs are for the next ones.
_ROWS = 3 * MOST_PAIRS


@dataclass(frozen=True, eq=False)
class LbfgsPairs:
    """Corrections of the unknowns, and the changes of the residual that they made; the newest at the end.

    They are the rows from `first` up to `end` of arrays that have room for more. Objects share these arrays:
    pairs may be appended to the newest object only, or to a `copy`.
    """

    rows: Singles  # (2, rows, count): corrections s, changes c
    products: FloatArray  # (rows,) s . c, positive
    first: int = 0
    end: int = 0

    @classmethod
    def none(cls, count: int) -> Self:
        """Return no pairs, for a number of unknowns."""
        return cls(np.empty((2, _ROWS, count), np.float32), np.empty(_ROWS))

    @classmethod
    def of(cls, corrections: NDArray[Any], changes: NDArray[Any]) -> Self:
        """Return the pairs of corrections (k, count) and changes (k, count)."""
        pairs = cls.none(corrections.shape[1])
        for correction, change in zip(corrections, changes, strict=True):
            pairs = pairs.followed_by(correction.astype(np.float64), change.astype(np.float64))
        return pairs

    @property
    def corrections(self) -> Singles:
        """The corrections (k, count)."""
        return self.rows[0, self.first : self.end]

    @property
    def changes(self) -> Singles:
        """The changes of the residual (k, count)."""
        return self.rows[1, self.first : self.end]

    def copy(self) -> Self:
        """Return the same pairs in arrays of their own."""
        return self.of(self.corrections, self.changes)

    def with_room(self, count: int) -> Self:
        """Return the same pairs with room for `count` more (at most two thirds of the rows)."""
        if self.end + count <= len(self.products):
            return self
        kept, end = slice(self.first, self.end), self.end - self.first
        rows, products = np.empty_like(self.rows), np.empty_like(self.products)
        rows[:, :end], products[:end] = self.rows[:, kept], self.products[kept]
        return type(self)(rows, products, 0, end)

    def followed_by(self, correction: FloatArray, change: FloatArray) -> Self:
        """Return these and a new pair, if its product is positive; only the newest MOST_PAIRS are stored."""
        pairs = self.with_room(1)
        first, end = follow(pairs.rows, pairs.products, pairs.first, pairs.end, correction, change)
        return self if end == pairs.end else type(self)(pairs.rows, pairs.products, first, end)

    def correction(self, factor: BandCholesky, residual: FloatArray) -> FloatArray:
        """Return -H r (count,), with the inverse H of a chord tangent updated by the pairs: see `correct`."""
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
    """Set the correction (n,) to -H r, with the inverse H of a chord tangent updated by the L-BFGS pairs.

    By the two-loop recursion of Nocedal and Wright, Numerical Optimization, Algorithm 7.4. The chord tangent,
    given by the values and starts of its factor, is the initial matrix. All is in the precision of the
    factor.
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
    """Store a pair in the row `end`, if its product is positive; return first and end of the stored pairs."""
    products[end] = _keep(correction, change, rows[0, end], rows[1, end])
    if not products[end] > 0.0:
        return first, end
    return max(first, end - MOST_PAIRS + 1), end + 1


@inner_reordered
def _keep(correction: FloatArray, change: FloatArray, one: Singles, other: Singles) -> float:
    """Store a pair in single precision; return the product of the stored vectors."""
    total = 0.0
    for i in range(len(correction)):
        one[i] = correction[i]
        other[i] = change[i]
        total += np.float64(one[i]) * np.float64(other[i])
    return total


@inner_reordered
def _take_off(
    corrections: Singles, changes: Singles, products: FloatArray, x: Floats, shares: Floats, n: int
) -> None:
    """The first loop of the recursion, from the newest pair to the oldest."""
    count = len(products)
    for newer in range(count):
        # in a loop that counts down, the compiler does not know that k is a valid index
        k = count - 1 - newer
        # a Python zero would make the sum double
        total = x.dtype.type(0)
        for i in range(n):
            total += corrections[k, i] * x[i]
        share = x.dtype.type(total / products[k])
        shares[k] = share
        for i in range(n):
            x[i] -= share * changes[k, i]


@inner_reordered
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
