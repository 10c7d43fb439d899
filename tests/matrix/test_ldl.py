"""The inertia of a band matrix, against eigenvalues by LAPACK."""

import numpy as np
import pytest
from scipy.linalg import eigvals_banded

from isopeel.matrix.band import BandMatrix
from isopeel.matrix.factor import SingularError
from isopeel.matrix.ldl import BandLDL


def band(entries: np.ndarray) -> BandMatrix:
    workspace = np.zeros((len(entries) + 1, entries.shape[1]))
    workspace[:-1] = entries
    return BandMatrix(workspace, entries.shape[1] - 1, "symmetric")


@pytest.mark.parametrize("seed", range(32))
def test_negative_eigenvalues_are_counted_and_systems_solved(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, b = 57 + seed % 4, (1, 3, 5, 20)[seed // 4 % 4]
    entries = rng.standard_normal((n, b + 1))
    entries[:, 0] += rng.uniform(-2.0, 6.0)
    for k in range(1, b + 1):
        entries[n - k :, k] = 0.0  # beyond the last row
    dense = np.diag(entries[:, 0])
    for k in range(1, b + 1):
        dense += np.diag(entries[: n - k, k], -k) + np.diag(entries[: n - k, k], k)
    factor = BandLDL.of(band(entries))
    assert factor.negative == np.count_nonzero(eigvals_banded(entries.T, lower=True) < 0)
    x = rng.standard_normal(n)
    # without pivoting some digits are lost: the growth of these matrices is below 1e4
    np.testing.assert_allclose(factor.solve(dense @ x), x, rtol=1e-8, atol=1e-8)


def test_a_vanishing_pivot_is_reported() -> None:
    with pytest.raises(SingularError, match="too small"):
        BandLDL.of(band(np.array([[0.0, 1.0], [0.0, 0.0]])))
