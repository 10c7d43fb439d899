"""Spline spaces against scipy.interpolate, and against what holds for every one of them."""

import numpy as np
import pytest
from hypothesis import given, settings
from random_splines import points_in, seeds, spaces
from scipy.interpolate import BSpline, make_interp_spline

from isopeel.common.errors import InputError
from isopeel.splines.space import SplineSpace

few = settings(deadline=None, max_examples=60)


@few
@given(spaces(), seeds)
def test_basis_and_derivatives_agree_with_scipy(space: SplineSpace, seed: int) -> None:
    points = points_in(space, seed)
    reference = BSpline(space.knot_vector, np.eye(space.size), space.degree)
    for derivative in range(space.degree + 1):
        expected = reference(points, nu=derivative)
        # A derivative multiplies round-off as much as it does the functions, so errors scale with its size.
        error = np.abs(space.collocation(points, derivative).toarray() - expected).max()
        assert error <= 1e-12 * np.abs(expected).max()


@few
@given(spaces(), seeds)
def test_functions_are_nonnegative_and_sum_to_one(space: SplineSpace, seed: int) -> None:
    values, first = space.basis(points_in(space, seed), space.degree + 2)
    assert values[0].min() >= 0  # exactly: the recursion multiplies and adds nonnegative numbers only
    assert np.abs(values[0].sum(axis=1) - 1).max() < 1e-14  # a few roundings per degree
    # The sum of derivatives cancels numbers of their size.
    for derivative in values[1:]:
        assert np.abs(derivative.sum(axis=1)).max() <= 1e-13 * np.abs(derivative).max()
    assert not values[space.degree + 1 :].any()
    assert first.min() >= 0
    assert first.max() + space.degree < space.size


@few
@given(spaces())
def test_continuity_at_breakpoints_is_degree_minus_multiplicity(space: SplineSpace) -> None:
    for k, continuity in enumerate(space.continuities):
        seen_from = np.array([k, k + 1])
        values, first = space.basis(np.repeat(space.breakpoints[k + 1], 2), space.degree, elements=seen_from)
        dense = np.zeros((space.degree + 1, 2, space.size))
        for side in (0, 1):
            dense[:, side, first[side] : first[side] + space.degree + 1] = values[:, side]
        jumps = np.abs(dense[:, 1] - dense[:, 0]).max(axis=1) / np.abs(dense).max(axis=(1, 2))
        assert jumps[: continuity + 1].max() < 1e-12  # round-off against the size of the derivative
        # The first free derivative jumps by a share of its size that only falls with degree and width ratio.
        assert jumps[continuity + 1] > 1e-6


@few
@given(spaces(), seeds)
def test_functions_vanish_outside_their_support(space: SplineSpace, seed: int) -> None:
    points = points_in(space, seed)
    values = space.collocation(points).toarray()
    for function in range(space.size):
        start, end = space.support(function)
        assert not values[(points < start) | (points > end), function].any()
        inside = values[(points > start) & (points < end), function]
        assert np.all(inside > 0)


@few
@given(spaces(), seeds)
def test_interpolation_at_greville_points_agrees_with_scipy(space: SplineSpace, seed: int) -> None:
    values = np.random.default_rng(seed).normal(size=(space.size, 2, 3))
    expected = make_interp_spline(space.greville, values, space.degree, space.knot_vector).c
    condition = np.linalg.cond(space.collocation(space.greville).toarray())
    # Both solve the same linear equations, so they differ by round-off times their condition number.
    error = np.abs(space.interpolate(values) - expected).max()
    assert error <= 1e-14 * condition * np.abs(expected).max()


@few
@given(spaces(), seeds)
def test_polar_form_is_symmetric_and_the_polynomial_on_its_diagonal(space: SplineSpace, seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = points_in(space, seed)
    elements = space.element_of(points)
    diagonal = space.polar_weights(np.repeat(points[:, None], space.degree, axis=1), elements)
    assert np.abs(diagonal - space.basis(points)[0][0]).max() < 1e-15  # the same operations
    widths = np.diff(space.breakpoints)[elements, None]
    arguments = space.breakpoints[elements, None] + widths * rng.uniform(size=(points.size, space.degree))
    swapped = space.polar_weights(arguments[:, rng.permutation(space.degree)], elements)
    # Arguments inside the element make convex combinations: round-off is that of numbers below 1.
    assert np.abs(space.polar_weights(arguments, elements) - swapped).max() < 1e-14


@pytest.mark.parametrize(("degree", "continuity"), [(1, 0), (2, 0), (2, 1), (3, 1), (5, 3), (8, 7)])
def test_uniform_space_has_the_published_number_of_functions(degree: int, continuity: int) -> None:
    space = SplineSpace.uniform(degree, continuity, 200)
    assert space.size == 199 * (degree - continuity) + degree + 1
    assert space.elements == 200
    assert set(space.continuities) == {continuity}
    assert np.array_equal(space.first_functions, np.arange(200) * (degree - continuity))
    assert space.breakpoints[100] == 0.5


def test_greville_points_reproduce_the_parameter() -> None:
    space = SplineSpace.uniform(4, 2, 9)
    points = np.linspace(0, 1, 50)
    # Sum of Greville points times functions is the identity (Marsden); a few roundings of numbers below 1.
    assert np.abs(space.collocation(points) @ space.greville - points).max() < 1e-15
    ends = SplineSpace(3, np.array([0.1] * 4 + [0.7] * 4)).greville[[0, -1]]
    assert np.array_equal(ends, [0.1, 0.7])  # exactly, though three times 0.1 over 3 is above 0.1


def test_elements_are_half_open_and_the_last_is_closed() -> None:
    space = SplineSpace(2, np.array([0, 0, 0, 1, 1, 3, 4, 4, 4]))
    assert space.element_of([[0, 0.5, 1], [3, 3.5, 4]]).tolist() == [[0, 0, 1], [2, 2, 2]]
    assert space.element_of(2.0) == 1
    assert space.multiplicities.tolist() == [3, 2, 1, 3]
    for outside in (-1e-9, 4.1, np.nan):
        with pytest.raises(InputError, match="points lie in"):
            space.basis([1.0, outside])


def test_the_knot_vector_is_a_read_only_copy() -> None:
    knots = np.array([0.0, 0, 1, 1])
    space = SplineSpace(1, knots)
    knots[2:] = 5
    assert space.knot_vector.tolist() == [0, 0, 1, 1]
    for array in (space.knot_vector, space.breakpoints, space.greville):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 2


@pytest.mark.parametrize(
    ("degree", "knots", "message"),
    [
        (0, [0, 1], "degree: 0 cannot be used; it must be 1 to 30"),
        (31, [0] * 32 + [1] * 32, "degree: 31"),
        (1, [0, 0, 1], "at least 4 knots"),
        (1, [[0, 0, 1, 1]], "shape \\(1, 4\\)"),
        (1, [0, 0, 0.5, 0.4, 1, 1], "\\[0.5, 0.4\\] cannot be used; knots must not decrease"),
        (1, [0, 0, np.nan, 1, 1], "finite"),
        (1, [0, 0, np.inf, np.inf], "finite"),
        (1, [0, 0, 0.3, 0.1 + 0.2, 1, 1], "round-off"),
        (2, [0, 0, 0.1, 1, 1, 1], "occur 3 times"),
        (1, [0, 0, 0, 1, 1], "occur 2 times"),
        (1, [0, 0, 0, 0], "occur 2 times"),
        (
            2,
            [0, 0, 0, 0.5, 0.5, 0.5, 1, 1, 1],
            "0.5 cannot be used; an inner knot may occur 2 times at most",
        ),
    ],
)
def test_bad_knot_vectors_are_refused(degree: int, knots: list[float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        SplineSpace(degree, np.array(knots))


def test_bad_arguments_are_refused() -> None:
    with pytest.raises(InputError, match="for degree 2 it must be 0 to 1"):
        SplineSpace.uniform(2, 2, 4)
    with pytest.raises(InputError, match="elements: 0"):
        SplineSpace.uniform(2, 1, 0)
    space = SplineSpace.uniform(2, 1, 4)
    with pytest.raises(InputError, match="it must be 0 to 5"):
        space.support(6)
    with pytest.raises(InputError, match="6 in all"):
        space.interpolate(np.ones(5))
