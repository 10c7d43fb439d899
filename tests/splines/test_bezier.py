"""Bezier cells of splines against the splines, at random places."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from random_splines import seeds, spaces

from isopeel import row_space
from isopeel.common.arrays import FloatArray
from isopeel.splines.bezier import bernstein, curve_cells, product, surface_cells
from isopeel.splines.nurbs import annulus_sector
from isopeel.splines.space import SplineSpace

T = np.linspace(0.0, 1.0, 7)


def values(coefficients: FloatArray) -> FloatArray:
    """Values (n_x, n_y, 7, 7, ...) of cells with coefficients (n_x, n_y, p + 1, q + 1, ...) at T x T."""
    along, across = (bernstein(size - 1, T) for size in coefficients.shape[2:4])
    found: FloatArray = np.einsum("kp,lq,xypq...->xykl...", along, across, coefficients)
    return found


@given(spaces(), seeds)
def test_cells_are_the_curve_also_in_parts_of_elements(space: SplineSpace, seed: int) -> None:
    random = np.random.default_rng(seed)
    coefficients = random.uniform(-1, 1, (space.size, 2))
    inside = random.uniform(space.breakpoints[0], space.breakpoints[-1], 3)
    ends = np.unique(np.concatenate([space.breakpoints, inside]))
    cells = curve_cells(space, coefficients, ends)
    for start, end, cell in zip(ends[:-1], ends[1:], cells, strict=True):
        places = start + (end - start) * T[1:-1]
        expected = space.collocation(places) @ coefficients
        # round-off of up to seven convex combinations; the place is a few bits off, in elements of 1/50
        assert np.abs(bernstein(space.degree, T[1:-1]) @ cell - expected).max() < 1e-12


@given(st.integers(0, 4), st.integers(0, 4), st.integers(0, 4), st.integers(0, 4), seeds)
def test_products_are_products_of_values(p: int, q: int, r: int, s: int, seed: int) -> None:
    random = np.random.default_rng(seed)
    one = random.uniform(-1, 1, (2, 3, p + 1, q + 1, 2))
    other = random.uniform(-1, 1, (2, 3, r + 1, s + 1))
    # round-off of sums of at most 25 numbers below 1
    assert np.abs(values(product(one, other)) - values(one) * values(other)[..., None]).max() < 1e-14
    raised = product(one, np.ones((2, 3, r + 1, s + 1)))
    assert np.abs(values(raised) - values(one)).max() < 1e-14


def test_cells_of_rows_of_their_own_are_the_field() -> None:
    shape = annulus_sector(10.0, 20.0, 2.0)
    space = row_space("L1+N2.1@2", (5, 3), across_degree=2).weighted(shape)
    coefficients = np.random.default_rng(3).uniform(-1, 1, (space.size, 2))
    ends = np.unique([*space.rows[0].breakpoints, 0.31]), space.across.breakpoints
    numerators, denominators = (values(found) for found in surface_cells(space, coefficients, ends))
    assert numerators.shape == (6, 3, 7, 7, 2)
    for i, j in np.ndindex(6, 3):
        xi = ends[0][i] + np.diff(ends[0])[i] * T
        eta = ends[1][j] + np.diff(ends[1])[j] * T
        # the last point of a cell belongs to the next one, whose field is the same there
        x, y = np.meshgrid(xi[:-1], eta, indexing="ij")
        basis = space.basis(x.ravel(), y.ravel(), j)
        expected = np.einsum("nm,nmc->nc", basis.values, coefficients[basis.functions])
        found = numerators[i, j, :-1] / denominators[i, j, :-1, :, None]
        # round-off of convex combinations of numbers below 1, over weights above 0.5
        assert np.abs(found.reshape(-1, 2) - expected).max() < 1e-14
