"""A factorized matrix with one more column and row."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.matrix.factor import Factor, SingularError


class Border(NamedTuple):
    """Column and row that border a matrix A: [[A, column], [row, 0]]."""

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
            raise SingularError("the prescribed displacement does not depend on the load")
        return cls(inner, border, eliminated)

    def solve(self, right_side: FloatArray) -> FloatArray:
        """Solve for a right side (n + 1,)."""
        column, row = self.eliminated, self.border.row
        partial = self.inner.solve(right_side[:-1])
        last = (row @ partial - right_side[-1]) / (row @ column)
        return np.append(partial - last * column, last)
