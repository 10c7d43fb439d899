"""The SIMD kernels compute the products of NumPy."""

from typing import Any

import numpy as np
import pytest
from numba import njit
from scipy.linalg import solve_triangular

from isopeel.matrix.simd_kernels import COLUMNS, backward, forward, set_product, take_off_product


@njit
def _forward(values: Any, block: int, rows: int, x: Any, start: int) -> None:
    forward(values, block, rows, x, start)  # type: ignore[call-arg]


@njit
def _backward(values: Any, block: int, rows: int, x: Any, start: int) -> None:
    backward(values, block, rows, x, start)  # type: ignore[call-arg]


@njit
def _set(left: Any, right: Any, result: Any, rows: int) -> None:
    set_product(left, 3, left.shape[1], right, 2, right.shape[1], result, 1, result.shape[1], rows)


@njit
def _take_off(left: Any, right: Any, result: Any, rows: int) -> None:
    take_off_product(left, 3, left.shape[1], right, 2, right.shape[1], result, 1, result.shape[1], rows)


@pytest.mark.parametrize("kind", [np.float32, np.float64])
@pytest.mark.parametrize("rows", [0, 8, 16, 40])
def test_a_block_solves_what_its_triangle_does(kind: type[Any], rows: int) -> None:
    random = np.random.default_rng(rows)
    triangle = np.tril(random.standard_normal((COLUMNS, COLUMNS))) + 4 * np.eye(COLUMNS)
    below = random.standard_normal((rows, COLUMNS))
    # in arrays that have something else before and after
    block = np.concatenate([np.linalg.inv(triangle).T.ravel(), below.T.ravel()])
    values = np.concatenate([[9.0] * 5, block, [9.0] * 3]).astype(kind)
    start = random.standard_normal(3 + COLUMNS + rows + 2)
    inside, rest = slice(3, 3 + COLUMNS), slice(3 + COLUMNS, 3 + COLUMNS + rows)
    close = {"rtol": 0, "atol": 100 * np.finfo(kind).eps * (1 + np.abs(below).sum())}

    x, expected = start.astype(kind), start.copy()
    _forward(values, 5, rows, x, 3)
    expected[inside] = solve_triangular(triangle, start[inside], lower=True)
    expected[rest] -= below @ expected[inside]
    np.testing.assert_allclose(x, expected, **close)

    x, expected = start.astype(kind), start.copy()
    _backward(values, 5, rows, x, 3)
    expected[inside] = solve_triangular(triangle.T, start[inside] - below.T @ start[rest])
    np.testing.assert_allclose(x, expected, **close)


@pytest.mark.parametrize("rows", [0, 8, 24])
def test_products_are_those_of_matrices(rows: int) -> None:
    random = np.random.default_rng(rows)
    left, right = random.standard_normal((COLUMNS, rows + 5)), random.standard_normal((COLUMNS, 11))
    result = random.standard_normal((COLUMNS, rows + 2))
    product = right[:, 2 : 2 + COLUMNS].T @ left[:, 3 : 3 + rows]
    expected = result.copy()
    expected[:, 1 : 1 + rows] -= product
    found = result.copy()
    _take_off(left, right, found, rows)
    # sums of eight products of numbers about one
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14)
    expected[:, 1 : 1 + rows] = product
    found = result.copy()
    _set(left, right, found, rows)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-14)
