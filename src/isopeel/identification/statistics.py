"""What a fit knows about its parameters: errors, correlation, and tests of the residuals.

Linear theory of nonlinear least squares: the covariance is s^2 (J^T J)^-1, with the residuals in units of
their noise (Seber and Wild, Nonlinear Regression, 1989, section 2.1.2).
"""

from typing import NamedTuple

import numpy as np
from scipy.stats import chi2, norm

from isopeel.common.arrays import FloatArray

#: A singular value below this part of the largest one is round-off.
_ROUND_OFF = 1e-12


class Uncertainty(NamedTuple):
    """Standard errors of coordinates, and how well they are separated.

    `root` (k, k) is a root of the covariance of the coordinates, root root^T; `alone` (k,) are the standard
    errors if all other coordinates were known; `condition` is the ratio of the largest and the smallest
    singular value of the Jacobian.
    """

    root: FloatArray
    alone: FloatArray
    condition: float

    @property
    def covariance(self) -> FloatArray:
        """Covariance of the coordinates (k, k)."""
        return self.root @ self.root.T

    @property
    def errors(self) -> FloatArray:
        """Standard errors (k,)."""
        errors: FloatArray = np.linalg.norm(self.root, axis=1)
        return errors

    @property
    def correlation(self) -> FloatArray:
        """Correlation matrix (k, k)."""
        return self.covariance / np.outer(self.errors, self.errors)


def uncertainty(jacobian: FloatArray, variance: float = 1.0) -> Uncertainty:
    """Return the uncertainty of coordinates from the Jacobian (points, k) of the weighted residuals.

    `variance` is that of a residual: 1 if the noise is stated. A combination that the residuals do not depend
    on gets the error that round-off leaves, which is finite and large.
    """
    sizes = np.linalg.norm(jacobian, axis=0)
    _, singular, right = np.linalg.svd(jacobian, full_matrices=False)
    largest = float(singular.max(initial=0.0)) or 1.0
    singular = np.maximum(singular, _ROUND_OFF * largest)
    root = np.sqrt(variance) * right.T / singular
    alone = np.sqrt(variance) / np.maximum(sizes, _ROUND_OFF * largest)
    return Uncertainty(root, alone, largest / float(singular.min()))


class RunsTest(NamedTuple):
    """Number of runs of one sign, its mean for independent signs, and the probability of so few."""

    runs: int
    expected: float
    probability: float


def runs_test(residuals: FloatArray) -> RunsTest | None:
    """Test whether residuals (points,) change their sign as often as noise (Wald and Wolfowitz 1940).

    Returns None if there are fewer than ten points of one of the signs: the test is the normal approximation.
    """
    positive = residuals[residuals != 0] > 0
    n, m = int(positive.sum()), int((~positive).sum())
    if min(n, m) < 10:
        return None
    runs = 1 + int(np.count_nonzero(np.diff(positive)))
    mean = 1 + 2 * n * m / (n + m)
    variance = (mean - 1) * (mean - 2) / (n + m - 1)
    # half a run is the correction for a whole number
    return RunsTest(runs, mean, float(norm.cdf((runs + 0.5 - mean) / np.sqrt(variance))))


def chi_square_probability(chi_square: float, freedom: int) -> float:
    """Return the probability that noise of the stated size gives a sum of squares as large."""
    return float(chi2.sf(chi_square, freedom)) if freedom else 1.0
