"""Entries of a band matrix have one place, in Python and in compiled code."""

from typing import Any

import numpy as np
import pytest
from numba import njit

from isopeel.common.arrays import FloatArray
from isopeel.matrix.band import BandMatrix, Storage, entry_place
from isopeel.matrix.factorize import factorize


def _added(band: FloatArray, diagonal: int, row: int, column: int, value: float) -> None:
    band.ravel()[entry_place(band.shape[1] - 1, diagonal, row, column)] += value


added: Any = njit(_added)


@pytest.mark.parametrize("storage", ["symmetric", "general"])
def test_entries_are_those_that_factors_read(storage: Storage) -> None:
    n, b = 9, 3
    rng = np.random.default_rng(0)
    dense = np.tril(np.triu(rng.random((n, n)), -b), b)
    dense = dense + dense.T + 2 * b * np.eye(n)
    i, j = np.nonzero(dense if storage == "general" else np.tril(dense))
    matrix = BandMatrix.zeros(n, b, storage)
    # in two parts each
    matrix.add(np.repeat(i, 2), np.repeat(j, 2), np.repeat(dense[i, j] / 2, 2))
    other = BandMatrix.zeros(n, b, storage)
    for row, column in zip(i, j, strict=True):
        added(other.workspace, other.diagonal, row, column, dense[row, column])
    np.testing.assert_array_equal(matrix.workspace, other.workspace)
    assert not matrix.workspace[-1].any()
    right_side = rng.random(n)
    # a well-conditioned matrix, in double precision
    np.testing.assert_allclose(
        factorize(matrix).solve(right_side), np.linalg.solve(dense, right_side), rtol=1e-12
    )


def test_a_workspace_is_emptied_for_the_next_matrix() -> None:
    matrix = BandMatrix.zeros(4, 1, "symmetric")
    matrix.add(np.array([1]), np.array([0]), np.array([2.0]))
    again = matrix.zeroed()
    assert again.workspace is matrix.workspace
    assert not again.workspace.any()
