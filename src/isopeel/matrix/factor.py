"""What all factors of matrices have in common, and how they fail."""

from typing import Protocol

from isopeel.common.arrays import FloatArray


class Factor(Protocol):
    """A factorized matrix."""

    def solve(self, right_side: FloatArray) -> FloatArray:
        """Solve for a right side (n,)."""
        ...


class NotPositiveDefiniteError(ArithmeticError):
    """Cholesky met a pivot that is not positive."""


class SingularError(ArithmeticError):
    """A factorization met a pivot that is zero, or too small."""
