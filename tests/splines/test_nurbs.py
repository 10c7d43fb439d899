"""NURBS curves and surfaces against splinepy, closed forms, and their own refinements."""

from collections.abc import Callable
from math import pi, sqrt
from typing import Literal

import numpy as np
import pytest
import splinepy
from hypothesis import given, settings
from hypothesis import strategies as st
from random_splines import new_knots, points_in, seeds, spaces, superfluous_knots

from isopeel.common.errors import InputError
from isopeel.splines.nurbs import NurbsCurve, NurbsSurface, Side, annulus_sector, rectangle
from isopeel.splines.space import SplineSpace

few = settings(deadline=None, max_examples=30)
SIDES: tuple[Side, ...] = ("left", "right", "bottom", "top")


def curve_on(space: SplineSpace, seed: int, dimension: int) -> NurbsCurve:
    rng = np.random.default_rng(seed)
    return NurbsCurve(space, rng.uniform(-1, 1, (space.size, dimension)), rng.uniform(0.3, 3, space.size))


def surface_on(xi: SplineSpace, eta: SplineSpace, seed: int, dimension: int = 2) -> NurbsSurface:
    """A unit square of control points, each moved by less than half its distance to the next."""
    rng = np.random.default_rng(seed)
    sizes = (xi.size, eta.size)
    points = np.zeros((*sizes, dimension))
    points[..., 0], points[..., 1] = np.meshgrid(np.arange(sizes[0]), np.arange(sizes[1]), indexing="ij")
    points += rng.uniform(-0.3, 0.3, points.shape)
    return NurbsSurface((xi, eta), points, rng.uniform(0.3, 3, sizes))


def peer(shape: NurbsCurve | NurbsSurface) -> splinepy.NURBS:
    """The same shape in splinepy, which counts control points along xi first."""
    of = (shape.space,) if isinstance(shape, NurbsCurve) else shape.spaces
    axes = tuple(range(len(of)))[::-1]
    return splinepy.NURBS(
        [space.degree for space in of],
        [space.knot_vector for space in of],
        shape.control_points.transpose(*axes, -1).reshape(-1, shape.dimension),
        shape.weights.transpose().reshape(-1, 1),
    )


@few
@given(spaces(), seeds, st.sampled_from([2, 3]))
def test_curve_and_derivatives_agree_with_splinepy(space: SplineSpace, seed: int, dimension: int) -> None:
    curve, points = curve_on(space, seed, dimension), points_in(space, seed)
    expected = [peer(curve).derivative(points[:, None], [order]) for order in range(4)]
    result = curve.derivatives(points, 3)
    for order in range(4):
        # The quotient rule sums products of lower derivatives with those of the weight, each of which
        # grows by degree over width per order; 1e-12 of that growth, as in the test of the basis.
        growth = (10 * space.degree / np.diff(space.breakpoints).min()) ** order
        assert np.abs(result[order] - expected[order]).max() <= 1e-12 * growth
    assert np.array_equal(curve.evaluate(points), result[0])


@few
@given(spaces(4), spaces(4), seeds, st.sampled_from([2, 3]))
def test_surface_and_derivatives_agree_with_splinepy(
    xi_space: SplineSpace, eta_space: SplineSpace, seed: int, dimension: int
) -> None:
    surface = surface_on(xi_space, eta_space, seed, dimension)
    xi = points_in(xi_space, seed, 12)
    eta = np.random.default_rng(seed).permutation(np.resize(points_in(eta_space, seed), xi.size))
    other, places = peer(surface), np.stack([xi, eta], axis=-1)
    jacobian, second = surface.jacobian(xi, eta), surface.second_derivatives(xi, eta)
    rates = [10 * space.degree / np.diff(space.breakpoints).min() for space in surface.spaces]
    size = np.abs(surface.control_points).max()
    for result, orders in (
        (surface.evaluate(xi, eta), [0, 0]),
        (jacobian[..., 0], [1, 0]),
        (jacobian[..., 1], [0, 1]),
        (second[..., 0, 0], [2, 0]),
        (second[..., 0, 1], [1, 1]),
        (second[..., 1, 0], [1, 1]),
        (second[..., 1, 1], [0, 2]),
    ):
        growth = rates[0] ** orders[0] * rates[1] ** orders[1]  # as for curves
        assert np.abs(result - other.derivative(places, orders)).max() <= 1e-12 * size * growth


# Control points of size s and weights up to 3 give convex combinations on both sides, see test_refinement.
def assert_same(shape: NurbsCurve | NurbsSurface, other: splinepy.NURBS) -> None:
    ours = peer(shape)
    size = np.abs(shape.control_points).max()
    assert np.abs(ours.control_points - other.control_points).max() < 1e-12 * size
    assert np.abs(ours.weights - other.weights).max() < 3e-12


@few
@given(spaces(4), spaces(4), seeds, st.sampled_from([0, 1]))
def test_insertion_agrees_with_splinepy(
    xi_space: SplineSpace, eta_space: SplineSpace, seed: int, direction: Literal[0, 1]
) -> None:
    surface = surface_on(xi_space, eta_space, seed)
    knots, other = new_knots(surface.spaces[direction], seed), peer(surface)
    other.insert_knots(direction, knots)
    assert_same(surface.insert_knots(knots, direction), other)


@few
@given(spaces(), seeds, st.integers(1, 3))
def test_elevation_of_curves_agrees_with_splinepy(space: SplineSpace, seed: int, times: int) -> None:
    curve = curve_on(space, seed, 3)
    elevated, other = curve.elevate(times), peer(curve)
    other.elevate_degrees([0] * times)
    assert_same(elevated.insert_knots(superfluous_knots(other, elevated.space)), other)


# Uniform meshes: on others splinepy now and then keeps superfluous knots, and then raises for surfaces.
@pytest.mark.parametrize("direction", [0, 1])
@pytest.mark.parametrize("times", [1, 2])
def test_elevation_of_surfaces_agrees_with_splinepy(times: int, direction: Literal[0, 1]) -> None:
    surface = surface_on(SplineSpace.uniform(3, 1, 3), SplineSpace.uniform(2, 1, 4), 5)
    other = peer(surface)
    other.elevate_degrees([direction] * times)
    assert_same(surface.elevate(times, direction), other)


@few
@given(spaces(4), spaces(4), seeds, st.integers(0, 2))
def test_refinement_keeps_shape_area_and_boundary_length(
    xi_space: SplineSpace, eta_space: SplineSpace, seed: int, times: int
) -> None:
    surface = surface_on(xi_space, eta_space, seed)
    refined = surface.k_refine(times, new_knots(xi_space, seed), 0).elevate(times, 1)
    refined = refined.insert_knots(new_knots(refined.spaces[1], seed), 1)
    xi, eta = points_in(xi_space, seed, 9)[:, None], points_in(eta_space, seed, 9)
    size = np.abs(surface.control_points).max()
    assert np.abs(refined.evaluate(xi, eta) - surface.evaluate(xi, eta)).max() < 1e-14 * size * 3
    assert np.abs(refined.weight_function(xi, eta) / surface.weight_function(xi, eta) - 1).max() < 1e-14
    assert refined.area() == pytest.approx(surface.area(), rel=1e-13)  # the integrals' aim is 1e-14
    for side in SIDES:
        assert refined.boundary(side).length() == pytest.approx(surface.boundary(side).length(), rel=1e-13)


@few
@given(spaces(4), spaces(4), seeds)
def test_area_is_the_integral_of_the_jacobian(
    xi_space: SplineSpace, eta_space: SplineSpace, seed: int
) -> None:
    surface = surface_on(xi_space, eta_space, seed)
    nodes, weights = np.polynomial.legendre.leggauss(100)
    places, factors = [], []
    for space in surface.spaces:
        half = np.diff(space.breakpoints)[:, None] / 2
        places.append((space.breakpoints[:-1, None] + half * (nodes + 1)).ravel())
        factors.append((half * weights).ravel())
    determinants = np.linalg.det(surface.jacobian(places[0][:, None], places[1]))
    # Weights of a ratio of 10 keep the poles away from each element: 100 points integrate to round-off, where
    # 40 leave up to 3e-12.
    assert surface.area() == pytest.approx(abs(factors[0] @ determinants @ factors[1]), rel=1e-12)


@few
@given(spaces(), seeds, st.integers(0, 2), st.sampled_from([2, 3]))
def test_refinement_keeps_curves(space: SplineSpace, seed: int, times: int, dimension: int) -> None:
    curve, points = curve_on(space, seed, dimension), points_in(space, seed)
    knots = new_knots(space, seed)
    for refined in (curve.insert_knots(knots), curve.elevate(times), curve.k_refine(times, knots)):
        # Coordinates are of size 1, weights vary tenfold; a few roundings per degree.
        assert np.abs(refined.evaluate(points) - curve.evaluate(points)).max() < 3e-14
        assert refined.length() == pytest.approx(curve.length(), rel=1e-13)


REFINEMENTS: dict[str, Callable[[NurbsSurface], NurbsSurface]] = {
    "none": lambda shape: shape,
    "insertion": lambda shape: shape.insert_knots([0.1, 0.5, 0.5, 0.77], 0).insert_knots([0.3], 1),
    "elevation": lambda shape: shape.elevate(3, 0).elevate(2, 1),
    "k-refinement": lambda shape: shape.k_refine(2, np.arange(1, 40) / 40, 0).k_refine(1, [0.2, 0.7], 1),
}


@pytest.mark.parametrize("refinement", REFINEMENTS)
@pytest.mark.parametrize(("inner", "outer", "angle"), [(1.0, 2.0, pi / 2), (53.0, 63.0, 2.1), (1e-3, 5, 3.1)])
def test_a_sector_is_exact_however_refined(inner: float, outer: float, angle: float, refinement: str) -> None:
    sector = annulus_sector(inner, outer, angle)
    assert np.ptp(sector.weights) > 0.1
    refined = REFINEMENTS[refinement](sector)
    # Closed forms, to the accuracy that lengths and areas promise, a few times 1e-14.
    assert refined.area() == pytest.approx(angle / 2 * (outer**2 - inner**2), rel=1e-13)
    exact = {"left": outer - inner, "right": outer - inner, "bottom": inner * angle, "top": outer * angle}
    for side in SIDES:
        assert refined.boundary(side).length() == pytest.approx(exact[side], rel=1e-13)
    xi, eta = np.linspace(0, 1, 33)[:, None], np.linspace(0, 1, 7)
    points = refined.evaluate(xi, eta)
    radius = inner + eta * (outer - inner)
    # At 3.1 rad the middle weight is 0.02: control points are 50 radii out, and round-off is theirs.
    extent = np.abs(sector.control_points).max()
    assert np.abs(np.hypot(points[..., 0], points[..., 1]) - radius).max() < 1e-14 * extent
    assert np.abs(points - sector.evaluate(xi, eta)).max() < 1e-14 * extent
    assert np.linalg.det(refined.jacobian(xi, eta)).min() > 0
    turned = np.arctan2(points[..., 1], points[..., 0])
    assert turned[[0, -1], 3] == pytest.approx([angle, 0.0], abs=1e-14)


def test_k_refinement_gives_full_continuity_at_new_knots() -> None:
    surface = annulus_sector(1, 2, 1).insert_knots([0.5], 0).k_refine(2, [0.25, 0.75], 0)
    assert surface.spaces[0].degree == 4
    assert surface.spaces[0].continuities.tolist() == [3, 1, 3]
    rough = NurbsCurve(
        surface.spaces[0], np.random.default_rng(0).normal(size=(10, 2)), surface.weights[:, 0]
    )
    step = 1e-7
    for knot, continuity in ((0.25, 3), (0.5, 1), (0.75, 3)):
        left, right = rough.derivatives([knot - step, knot + step], 4).swapaxes(0, 1)
        size = np.abs(rough.derivatives(np.linspace(0, 1, 99), 4)).max(axis=(1, 2))
        jumps = np.abs(right - left).max(axis=1) / size
        # Across two steps a continuous derivative changes by 2e-7 times a rate that is below 1e2 of its size.
        assert jumps[: continuity + 1].max() < 2e-5
        assert jumps[continuity + 1] > 1e-2


def test_rectangle() -> None:
    strip = rectangle(200, 10)
    assert strip.area() == 2000
    assert [strip.boundary(side).length() for side in SIDES] == [10, 10, 200, 200]
    assert strip.evaluate(0.25, 0.5).tolist() == [50, 5]
    assert strip.jacobian([0.1, 0.9], 0.3).tolist() == [[[200, 0], [0, 10]]] * 2
    assert not strip.second_derivatives(0.1, 0.9).any()


def test_length_of_a_cusp() -> None:
    # (t^2, t^3), t from -1 to 1: two arcs of a semicubical parabola, with a kink in the speed between them.
    points = np.array([[1, -1], [-1 / 3, 1], [-1 / 3, -1], [1, 1]])
    cusp = NurbsCurve(SplineSpace.uniform(3, 2, 1), points, np.ones(4)).insert_knots([0.3])
    assert cusp.length() == pytest.approx(2 * (13 * sqrt(13) - 8) / 27, rel=1e-13)


def test_length_and_area_far_from_the_origin() -> None:
    sector = annulus_sector(1, 2, 1)
    moved = NurbsSurface(sector.spaces, sector.control_points + 1e6, sector.weights)
    # The control points keep 10 digits after the point, and cancel no more than these.
    assert moved.area() == pytest.approx(1.5, rel=1e-9)
    assert moved.boundary("top").length() == pytest.approx(2, rel=1e-9)


def test_length_of_a_straight_line_in_space_and_of_a_point() -> None:
    space = SplineSpace.uniform(2, 1, 2)
    points = np.array([0, 0.1, 0.7, 1])[:, None] * [2, 3, 6]
    assert NurbsCurve(space, points, np.array([1, 5, 0.5, 2])).length() == pytest.approx(7, rel=1e-14)
    assert NurbsCurve(space, np.full((4, 2), 0.1), np.array([1, 5, 0.5, 2])).length() == 0


def test_arrays_broadcast() -> None:
    sector = annulus_sector(1, 2, 1)
    xi, eta = np.linspace(0, 1, 5)[:, None], np.linspace(0, 1, 3)
    assert sector.evaluate(xi, eta).shape == (5, 3, 2)
    assert sector.jacobian(xi, eta).shape == (5, 3, 2, 2)
    assert sector.second_derivatives(xi, eta).shape == (5, 3, 2, 2, 2)
    assert sector.weight_function(xi, eta).shape == (5, 3)
    assert sector.evaluate(0.5, 0.5).shape == (2,)
    assert sector.boundary("top").derivatives(xi, 2).shape == (3, 5, 1, 2)
    for k, m in np.ndindex(5, 3):
        assert np.array_equal(sector.jacobian(xi, eta)[k, m], sector.jacobian(xi[k, 0], eta[m]))


def test_bad_input_is_refused() -> None:
    line, square = SplineSpace.uniform(1, 0, 1), (SplineSpace.uniform(1, 0, 1),) * 2
    for weight in (0.0, -1.0, np.nan, np.inf):
        with pytest.raises(InputError, match="weights must be positive"):
            NurbsCurve(line, np.zeros((2, 2)), np.array([1, weight]))
    with pytest.raises(InputError, match="one per control point is needed, \\(2, 2\\)"):
        NurbsSurface(square, np.zeros((2, 2, 2)), np.ones(4))
    for points in (np.zeros((3, 2)), np.zeros((2, 4)), np.array([[0, 0], [0, np.nan]])):
        with pytest.raises(InputError, match="control_points"):
            NurbsCurve(line, points, np.ones(2))
    with pytest.raises(InputError, match="needed for an area"):
        NurbsSurface(square, np.zeros((2, 2, 3)), np.ones((2, 2))).area()
    with pytest.raises(InputError, match="left, right, bottom, top"):
        rectangle(1, 1).boundary("lower")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="direction: 2"):
        rectangle(1, 1).elevate(1, 2)  # type: ignore[arg-type]
    for length, height, field in ((0, 1, "length"), (1, -1, "height"), (np.nan, 1, "length")):
        with pytest.raises(InputError, match=field):
            rectangle(length, height)
    for inner, outer, angle, field in (
        (0, 1, 1, "inner_radius"),
        (2, 1, 1, "outer_radius"),
        (1, 2, pi, "angle"),
    ):
        with pytest.raises(InputError, match=field):
            annulus_sector(inner, outer, angle)
