"""The Cholesky factor of a band, in single precision where that suffices."""

import numpy as np
import pytest
from scipy.linalg import solveh_banded

from isopeel.assembly.system import System
from isopeel.matrix.band import BandMatrix
from isopeel.matrix.cholesky import BandCholesky, energy
from isopeel.matrix.factor import NotPositiveDefiniteError
from isopeel.matrix.mixed_precision import approximate
from isopeel.problem import strip
from isopeel.splines.rows import row_space


def chain(n: int, differences: int, columns: int) -> BandMatrix:
    """D^T D + 1e-9 of differences D of an order, in a band of some columns: stiff, with soft motions."""
    D = np.diff(np.eye(n), differences, axis=0)
    dense = D.T @ D + 1e-9 * np.eye(n)
    band = np.zeros((n + 1, columns))
    for k in range(differences + 1):
        band[: n - k, k] = np.diag(dense, -k)
    return BandMatrix(band, columns - 1, "symmetric")


@pytest.mark.parametrize(("name", "mesh"), [("N4", (40, 8)), ("L1", (20, 2)), ("L4", (20, 3))])
def test_single_precision_solves_a_tangent_to_its_digits(name: str, mesh: tuple[int, int]) -> None:
    system = System(strip(), row_space(name, mesh))
    u, _ = system.state(np.zeros(system.count), 0.0)
    right_side = np.random.default_rng(0).standard_normal((system.count,))
    matrix = system.linearize(u)[1]
    single = approximate(BandMatrix(matrix.workspace.copy(), matrix.half_bandwidth, "symmetric")).factor
    assert single.values.dtype == np.float32
    found, exact = single.solve(right_side), solveh_banded(matrix.entries.T, right_side, lower=True)
    # condition number about 1e5, times a round-off of 6e-8
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-2 * np.abs(exact).max())
    # scaled by what single precision could not hold
    huge = single.solve(1e200 * right_side)
    np.testing.assert_allclose(huge, 1e200 * found, rtol=1e-5, atol=1e-5 * np.abs(huge).max())
    np.testing.assert_array_equal(single.solve(np.zeros(system.count)), 0.0)


def test_what_elements_joined_without_slopes_do_not_reach_is_left_out() -> None:
    system = System(strip(), row_space("L4", (40, 10)))
    u, _ = system.state(np.zeros(system.count), 0.0)
    matrix = system.linearize(u)[1]
    factor = BandCholesky.of(matrix.entries, np.float64)
    # the unknowns of an element's first x reach to those of its last, the next three to fewer and fewer
    whole = system.count * (matrix.half_bandwidth + 1)
    assert 0.6 * whole < factor.values.size < 0.9 * whole
    right_side = np.random.default_rng(0).standard_normal((system.count,))
    found, exact = factor.solve(right_side), solveh_banded(matrix.entries.T, right_side, lower=True)
    # condition number about 1e5, times a round-off of 1e-16, and as much again for either method's sums
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-9 * np.abs(exact).max())


@pytest.mark.parametrize(("differences", "columns"), [(4, 41), (4, 81)])
def test_what_single_precision_cannot_distinguish_is_kept_in_double(differences: int, columns: int) -> None:
    """Its soft motions have a billionth of the stiffness of others."""
    matrix = chain(300, differences, columns)
    factor = approximate(matrix).factor
    assert factor.values.dtype == np.float64
    x = np.random.default_rng(1).standard_normal((300,))
    D = np.diff(np.eye(300), differences, axis=0)
    solution = factor.solve(D.T @ (D @ x) + 1e-9 * x)
    # condition number 3e11, times a round-off of 1e-16 and the size of x
    np.testing.assert_allclose(solution, x, rtol=0, atol=1e-3)


@pytest.mark.parametrize("n", [1, 7, 8, 9, 63, 64, 200])
@pytest.mark.parametrize("half_bandwidth", [0, 1, 7, 8, 20])
def test_blocks_solve_what_lapack_solves(n: int, half_bandwidth: int) -> None:
    random = np.random.default_rng(n + half_bandwidth)
    columns = random.standard_normal((n, half_bandwidth + 1)) / (half_bandwidth + 1)
    columns[:, 0] = 3 + np.abs(columns[:, 0])
    for k in range(half_bandwidth + 1):
        columns[max(0, n - k) :, k] = 0.0
    x = random.standard_normal(n)
    dense = np.diag(columns[:, 0])
    for k in range(1, min(half_bandwidth + 1, n)):
        dense += np.diag(columns[: n - k, k], k) + np.diag(columns[: n - k, k], -k)
    exact = np.linalg.solve(dense, x)
    # the condition number is of order 10: all but two digits of either precision
    largest = np.abs(exact).max()
    double = BandCholesky.of(columns, np.float64).solve(x)
    np.testing.assert_allclose(double, exact, rtol=0, atol=1e-13 * largest)
    single = BandCholesky.of(columns, np.float32).solve(x)
    np.testing.assert_allclose(single, exact, rtol=0, atol=1e-5 * largest)
    assert energy(columns, x) == pytest.approx(x @ dense @ x, rel=1e-12)


@pytest.mark.parametrize("number", [1, 8, 9, 20])
@pytest.mark.parametrize("pivot", [0.0, -1.0, np.nan])
def test_blocks_name_the_pivot_that_is_not_positive(number: int, pivot: float) -> None:
    columns = np.zeros((20, 4))
    columns[:, 0] = 1.0
    columns[number - 1, 0] = pivot
    with pytest.raises(NotPositiveDefiniteError, match=f"pivot {number} "):
        BandCholesky.of(columns, np.float32)
