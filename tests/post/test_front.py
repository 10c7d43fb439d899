"""The peeling front, on fields whose tractions are known from the law or the material alone."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.optimize import brentq, minimize_scalar

import isopeel
from isopeel import (
    Body,
    Boundary,
    Flat,
    InputError,
    Interface,
    NeoHooke,
    Problem,
    RowSpace,
    VanDerWaals,
    row_space,
    strip,
)
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.paper.figures.front import front_figure
from isopeel.post.fields import sample_side
from isopeel.post.front import (
    FrontProfile,
    ProcessZone,
    beam_decay,
    front_profile,
    layer_decay,
    process_zone,
    process_zones,
)
from isopeel.problem import Traction
from isopeel.problem.shapes.quarter_cylinder import QuarterCylinder
from isopeel.results.fields import StoredState
from isopeel.splines.nurbs import Side, annulus_sector

EQUILIBRIUM = 0.4 / 15 ** (1 / 6)
SLOPE = 0.02
STRETCH = np.array([[1.2, 0.3], [-0.1, 0.9]])
FINE = np.linspace(0, 1, 201)


def van_der_waals(gap: float) -> float:
    """T of a flat substrate, in E0: A_H = 0.05, r0 = 0.4."""
    x = 0.4 / gap
    return float(0.05 / (2 * np.pi * 0.4**3) * (x**9 / 45 - x**3 / 3))


def affine(problem: Problem, space: RowSpace, gradient: FloatArray, centre: float = 0.0) -> FloatArray:
    """Coefficients of u = gradient (X - centre)."""
    shape = problem.body.shape
    return space.weighted(shape).interpolate(
        lambda xi, eta: (shape.evaluate(xi, eta) - [centre, 0.0]) @ gradient.T
    )


def turned(angle: float) -> FloatArray:
    """Q - 1."""
    return np.array([[np.cos(angle) - 1, -np.sin(angle)], [np.sin(angle), np.cos(angle) - 1]])


def lifted(name: str = "L1", points: FloatArray = FINE) -> FrontProfile:
    """A rigid strip turned about x = 100: the gap opens to the right of it at a known slope."""
    problem, space = strip(), row_space(name, (40, 2))
    displacement = affine(problem, space, turned(np.arctan(SLOPE)), 100.0)
    return front_profile(problem, space, displacement, points)


@pytest.mark.parametrize("name", ["L1", "N2.1", "L1+L4"])
def test_a_rigid_straight_face_has_the_tractions_of_the_law(name: str) -> None:
    profile = lifted(name)
    sine = SLOPE / np.hypot(1, SLOPE)
    assert profile.position.shape == (30, 201)  # 150 of 200 nm on 40 elements
    # round-off of lengths up to 200
    np.testing.assert_allclose(profile.position[[0, -1], [0, -1]], [0, 150], atol=1e-11)
    gap = EQUILIBRIUM + sine * (profile.position - 100)
    np.testing.assert_allclose(profile.gap, gap, atol=1e-12)
    held = gap > EQUILIBRIUM  # below it, the law is continued by its tangent
    expected = [van_der_waals(value) for value in gap[held]]
    # round-off of the gap times T' = 3.8
    np.testing.assert_allclose(profile.adhesive_traction[held], expected, atol=1e-11)
    assert np.abs(profile.body_traction).max() < 1e-12  # a rigid motion; E is 1
    # the attraction weakens beyond its peak, at r0/5^(1/6)
    np.testing.assert_array_equal(profile.softening, gap > 0.4 / 5 ** (1 / 6))


def test_the_process_zone_of_a_straight_face_follows_from_the_law() -> None:
    peak = minimize_scalar(van_der_waals, bounds=(0.26, 0.4), method="bounded", options={"xatol": 1e-10})
    near, far = (
        brentq(lambda gap: van_der_waals(gap) - peak.fun / 2, *ends)
        for ends in ((EQUILIBRIUM, peak.x), (peak.x, 1.0))
    )
    zone = process_zone(lifted())
    assert zone is not None
    # a point lies within 0.0125 nm, 2.5e-4 in gap, of the peak, where T'' = 18 E0/nm^2: off by 5.6e-7
    assert zone.peak == pytest.approx(-peak.fun, abs=5.7e-7)
    assert 2000 * zone.peak == pytest.approx(123.6, abs=0.05)  # MPa for E0 = 2 GPa, as published
    sine = SLOPE / np.hypot(1, SLOPE)
    assert zone.position == pytest.approx(100 + (peak.x - EQUILIBRIUM) / sine, abs=0.0126)
    # chords of 5e-4 in gap, T'' (5e-4)^2/8 over T': 117 over 2.1 on the near flank, 1.4 over 0.19 on the far
    # one, where the error of the peak adds 5.6e-7/2 over 0.19; in x 50 times as much, below 1e-4 each
    assert zone.start == pytest.approx(100 + (near - EQUILIBRIUM) / sine, abs=1e-4)
    assert zone.end == pytest.approx(100 + (far - EQUILIBRIUM) / sine, abs=1e-4)
    assert zone.length == pytest.approx((far - near) / sine, abs=2e-4)


def test_the_width_at_half_maximum_of_a_known_bell() -> None:
    position = np.linspace(0, 20, 2001).reshape(29, 69)
    bell = -0.3 / np.cosh((position - 8) / 1.5) ** 2
    places = np.zeros((*position.shape, 2))
    profile = FrontProfile(position, places, places, position, bell, bell, position > 8)
    zone = process_zone(profile)
    assert zone is not None
    # sech^2 is one half at arccosh(sqrt 2); chords over 0.01 of a curve of width 1.5 are off by 1e-5 at most
    half = 1.5 * np.arccosh(np.sqrt(2))
    found = (zone.peak, zone.position, zone.start, zone.end)
    assert found == pytest.approx((0.3, 8.0, 8 - half, 8 + half), abs=1e-5)


def test_the_front_is_found_beside_stretches_that_are_pulled_alike() -> None:
    """As the troughs of a wave that a tape bridges, on both sides of which the law is stiff."""
    position = np.linspace(0, 40, 4001).reshape(1, -1)
    trough, front = (np.exp(-((position - at) ** 2)) for at in (10, 30))
    places = np.zeros((*position.shape, 2))
    zones = []
    for share in (1.02, 0.98):
        tension = -(share * trough + front)
        profile = FrontProfile(position, places, places, position, tension, tension, position > 30)
        zones.append(process_zone(profile))
    for zone in zones:
        assert zone is not None
        # a Gaussian is one half at sqrt(log 2); chords over 0.01 are off by 1e-5 at most
        half = np.sqrt(np.log(2))
        assert (zone.peak, zone.position) == pytest.approx((1.0, 30.0), abs=1e-12)
        assert (zone.start, zone.end) == pytest.approx((30 - half, 30 + half), abs=1e-4)
    # one that is pulled by much more is where the load goes
    tension = -(1.2 * trough + front)
    assert (
        process_zone(FrontProfile(position, places, places, position, tension, tension, position > 30))
        is None
    )


@pytest.mark.parametrize("direction", [1, -1])
def test_a_front_may_open_to_either_side(direction: int) -> None:
    """Rotation the other way: the mirror image, in x = 100."""
    problem, space = strip(adhering_length=200.0), row_space("L1", (40, 2))
    displacement = affine(problem, space, turned(direction * np.arctan(SLOPE)), 100.0)
    zone, right = process_zone(front_profile(problem, space, displacement, FINE)), process_zone(lifted())
    assert zone is not None
    assert right is not None
    near = right.start if direction > 0 else 200 - right.end
    assert zone.start == pytest.approx(near, abs=1e-9)  # round-off
    assert zone.length == pytest.approx(right.length, abs=1e-9)


def raised(height: FloatArray) -> ProcessZone | None:
    """Process zone of the strip whose columns of nodes are lifted by heights (41,)."""
    problem, space = strip(), row_space("L1", (40, 2))
    displacement = np.zeros((space.size, 2))
    displacement[:, 1] = np.tile(height, 3)
    return process_zone(front_profile(problem, space, displacement))


def test_where_nothing_opened_there_is_no_front() -> None:
    x = np.linspace(0, 200, 41)
    peak = 0.4 / 5 ** (1 / 6) - EQUILIBRIUM  # lift at the peak of the attraction
    ramp = np.maximum(x - 100, 0) / 50  # 1 at the end of the adhering part
    bump = np.maximum(1 - np.abs(x - 75) / 25, 0)
    assert raised(np.zeros(41)) is None  # at rest: round-off only
    assert raised(0.9 * peak * ramp) is None  # pulled, not peeled
    assert raised(1.05 * peak * ramp) is None  # past the peak, by less than half the way down
    assert raised(-0.1 * bump) is None  # pressed
    assert raised(0.9 * peak * bump) is None  # pulled in the middle: a peak, but the law stays stiff
    assert raised(np.full(41, 10.0)) is None  # lost: what is left pulls alike everywhere
    assert raised(20 * peak * ramp) is not None


@pytest.mark.parametrize("traction", ["reference", "projected"])
def test_the_adhesive_traction_integrates_to_the_assembled_force(traction: Traction) -> None:
    """At the Gauss points of the assembly the sum over points is its own, so that round-off is left."""
    problem, space = strip(traction=traction), row_space("N2.1", (40, 2))
    displacement = affine(problem, space, turned(0.3), 20.0)  # rigid: no forces but the adhesive ones
    nodes, weights = np.polynomial.legendre.leggauss(space.degree + 1)
    profile = front_profile(problem, space, displacement, (nodes + 1) / 2)
    places = 5 * (np.arange(30)[:, None] + (nodes + 1) / 2)
    np.testing.assert_allclose(profile.position, places, atol=1e-11)  # round-off of lengths up to 150
    force = np.sum(profile.adhesive_traction @ weights) * 5 / 2  # elements of 5 nm
    assembled = System(problem, space).equilibrium(displacement).forces.sum(axis=0)
    # the lower face dips by 6 nm at its left end: tractions up to 23 on 20 nm, of which digits are lost
    np.testing.assert_allclose(-assembled, [0.0, force], atol=1e-10)
    assert abs(force) > 1


def test_a_projected_traction_acts_on_the_projected_area() -> None:
    problem, space = strip(), row_space("L2", (8, 2))
    projected = problem.changed(adhesion=replace(problem.adhesion, traction="projected"))
    displacement = affine(problem, space, np.array([[0.25, 0.3], [0.0, -0.1]])) + np.array([0.0, 0.05])
    plain, other = (front_profile(p, space, displacement) for p in (problem, projected))
    # n_o . F^-T N = -F_11/J on the flat lower face; F_11 = 1.25, J = 1.25 0.9
    np.testing.assert_allclose(other.adhesive_traction, plain.adhesive_traction / 0.9, rtol=1e-12)
    assert np.abs(plain.adhesive_traction).min() > 0.01


def first_piola_kirchhoff(F: FloatArray) -> FloatArray:
    """E = 1, nu = 0.2: mu = 1/2.4, lambda = 0.2/0.72."""
    inverse = np.linalg.inv(F).T
    stress: FloatArray = (F - inverse) / 2.4 + 0.2 / 0.72 * np.log(np.linalg.det(F)) * inverse
    return stress


def test_the_body_traction_of_a_homogeneous_deformation() -> None:
    shape = annulus_sector(10.0, 20.0, 2.0)
    for part in ((0.0, 1.0), (0.3, 0.9)):
        problem = strip().changed(
            body=Body(shape, NeoHooke(1.0, 0.2)),
            adhesion=Interface(Boundary("body", "bottom", *part), VanDerWaals(0.05, 0.4), Flat(-30.0)),
        )
        space = row_space("N3", (5, 2))
        profile = front_profile(problem, space, affine(problem, space, STRETCH - np.eye(2)))
        ends = shape.boundary("bottom").evaluate(part)
        # the inner arc runs clockwise from the angle 2, and its outward normal points to the origin
        begin, end = 10 * (2.0 - np.arctan2(ends[:, 1], ends[:, 0]))
        np.testing.assert_allclose(profile.position[[0, -1], [0, -1]], [begin, end], atol=1e-12)
        angle = 2.0 - profile.position / 10
        normal = -np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        expected = normal @ first_piola_kirchhoff(STRETCH)[1]
        np.testing.assert_allclose(profile.body_traction, expected, atol=1e-12)  # round-off, E is 1
        np.testing.assert_allclose(profile.gap, 30 - (10 * normal @ STRETCH.T)[..., 1], atol=1e-12)


@pytest.mark.parametrize("side", ["left", "right", "bottom", "top"])
def test_fields_along_each_side(side: Side) -> None:
    shape = annulus_sector(10.0, 20.0, 2.0)
    problem, space = strip().changed(body=Body(shape, NeoHooke(1.0, 0.2))), row_space("N3", (5, 2))
    along = np.array([[0.0, 0.1, 0.2], [0.6, 0.7, 0.8]])
    fields = sample_side(problem, space, affine(problem, space, STRETCH - np.eye(2)), side, along)
    X = shape.boundary(side).evaluate(along)
    radial = X / np.linalg.norm(X, axis=-1, keepdims=True)
    clockwise = np.stack([radial[..., 1], -radial[..., 0]], axis=-1)
    outwards = {"left": -clockwise, "right": clockwise, "bottom": -radial, "top": radial}
    # round-off of a few hundred operations
    np.testing.assert_allclose(fields.normal, outwards[side], atol=1e-13)
    np.testing.assert_allclose(fields.position, X @ STRETCH.T, atol=1e-12)
    np.testing.assert_allclose(fields.deformation_gradient - STRETCH, 0, atol=1e-12)
    np.testing.assert_allclose(fields.nominal_stress - first_piola_kirchhoff(STRETCH), 0, atol=1e-12)


def test_the_decay_of_a_beam_on_springs() -> None:
    decay = beam_decay(strip())
    assert decay is not None
    # T'(r_eq) = A_H/(2 pi r0^4) (15^(2/3) - 15^(5/3)/5), E'I = 1/(1 - 0.2^2) 10^3/12
    stiffness = -0.05 / (2 * np.pi * 0.4**4) * (15 ** (2 / 3) - 15 ** (5 / 3) / 5)
    assert decay.length == pytest.approx((4 / 0.96 * 1000 / 12 / stiffness) ** 0.25, rel=1e-12)
    assert decay.length == pytest.approx(3.1, abs=0.01)  # nm, a third of the height: hardly a beam
    assert decay.wavelength / decay.length == pytest.approx(2 * np.pi, rel=1e-12)


def test_the_decay_of_a_layer_between_its_limits() -> None:
    stiff, soft = (
        strip(law=VanDerWaals(hamaker_constant=factor * 0.05, equilibrium_distance=0.4))
        for factor in (1e9, 1e-9)
    )
    rigid, beam, layer = layer_decay(stiff), beam_decay(soft), layer_decay(soft)
    assert rigid is not None
    assert beam is not None
    assert layer is not None
    # the classical root of sin(2z) + 2z = 0: 2z = 4.21239 + 2.25073 i; h = 10, half a unit of the last digit
    assert 20 / rigid.length == pytest.approx(4.21239, abs=5e-6)
    assert 40 * np.pi / rigid.wavelength == pytest.approx(2.25073, abs=5e-6)
    # both tend to the beam as the square root of k h/E', 6e-5 here
    assert layer.length == pytest.approx(beam.length, rel=6e-5)
    assert layer.wavelength == pytest.approx(beam.wavelength, rel=6e-5)


@pytest.mark.parametrize(("hamaker_constant", "spaced"), [(0.05, 27.88), (0.0005, 35.39)])
def test_a_slightly_turned_strip_decays_like_a_layer(hamaker_constant: float, spaced: float) -> None:
    """Far from its end, where the zeros of the beam on springs are 2.9 and 1.15 times too close."""
    problem = strip(law=VanDerWaals(hamaker_constant, 0.4))
    decay = layer_decay(problem)
    assert decay is not None
    space = row_space("N2.1", (100, 5), across_degree=2)
    (step,) = isopeel.trace(problem, space, [1e-4])
    profile = front_profile(problem, space, step.displacement)
    x, T = profile.position.ravel(), profile.adhesive_traction.ravel()
    k = np.flatnonzero(T[:-1] * T[1:] < 0)
    zeros = x[k] - T[k] * np.diff(x)[k] / np.diff(T)[k]
    # 30 nm from the end of the adhering part, the next root of the layer has died out
    first, second, third = zeros[zeros < 120][-3:]
    largest = [np.abs(T[(x > a) & (x < b)]).max() for a, b in ((first, second), (second, third))]
    assert decay.wavelength / 2 == pytest.approx(spaced, abs=0.005)
    # elements of 2 nm are off by 2e-4
    assert third - second == pytest.approx(decay.wavelength / 2, rel=5e-4)
    assert second - first == pytest.approx(decay.wavelength / 2, rel=5e-4)
    assert largest[0] / largest[1] == pytest.approx(np.exp(-decay.wavelength / 2 / decay.length), rel=1e-3)


def test_other_problems_have_no_decay() -> None:
    curved = strip().changed(body=Body(annulus_sector(10.0, 20.0, 1.0), NeoHooke(1.0, 0.2)))
    assert beam_decay(curved) is None
    assert layer_decay(curved) is None


def texts(figure: Figure) -> list[str]:
    return [text.get_text() for axes in figure.axes for text in axes.texts if text.get_text()]


def test_the_figure_shows_the_profiles_and_the_zone() -> None:
    profiles = {name: lifted(name, np.linspace(0, 1, 21)) for name in ("L1", "L2", "L4")}
    figure = front_figure(profiles, 5.0)
    zone = process_zone(profiles["L4"])
    assert zone is not None
    assert texts(figure) == [f"process zone\n{zone.length:.2f} nm", "element\n5 nm"]
    first, body, less, imbalance = figure.axes
    # a zero line, and a line for each space; the coarsest has no difference from the finest
    assert [len(axes.lines) for axes in figure.axes] == [4, 4, 3, 4]
    x, tension = np.asarray(first.lines[2].get_xydata(), dtype=np.float64).T
    broken = np.isnan(x)
    assert broken.sum() == 30  # after each element
    np.testing.assert_allclose(x[~broken], profiles["L4"].position.ravel() - zone.position)
    # MPa, the published peak; a point lies within 0.125 nm of it, 0.0025 in gap: 2000 18 0.0025^2/2 and 0.05
    assert np.nanmax(tension) == pytest.approx(123.6, abs=0.17)
    # rigid motions: no stress in the body, so that the imbalance is the adhesion with its sign changed
    assert np.nanmax(np.abs(np.asarray(body.lines[0].get_ydata()))) < 1e-8
    np.testing.assert_allclose(np.asarray(imbalance.lines[2].get_ydata()), -tension, atol=1e-8)
    assert np.nanmax(np.abs(np.asarray(less.lines[0].get_ydata()))) < 1e-8


def test_bad_input_is_named() -> None:
    problem, space = strip(), row_space("L1", (8, 2))
    rest = np.zeros((space.size, 2))
    for points in ([0.5], [0.0, 1.1], [0.5, 0.5], [-0.1, 0.3]):
        with pytest.raises(InputError, match="points"):
            front_profile(problem, space, rest, np.array(points))
    with pytest.raises(InputError, match="displacement"):
        front_profile(problem, space, np.zeros((3, 2)))
    still = front_profile(problem, space, rest)
    with pytest.raises(InputError, match="three or more"):
        front_figure({"L1": still}, 1.0)
    with pytest.raises(InputError, match="needs a front"):
        front_figure(dict.fromkeys(("L1", "L2", "L4"), still), 1.0)


@pytest.mark.parametrize("space", ["N2.1", "L1+N2.1", "N4"])
def test_zones_of_many_states_are_those_of_their_profiles(space: str) -> None:
    """By one matrix, on the same points; a quarter cylinder has weights."""
    strip_space = isopeel.row_space(space, (60, 2))
    cylinder = QuarterCylinder(200.0).surface()
    round_space = isopeel.row_space("N2", (60, 6), 2, (200, 200))
    flat = isopeel.strip()
    contact = flat.changed(
        body=replace(flat.body, shape=cylinder),
        adhesion=replace(flat.adhesion, boundary=flat.body.side("bottom", end=0.5)),
    )
    for problem, on in ((flat, strip_space), (contact, round_space)):
        rng = np.random.default_rng(3)
        lifted = np.zeros((on.size, 2))
        first = on.rows[0].size
        lifted[:first, 1] = 1.5 * np.linspace(0, 1, first) ** 2 + 1e-3 * rng.random(first)
        states = [StoredState(1, 1.0, 0 * lifted), StoredState(2, 2.0, lifted)]
        zones = process_zones(problem, on, states)
        profiles = {one.step: process_zone(front_profile(problem, on, one.displacement)) for one in states}
        assert [at for at, zone in profiles.items() if zone is not None] == list(zones)
        assert 2 in zones
        for at, zone in zones.items():
            expected = profiles[at]
            assert expected is not None
            assert (zone.peak, zone.position, zone.start, zone.end) == pytest.approx(
                (expected.peak, expected.position, expected.start, expected.end), rel=1e-9
            )
