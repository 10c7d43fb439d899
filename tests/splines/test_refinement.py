"""Knot insertion and elevation against scipy.interpolate and splinepy."""

import numpy as np
import pytest
import splinepy
from hypothesis import given, settings
from hypothesis import strategies as st
from random_splines import new_knots, points_in, seeds, spaces, superfluous_knots
from scipy.interpolate import BSpline

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.splines.refinement import elevate, insert_knots, k_refine
from isopeel.splines.space import SplineSpace

few = settings(deadline=None, max_examples=50)
# Coefficients are of size 1, refined ones are convex combinations of them. Ours are good to a few roundings
# per degree; splinepy goes through Bezier pieces and removes knots, and is seen to lose two digits.
TOLERANCE = 1e-12


def coefficients_of(space: SplineSpace, seed: int) -> FloatArray:
    return np.random.default_rng(seed).uniform(-1, 1, (space.size, 2))


def peer(space: SplineSpace, coefficients: FloatArray) -> splinepy.BSpline:
    return splinepy.BSpline([space.degree], [space.knot_vector], coefficients)


@few
@given(spaces(), seeds)
def test_insertion_agrees_with_scipy_and_splinepy(space: SplineSpace, seed: int) -> None:
    coefficients, knots = coefficients_of(space, seed), new_knots(space, seed)
    refined, result = insert_knots(space, coefficients, knots)

    scipys = BSpline(space.knot_vector, coefficients, space.degree)
    for knot in knots:
        scipys = scipys.insert_knot(knot)
    assert np.array_equal(refined.knot_vector, scipys.t)
    assert np.abs(result - scipys.c[: refined.size]).max() < TOLERANCE

    splinepys = peer(space, coefficients)
    splinepys.insert_knots(0, knots)
    assert np.array_equal(refined.knot_vector, splinepys.knot_vectors[0])
    assert np.abs(result - splinepys.control_points).max() < TOLERANCE


@few
@given(spaces(), seeds, st.integers(1, 3))
def test_elevation_agrees_with_splinepy(space: SplineSpace, seed: int, times: int) -> None:
    coefficients = coefficients_of(space, seed)
    elevated, result = elevate(space, coefficients, times)
    expected = peer(space, coefficients)
    expected.elevate_degrees([0] * times)
    assert elevated.degree == space.degree + times
    assert np.array_equal(elevated.continuities, space.continuities)
    _, result = insert_knots(elevated, result, superfluous_knots(expected, elevated))
    assert np.abs(result - expected.control_points).max() < TOLERANCE


@few
@given(spaces(), seeds, st.integers(0, 4))
def test_refinement_keeps_the_spline(space: SplineSpace, seed: int, times: int) -> None:
    coefficients, points = coefficients_of(space, seed), points_in(space, seed)
    refined, result = k_refine(space, coefficients, times, new_knots(space, seed))
    difference = refined.collocation(points) @ result - space.collocation(points) @ coefficients
    assert np.abs(difference).max() < 1e-14  # values of size 1, a few roundings per degree


def test_refinement_is_exact_at_high_degree_on_a_graded_mesh() -> None:
    # Spans from 6e-8 to 0.4: an algorithm that extrapolates over spans would lose all digits here.
    knots = SplineSpace.uniform(20, 19, 16).knot_vector ** 6
    space = SplineSpace(20, knots)
    coefficients = coefficients_of(space, 1)
    refined, result = k_refine(space, coefficients, 5, [1e-7, 0.01, 0.5, 0.5])
    points = np.linspace(0, 1, 400) ** 6
    difference = refined.collocation(points) @ result - space.collocation(points) @ coefficients
    assert np.abs(difference).max() < 1e-14  # values of size 1


def test_insertion_is_local() -> None:
    space = SplineSpace.uniform(3, 2, 20)
    coefficients = coefficients_of(space, 2)
    refined, result = insert_knots(space, coefficients, 0.52)
    # In element 10 of 20, functions 10 to 13 are active: the others keep their coefficients to the last bit.
    assert np.array_equal(result[:11], coefficients[:11])
    assert np.array_equal(result[14:], coefficients[13:])
    assert refined.size == space.size + 1


@pytest.mark.parametrize("times", [1, 2, 3])
def test_k_refinement_has_full_continuity_at_new_knots_only(times: int) -> None:
    space = SplineSpace.uniform(2, 1, 2)
    refined, _ = k_refine(space, coefficients_of(space, 3), times, [0.25, 0.75])
    assert refined.continuities.tolist() == [1 + times, 1, 1 + times]
    other_order, _ = elevate(*insert_knots(space, coefficients_of(space, 3), [0.25, 0.75]), times)
    assert other_order.continuities.tolist() == [1, 1, 1]
    assert other_order.size == refined.size + 2 * times


def test_bad_arguments_are_refused() -> None:
    space = SplineSpace.uniform(2, 1, 2)
    for knot in (0.0, 1.0, -1.0, np.nan):
        with pytest.raises(InputError, match="inside \\(0, 1\\)"):
            insert_knots(space, np.ones(4), [0.3, knot])
    with pytest.raises(InputError, match="occur 2 times at most"):
        insert_knots(space, np.ones(4), [0.5, 0.5])
    with pytest.raises(InputError, match="times: -1"):
        elevate(space, np.ones(4), -1)
    with pytest.raises(InputError, match="must have the 4 functions"):
        k_refine(space, np.ones(3), 1, 0.3)
    with pytest.raises(InputError, match="must have the 4 functions"):
        insert_knots(space, np.ones(3), 0.3)
