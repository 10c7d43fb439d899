"""Graded meshes: geometric series of element sizes, uniform ones to the last bit."""

from itertools import pairwise

import numpy as np
import pytest

from isopeel.common.errors import InputError
from isopeel.splines.rows import row_space
from isopeel.splines.space import SplineSpace


@pytest.mark.parametrize("name", ["L1", "L4", "N4", "N2.1", "L1+H3", "N2+N4@2"])
@pytest.mark.parametrize("across_degree", [1, 2])
def test_a_grading_of_one_is_the_uniform_mesh_to_the_last_bit(name: str, across_degree: int) -> None:
    elements = (7, 3)
    for space in (
        row_space(name, elements, across_degree),
        row_space(name, elements, across_degree, grading=(1.0, 1.0)),
    ):
        # inner knots k/n as correctly rounded quotients, written out here once more
        for row in (*space.rows, space.across):
            count = elements[1] if row is space.across else elements[0]
            repeats = row.multiplicities[1] if count > 1 else 0
            inner = np.repeat([k / count for k in range(1, count)], repeats)
            ends = row.degree + 1
            assert np.array_equal(row.knot_vector, [*[0.0] * ends, *inner, *[1.0] * ends])


@pytest.mark.parametrize("grading", [1e-6, 0.1, 0.999999, 1.000001, 8.0, 1e6])
@pytest.mark.parametrize("elements", [2, 5, 200])
def test_element_sizes_are_a_geometric_series(grading: float, elements: int) -> None:
    space = row_space("N2+N4", (elements, elements), 2, grading=(grading, 1 / grading))
    for along, ratio in ((space.rows[0], grading), (space.across, 1 / grading)):
        assert along.breakpoints[[0, -1]].tolist() == [0, 1]
        # numpy's own geometric series, normalized; breakpoints below 1 are good to some of its last digits
        sizes = np.geomspace(1, ratio, elements)
        assert np.abs(np.diff(along.breakpoints) - sizes / sizes.sum()).max() < 1e-14
        # the smallest of these sizes is 6e-8, with that round-off of it
        assert np.diff(along.breakpoints)[-1] / np.diff(along.breakpoints)[0] == pytest.approx(
            ratio, rel=1e-7
        )
    assert all(np.array_equal(row.breakpoints, space.rows[0].breakpoints) for row in space.rows)


def test_a_single_element_has_nothing_to_grade() -> None:
    space = row_space("N2", (1, 1), grading=(5.0, 0.2))
    assert space.rows[0].breakpoints.tolist() == space.across.breakpoints.tolist() == [0, 1]


def test_the_finest_mesh_can_be_graded_most_strongly() -> None:
    for grading in (1e-6, 1e6):
        assert row_space("L1", (100_000, 1), grading=(grading, 1.0)).elements == (100_000, 1)


def test_a_graded_space_interpolates_polynomials_exactly() -> None:
    space = row_space("L2+N4", (6, 3), 2, grading=(20.0, 0.1))
    coefficients = space.interpolate(lambda xi, eta: xi**2 - 3 * xi * eta**2)
    xi = np.random.default_rng(1).uniform(size=40)
    for row, (start, end) in enumerate(pairwise(space.across.breakpoints)):
        eta = np.linspace(start, end, xi.size)
        basis = space.basis(xi, eta, row)
        values = np.sum(basis.values * coefficients[basis.functions], axis=1)
        # values of size 3 through two interpolations, each of condition below 100
        assert np.abs(values - (xi**2 - 3 * xi * eta**2)).max() < 1e-13


@pytest.mark.parametrize("grading", [0.0, -1.0, 1e-7, 1e7, np.inf, np.nan])
def test_gradings_that_make_no_mesh_are_refused(grading: float) -> None:
    for pair in ((grading, 1.0), (1.0, grading)):
        with pytest.raises(
            InputError, match=r"^grading: .* two ratios are needed, each from 1e-06 to 1e\+06"
        ):
            row_space("N2", (4, 4), grading=pair)


def test_spaces_on_breakpoints() -> None:
    space = SplineSpace.on(3, 1, [-2.0, 0.0, 5.0])
    assert space.knot_vector.tolist() == [-2, -2, -2, -2, 0, 0, 5, 5, 5, 5]
    assert space.continuities.tolist() == [1]
    for breakpoints in ([0.0], [0.0, 0.5, 0.5, 1.0], [1.0, 0.0], [0.0, np.nan], [[0.0, 1.0]]):
        with pytest.raises(InputError, match=r"breakpoints: .* in increasing order"):
            SplineSpace.on(2, 0, breakpoints)
    with pytest.raises(InputError, match=r"continuity: 2 .* 0 to 1"):
        SplineSpace.on(2, 2, [0.0, 1.0])
