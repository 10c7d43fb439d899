"""The interface of all factors of matrices, and their errors."""

from typing import Protocol

from isopeel.common.arrays import FloatArray


class Factor(Protocol):
    """A factorized matrix."""

    def solve(self, right_side: FloatArray) -> FloatArray:
        """Solve for a right side (n,)."""
        ...


class NotPositiveDefiniteError(ArithmeticError):
    """Cholesky's method found a pivot that is not positive."""


class SingularError(ArithmeticError):
    """A factorization found a pivot that is zero, or too small."""
