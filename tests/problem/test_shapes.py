"""Shapes against circles, closed forms and splinepy."""

from math import cos, inf, nan, pi, sin, sqrt

import numpy as np
import pytest
import splinepy

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.problem.shapes import (
    CurvedStrip,
    HalfCylinder,
    QuarterCylinder,
    Shape,
    Strip,
    TaperedStrip,
)
from isopeel.problem.shapes.base import parameter_at_length
from isopeel.splines.nurbs import NurbsCurve, NurbsSurface, Side, rectangle
from isopeel.splines.rows import RowSpace, row_space
from isopeel.splines.space import SplineSpace

SHAPES: dict[str, Shape] = {
    "strip": Strip(200.0, 10.0),
    "tapered": TaperedStrip(200.0, 10.0, 2.5),
    "down": CurvedStrip(100.0, 10.0, 40.0),
    "up": CurvedStrip(100.0, 10.0, 40.0, "up"),
    "half": HalfCylinder(25.0),
    "quarter": QuarterCylinder(25.0),
}
# Exact values: rectangle, trapezium, sectors of annuli of 2.5 rad, parts of discs.
AREAS = {
    "strip": 2000.0,
    "tapered": 1250.0,
    "down": 2.5 / 2 * (50**2 - 40**2),
    "up": 2.5 / 2 * (40**2 - 30**2),
    "half": pi * 25**2 / 2,
    "quarter": pi * 25**2 / 4,
}
# left, right, bottom, top
LENGTHS = {
    "strip": (10, 10, 200, 200),
    "tapered": (10, 2.5, 200, sqrt(200**2 + 7.5**2)),
    "down": (10, 10, 100, 125),
    "up": (10, 10, 100, 75),
    "half": (25 * pi / 4, 25 * pi / 4, 25 * pi / 2, 50),
    "quarter": (25, 25 * pi / 4, 25 * pi / 4, 25),
}
SIDES: tuple[Side, ...] = ("left", "right", "bottom", "top")
# Where two arcs of one circle meet, the sides have one tangent, and no parametrization has a Jacobian.
SMOOTH_CORNERS = {"half": [(0, 0), (-1, 0)], "quarter": [(-1, 0)]}

shapes = pytest.mark.parametrize("name", SHAPES)


@shapes
def test_area_and_sides_have_their_closed_forms(name: str) -> None:
    surface = SHAPES[name].surface()
    # the integrals' aim is 1e-14 of the extent of control points, here up to three times that of the shape
    assert surface.area() == pytest.approx(AREAS[name], rel=2e-13)
    for side, exact in zip(SIDES, LENGTHS[name], strict=True):
        assert surface.boundary(side).length() == pytest.approx(exact, rel=2e-13)


@shapes
def test_the_jacobian_is_positive_and_integrates_to_the_area(name: str) -> None:
    surface = SHAPES[name].surface()
    # dense at the sides, down to 1e-6 of them
    ends = np.concatenate([[0.0], np.geomspace(1e-6, 0.5, 60)])
    places = np.concatenate([ends, 1 - ends[::-1]])
    determinants = np.linalg.det(surface.jacobian(places[:, None], places)) / AREAS[name]
    corners = SMOOTH_CORNERS.get(name, [])
    for corner in corners:
        assert abs(determinants[corner]) < 1e-14  # round-off of products of size 1
        determinants[corner] = inf
    # it grows at the rate of the curvature away from such a corner, of size 1 to the distance of 1e-6
    assert determinants.min() > (1e-7 if corners else 0.2)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    points = (nodes + 1) / 2
    at_points = np.linalg.det(surface.jacobian(points[:, None], points))
    assert at_points.min() > 0
    # 40 points, with poles of the rational maps well off the square
    assert weights @ at_points @ weights / 4 == pytest.approx(AREAS[name], rel=1e-12)


@shapes
def test_points_agree_with_splinepy(name: str) -> None:
    surface = SHAPES[name].surface()
    peer = splinepy.NURBS(
        [space.degree for space in surface.spaces],
        [space.knot_vector for space in surface.spaces],
        surface.control_points.swapaxes(0, 1).reshape(-1, 2),
        surface.weights.T.reshape(-1, 1),
    )
    places = np.random.default_rng(3).uniform(size=(50, 2))
    expected = peer.evaluate(places)
    size = np.abs(surface.control_points).max()
    assert np.abs(surface.evaluate(*places.T) - expected).max() < 1e-14 * size
    orders = np.stack([peer.derivative(places, [1, 0]), peer.derivative(places, [0, 1])], axis=-1)
    assert np.abs(surface.jacobian(*places.T) - orders).max() < 1e-13 * size


def test_the_strip_is_the_rectangle_to_the_last_bit() -> None:
    strip, expected = Strip(200.0, 10.0).surface(), rectangle(200.0, 10.0)
    assert np.array_equal(strip.control_points, expected.control_points)
    assert np.array_equal(strip.weights, expected.weights)
    assert Strip(200.0, 10.0).adhering_part(150.0) == (0.0, 150.0 / 200.0)
    assert Strip(0.3, 10.0).adhering_part(0.1) == (0.0, 0.1 / 0.3)


def test_faces_of_the_tapered_strip_are_straight() -> None:
    surface, xi = TaperedStrip(200.0, 10.0, 2.5).surface(), np.linspace(0, 1, 9)
    assert np.array_equal(surface.evaluate(xi, 0), np.stack([200 * xi, 0 * xi], axis=-1))
    assert surface.evaluate(xi, 1) == pytest.approx(np.stack([200 * xi, 10 - 7.5 * xi], axis=-1), rel=1e-15)


@pytest.mark.parametrize("bends", ["down", "up"])
@pytest.mark.parametrize("angle", [1e-6, 0.5, pi / 2, 2.5, 3.1])
def test_faces_of_the_curved_strip_are_arcs_from_the_origin(bends: str, angle: float) -> None:
    radius, height = 40.0, 10.0
    shape = CurvedStrip(angle * radius, height, radius, bends)  # type: ignore[arg-type]
    surface, outwards = shape.surface(), 1 if bends == "down" else -1
    points = surface.evaluate(np.linspace(0, 1, 101)[:, None], np.linspace(0, 1, 5))
    arms = points - [0.0, -outwards * radius]
    # a few roundings of coordinates of size 100
    distances = radius + outwards * height * np.linspace(0, 1, 5)
    assert np.abs(np.hypot(arms[..., 0], arms[..., 1]) - distances).max() < 1e-15 * 100
    assert points[0, 0].tolist() == [0, 0]
    assert points[0, -1].tolist() == [0, height]
    end = [radius * sin(angle), -outwards * radius * (1 - cos(angle))]
    assert points[-1, 0] == pytest.approx(end, abs=1e-14 * radius)
    assert surface.jacobian(0, 0)[1, 0] == 0  # along +x
    assert surface.jacobian(0, 0)[0, 0] > 0


def test_a_curved_strip_of_a_large_radius_is_a_strip() -> None:
    # its ends fall by length^2 / (2 radius), not by the round-off of the radius
    surface = CurvedStrip(200.0, 10.0, 1e15).surface()
    assert surface.evaluate([0.0, 1.0], 0).tolist() == [[0, 0], pytest.approx([200, -2e-11], rel=1e-12)]
    assert surface.evaluate(1.0, 1)[1] == pytest.approx(10, rel=1e-11)


@pytest.mark.parametrize("radius", [1.0, 25.0, 1e-3])
def test_cylinders_are_exact_circles_that_touch_the_origin(radius: float) -> None:
    places = np.linspace(0, 1, 201)
    for shape, sides in ((HalfCylinder(radius), SIDES[:3]), (QuarterCylinder(radius), SIDES[1:3])):
        surface = shape.surface()
        for side in sides:
            x, y = surface.boundary(side).evaluate(places).T
            assert np.abs(np.hypot(x, y - radius) - radius).max() < 1e-15 * radius
        top = surface.boundary("top").evaluate(places)
        assert np.abs(top[:, 1] - radius).max() < 1e-15 * radius
    half, quarter = HalfCylinder(radius).surface(), QuarterCylinder(radius).surface()
    assert np.abs(half.evaluate(0.5, 0)).max() < 1e-16 * radius
    assert quarter.evaluate(0, 0).tolist() == [0, 0]
    assert not quarter.evaluate(0, places)[:, 0].any()  # the line of symmetry
    # the half is symmetric about it
    x, y = np.moveaxis(half.evaluate(places[:, None], places), -1, 0)
    assert np.abs(x + x[::-1]).max() < 1e-15 * radius
    assert np.abs(y - y[::-1]).max() < 1e-15 * radius


def displaced(space: RowSpace, coefficients: FloatArray, xi: FloatArray, eta: float) -> FloatArray:
    basis = space.basis(xi, np.full(xi.size, eta), int(space.across.element_of(eta)))
    result: FloatArray = np.einsum("nm,nmc->nc", basis.values, coefficients[basis.functions])
    return result


def error_of_a_rotation(surface: NurbsSurface, space: RowSpace) -> float:
    """Largest error of a rotation by 90 degrees, relative to the size of the body."""
    rotation = np.array([[-1.0, -1.0], [1.0, -1.0]])  # Q - 1
    rational = space.weighted(surface)
    coefficients = rational.interpolate(lambda xi, eta: surface.evaluate(xi, eta) @ rotation.T)
    xi = np.linspace(0, 1, 77)
    errors = [
        displaced(rational, coefficients, xi, eta) - surface.evaluate(xi, eta) @ rotation.T
        for eta in np.linspace(0, 1, 13)
    ]
    return float(np.abs(errors).max() / np.abs(surface.control_points).max())


@shapes
@pytest.mark.parametrize("space", ["N2", "N4", "L2", "N2+N2.1"])
def test_rotations_are_exact_in_spaces_that_are_quadratic_both_ways(name: str, space: str) -> None:
    for grading in ((1.0, 1.0), (4.0, 0.5)):
        rows = row_space(space, (8, 8), across_degree=2, grading=grading)
        # interpolation of numerator and weight, each with a condition number below 100
        assert error_of_a_rotation(SHAPES[name].surface(), rows) < 1e-13


@pytest.mark.parametrize("name", ["strip", "tapered", "down", "up"])
def test_strips_need_no_more_than_linear_functions_across(name: str) -> None:
    assert error_of_a_rotation(SHAPES[name].surface(), row_space("N2", (8, 8))) < 1e-13


@pytest.mark.parametrize("name", ["half", "quarter"])
def test_cylinders_need_quadratic_functions_across(name: str) -> None:
    # Linear interpolation between rows: an error of the second order in their distance.
    coarse, fine = (error_of_a_rotation(SHAPES[name].surface(), row_space("N2", (n, n))) for n in (8, 16))
    assert 1e-4 < coarse < 1e-2
    assert coarse / fine == pytest.approx(4, rel=0.15)


@pytest.mark.parametrize(
    ("shape", "angle", "radius"), [(SHAPES["down"], 2.5, 40), (SHAPES["quarter"], pi / 4, 25)]
)
def test_parameters_of_arc_lengths_have_their_closed_form(shape: Shape, angle: float, radius: float) -> None:
    for part in (1e-9, 1e-3, 0.2, 0.5, 0.77, 1 - 1e-9):
        # On an arc in standard form t/(1 - t) = sin(a/2) / sin((angle - a)/2) at the angle a from its start.
        ahead, behind = sin(part * angle / 2), sin((1 - part) * angle / 2)
        # the integral's aim is 1e-14 of the extent of the control points, three radii
        start, end = shape.adhering_part(part * angle * radius)
        assert start == 0
        assert end == pytest.approx(ahead / (ahead + behind), abs=3e-14)


@pytest.mark.parametrize("part", [1e-6, 1e-3, 0.2, 0.5, 0.77, 1 - 1e-9, 1.0])
def test_the_half_cylinder_adheres_about_its_lowest_point(part: float) -> None:
    shape = HalfCylinder(25.0)
    start, end = shape.adhering_part(part * 25 * pi / 2)
    assert start + end == pytest.approx(1.0, abs=1e-15)  # round-off
    left, right = shape.surface().boundary("bottom").evaluate(np.array([start, end]))
    angle = part * pi / 4  # to either side
    # roundings of coordinates of size 25
    assert left == pytest.approx([-25 * sin(angle), 25 * (1 - cos(angle))], abs=1e-14)
    assert right == pytest.approx([25 * sin(angle), 25 * (1 - cos(angle))], abs=1e-14)


@shapes
def test_shapes_are_held_at_a_straight_side(name: str) -> None:
    shape = SHAPES[name]
    ends = shape.surface().boundary(shape.usual_hold).evaluate([0.0, 1.0])
    length = shape.surface().boundary(shape.usual_hold).length()
    assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(length, rel=1e-13)  # its chord


@shapes
def test_the_whole_lower_side_and_lengths_beyond_it(name: str) -> None:
    shape, total = SHAPES[name], LENGTHS[name][2]
    assert shape.adhering_part(total) == pytest.approx((0.0, 1.0), abs=1e-14)
    for length in (0.0, -1.0, total * (1 + 1e-9), inf, nan):
        with pytest.raises(InputError, match=r"^adhesion.length: .* at most"):
            shape.adhering_part(length)


def test_arc_lengths_of_any_curve() -> None:
    # y = x^2: its length up to x is x sqrt(1 + 4 x^2) / 2 + asinh(2 x) / 4; here with an uneven inner knot.
    parabola = NurbsCurve(SplineSpace.uniform(2, 1, 1), np.array([[0, 0], [0.5, 0], [1, 1]]), np.ones(3))
    parabola = parabola.insert_knots([0.3, 0.9])
    for x in (0.01, 0.3, 0.5, 0.95, 1.0):
        length = x * sqrt(1 + 4 * x**2) / 2 + np.arcsinh(2 * x) / 4
        assert parabola.length(x) == pytest.approx(length, rel=1e-14)
        assert parameter_at_length(parabola, length) == pytest.approx(x, abs=1e-14)
    assert parabola.length(0.0) == 0
    for outside in (-0.1, 1.1, nan):
        with pytest.raises(InputError, match=r"points lie in \[0, 1\]"):
            parabola.length(outside)


def test_bad_shapes_are_refused() -> None:
    for bad in (0.0, -1.0, inf, nan):
        for make, field in (
            (lambda bad: Strip(bad, 1.0), "length"),
            (lambda bad: Strip(1.0, bad), "height"),
            (lambda bad: TaperedStrip(1.0, 1.0, bad), "end_height"),
            (lambda bad: CurvedStrip(1.0, 1.0, bad), "radius"),
            (HalfCylinder, "radius"),
            (QuarterCylinder, "radius"),
        ):
            with pytest.raises(InputError, match=rf"^body\.{field}: .* it must be positive"):
                make(bad)
    with pytest.raises(InputError, match=r"^body\.length: .* below pi radii, 3.1416 L0"):
        CurvedStrip(pi, 0.1, 1.0)
    with pytest.raises(InputError, match=r"^body\.height: .* below the radius, 2 L0"):
        CurvedStrip(1.0, 2.0, 2.0, "up")
    with pytest.raises(InputError, match=r"^body\.bends: 'left' .* down or up"):
        CurvedStrip(1.0, 2.0, 2.0, "left")  # type: ignore[arg-type]
    assert CurvedStrip(1.0, 2.0, 2.0).surface().area() == pytest.approx(0.5 / 2 * (16 - 4), rel=1e-13)
