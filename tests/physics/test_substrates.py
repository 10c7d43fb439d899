"""Curved substrates against closed forms, brute force and finite differences."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from isopeel import FormulaAdhesion, InputError, VanDerWaals, row_space, strip
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion import AdhesionLaw
from isopeel.physics.batch import evaluate_substrate
from isopeel.physics.substrates import Substrate
from isopeel.physics.substrates.circle import Circle, SolidPart
from isopeel.physics.substrates.flat import Flat
from isopeel.physics.substrates.formula import FormulaSubstrate
from isopeel.physics.substrates.wavy import Wavy

CYLINDER = Circle(2.0, "inside", (0.3, -0.2))
HOLE = Circle(2.0, "outside", (0.3, -0.2))
GENTLE = Wavy(height=0.1, amplitude=0.2, wavelength=4.0, phase=0.3)
STEEP = Wavy(height=-0.3, amplitude=2.0, wavelength=1.0, phase=1.9)
AS_FORMULA = "h + a*cos(2*pi*x/l + p)"
ROUGH = FormulaSubstrate("h*sin(x) + 0.1*cos(2.3*x)", {"h": 0.3})


def seen_from(substrate: Substrate, positions: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    return evaluate_substrate(substrate.kernel, substrate.parameters, positions)


def wave_as_formula(wave: Wavy) -> FormulaSubstrate:
    constants = {"h": wave.mean_height, "a": wave.amplitude, "l": wave.wavelength, "p": wave.phase}
    return FormulaSubstrate(AS_FORMULA, constants)


def wave_height(wave: Wavy, x: FloatArray) -> FloatArray:
    height: FloatArray = wave.amplitude * np.cos(2 * np.pi * x / wave.wavelength + wave.phase)
    return wave.mean_height + height


def random_points(x: float, y: float, count: int) -> FloatArray:
    return np.random.default_rng(2).uniform((-x, -y), (x, y), (count, 2))


@pytest.mark.parametrize(("circle", "side"), [(CYLINDER, 1.0), (HOLE, -1.0)])
def test_circle(circle: Circle, side: float) -> None:
    angle = np.linspace(0.1, 6.2, 9)
    direction = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    distance = np.linspace(0.5, 5.0, 9)
    gap, normal, curvature = seen_from(circle, circle.middle + distance[:, None] * direction)
    np.testing.assert_allclose(gap, side * (distance - 2.0), rtol=0, atol=1e-15)  # round-off
    np.testing.assert_allclose(normal, side * direction, rtol=0, atol=1e-15)
    assert curvature.tolist() == [side / 2.0] * 9


@pytest.mark.parametrize(
    "substrate", [CYLINDER, HOLE, GENTLE, STEEP, ROUGH], ids=["cylinder", "hole", "gentle", "steep", "rough"]
)
def test_gap_and_normal_change_as_the_assembly_assumes(substrate: Substrate) -> None:
    """d gap/dx = n and dn/dx = k/(1 + k gap) t (x) t, on both sides of the surface."""
    # points at given gaps from the surface: first on it, then along its normal
    on_surface = random_points(2.0, 2.0, 60)
    for _ in range(3):
        gap, normal, _ = seen_from(substrate, on_surface)
        on_surface = on_surface - gap[:, None] * normal
    gap, normal, curvature = seen_from(substrate, on_surface)
    assert np.abs(gap).max() < 1e-14  # round-off
    share = np.linspace(-0.4, 0.6, len(gap))
    radius = np.minimum(1 / np.abs(curvature), 0.5 if substrate is not STEEP else 0.01)
    positions = on_surface + (share * radius)[:, None] * normal
    gap, normal, curvature = seen_from(substrate, positions)
    np.testing.assert_allclose(gap, share * radius, rtol=0, atol=1e-14)  # round-off
    assert np.abs(np.linalg.norm(normal, axis=1) - 1).max() < 1e-15
    turn = curvature / (1 + curvature * gap)
    step = 1e-6 * radius
    for k in range(2):
        change = np.zeros_like(positions)
        change[:, k] = step
        ahead, behind = seen_from(substrate, positions + change), seen_from(substrate, positions - change)
        # central differences of functions that vary over a length `radius`: 1e-12 of truncation, 1e-15/step
        tolerance = 1e-9 / radius.min()
        rise = (ahead[0] - behind[0]) / (2 * step)
        np.testing.assert_allclose(rise, normal[:, k], rtol=0, atol=tolerance)
        tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=-1)
        expected = (turn * tangent[:, k])[:, None] * tangent
        difference = (ahead[1] - behind[1]) / (2 * step[:, None])
        np.testing.assert_allclose(difference, expected, rtol=0, atol=tolerance * max(1, np.abs(turn).max()))


def closest_by_search(wave: Wavy, x: float, y: float) -> float:
    """Distance to a wave: the best of all minima among samples as far as the closest point can be."""

    def square(s: FloatArray) -> FloatArray:
        distance: FloatArray = (s - x) ** 2 + (wave_height(wave, s) - y) ** 2
        return distance

    reach = float(np.sqrt(square(np.array(x))))
    places = np.linspace(x - reach, x + reach, 40_001)
    values = square(places)
    minima = 1 + np.flatnonzero((values[1:-1] <= values[:-2]) & (values[1:-1] <= values[2:]))
    best = minima[np.argsort(values[minima])[:4]]
    found = [
        minimize_scalar(
            square, bounds=(places[k - 1], places[k + 1]), method="bounded", options={"xatol": 1e-13}
        )
        for k in best
    ]
    return float(np.sqrt(min(result.fun for result in found)))


@pytest.mark.parametrize("span", [0.5, 2.0, 30.0])
@pytest.mark.parametrize("amplitude", [0.0, 0.02, 0.3, 2.0])
def test_no_point_of_a_wave_is_closer(amplitude: float, span: float) -> None:
    """Also far beyond the centres of curvature of crests and troughs, where many minima compete."""
    wave = Wavy(height=0.1, amplitude=amplitude, wavelength=1.0, phase=0.7)
    positions = random_points(3.0, amplitude + span, 25)
    gap, normal, _ = seen_from(wave, positions)
    expected = [closest_by_search(wave, x, y) for x, y in positions]
    # the search ends when the distance, at most 60, no longer changes; its square root loses digits near 0
    np.testing.assert_allclose(np.abs(gap), expected, rtol=0, atol=1e-10)
    above = positions[:, 1] > wave_height(wave, positions[:, 0])
    assert (np.sign(gap) == np.where(above, 1, -1)).all()
    foot = positions - gap[:, None] * normal
    np.testing.assert_allclose(foot[:, 1], wave_height(wave, foot[:, 0]), rtol=0, atol=1e-12)  # round-off
    if span <= 2.0:  # up to four widths of a crest or trough
        for ours, general in zip((gap, normal), seen_from(wave_as_formula(wave), positions)[:2], strict=True):
            # two ways to the same minimum, to which the distance is flat
            np.testing.assert_allclose(ours, general, rtol=0, atol=1e-11)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_circle_as_a_formula(sign: float) -> None:
    """A half circle is a graph: the cylinder from above, the hole with its lower half."""
    circle = Circle(2.0, "inside" if sign > 0 else "outside", (0.0, 0.0))
    graph = FormulaSubstrate("s*sqrt(R**2 - x**2)", {"R": 2.0, "s": sign})
    angle = sign * np.linspace(0.8, 2.3, 11)
    distance = np.linspace(1.7, 2.5 if sign > 0 else 2.2, 11)
    positions = distance[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    for ours, exact in zip(seen_from(graph, positions), seen_from(circle, positions), strict=True):
        np.testing.assert_allclose(ours, exact, rtol=0, atol=1e-13)  # round-off


@pytest.mark.parametrize(("x", "y"), [(0.4, 6.0), (-0.01, 9.0), (3.0, -2.0), (0.0, 0.5), (2.0, 2.0)])
def test_a_parabola_has_its_closest_point_at_the_root_of_a_cubic(x: float, y: float) -> None:
    """y = x^2/2, radius of curvature 1: from beyond the centre of curvature, three roots are candidates."""
    parabola = FormulaSubstrate("x**2/2")
    roots = np.roots([0.5, 0.0, 1.0 - y, -x])
    places = roots[np.abs(roots.imag) < 1e-7].real
    s = places[np.argmin((places - x) ** 2 + (places**2 / 2 - y) ** 2)]
    gap, normal, curvature = seen_from(parabola, np.array([[x, y]]))
    distance = np.hypot(s - x, s**2 / 2 - y)
    # round-off of the roots
    assert gap[0] == pytest.approx(distance if y > x**2 / 2 else -distance, abs=1e-13)
    np.testing.assert_allclose(normal[0], np.array([-s, 1]) / np.hypot(1, s), rtol=0, atol=1e-13)
    assert curvature[0] == pytest.approx(-((1 + s**2) ** -1.5), rel=1e-13)


def test_above_a_trough_two_points_are_equally_close() -> None:
    wave = Wavy(height=0.0, amplitude=0.5, wavelength=2 * np.pi, phase=np.pi)  # radius 2 in the trough at 0
    below, beyond = np.array([[0.0, 1.4]]), np.array([[0.0, 4.0]])
    gap, normal, curvature = seen_from(wave, below)
    assert gap[0] == pytest.approx(1.9, rel=1e-15)
    np.testing.assert_allclose(normal[0], [0.0, 1.0], atol=1e-15)  # the cosine's own round-off
    assert curvature[0] == pytest.approx(-0.5, rel=1e-15)
    for substrate in (wave, wave_as_formula(wave)):
        gap, normal, _ = seen_from(substrate, beyond)
        foot = beyond - gap[:, None] * normal
        assert abs(foot[0, 0]) > 1.5  # well away from the trough
        mirrored = np.hypot(foot[0, 0], 4.0 - wave_height(wave, -foot[:, 0])[0])
        assert gap[0] == pytest.approx(mirrored, rel=1e-14)  # round-off
        assert gap[0] < 4.5 - 0.2  # and clearly closer than it


def test_points_without_a_closest_point_have_no_gap() -> None:
    """They end in nan, which the solver notices, and none of them takes long."""
    gap, normal, _ = seen_from(HOLE, np.array([HOLE.middle]))
    assert gap[0] == 2.0
    assert np.isnan(normal).all()
    logarithm = FormulaSubstrate("log(x)")
    gap, _, _ = seen_from(logarithm, np.array([[-1.0, 0.0], [0.0, 0.0], [np.nan, 0.0], [2.0, np.inf]]))
    assert np.isnan(gap).all()
    # (1, 0) lies on the curve, and its normal there goes through (1.5, -0.5)
    gap, _, _ = seen_from(logarithm, np.array([[1.0, 0.0], [1.5, -0.5]]))
    np.testing.assert_allclose(gap, [0.0, -np.sqrt(0.5)], rtol=0, atol=1e-15)  # round-off
    assert np.isnan(seen_from(GENTLE, np.array([[np.nan, 0.0]]))[0]).all()


def test_a_wave_is_found_from_very_far() -> None:
    wave = Wavy(height=0.0, amplitude=1.0, wavelength=1.0)
    gap, normal, _ = seen_from(wave, np.array([[0.5, 1e9], [1e6, 3.0], [0.25, -1e12]]))
    # the crest is closest, whatever lies below: the round-off of the positions remains
    np.testing.assert_allclose(gap, [1e9 - 1, 2.0, -1e12 + 1], rtol=1e-15)
    np.testing.assert_allclose(normal, [[0, 1]] * 3, rtol=0, atol=1e-7)


@pytest.mark.parametrize(("height", "width"), [(1.0, 0.25), (10.0, 0.02)])
def test_a_step_is_found(height: float, width: float) -> None:
    """Also a cliff that is much closer than what lies straight below."""
    step = FormulaSubstrate("h*tanh(x/w)", {"h": height, "w": width})
    shares = [(-2.0, 0.2), (-1.5, -0.4), (1.5, 0.1), (4.0, 0.0), (-6.0, 0.9), (-25.0, 0.1), (0.5, 0.7)]
    positions = np.array(shares) * [width, height]
    places = np.sinh(np.linspace(-9, 9, 400_001)) * width / 100
    curve = np.stack([places, height * np.tanh(places / width)], axis=-1)
    gap, _, _ = seen_from(step, positions)
    distances = np.array([np.hypot(*(curve - point).T).min() for point in positions])
    # points d apart on the curve, 6e-4 at most, miss a distance r of 0.007 or more by d^2/(8 r) at most
    assert np.hypot(*np.diff(curve, axis=0).T).max() < 6e-4
    np.testing.assert_allclose(np.abs(gap), distances, rtol=0, atol=1e-5)
    assert (np.sign(gap) == [1, 1, -1, -1, 1, 1, 1]).all()


SOFT = FormulaAdhesion("-W*(1 + r/d)*exp(-r/d)", {"W": 0.01, "d": 0.3})  # the same for any curvature


@pytest.mark.parametrize(
    ("substrate", "law"),
    [
        (Circle(20.0, "inside", (10.0, -20.3)), VanDerWaals(0.05, 0.4)),
        (Circle(100.37, "outside", (10.0, 99.6)), VanDerWaals(0.05, 0.4)),
        (Wavy(0.05, 3.0, 0.4, -0.35), SOFT),
        (FormulaSubstrate("-0.4 + 0.05*sin(2*x) + 0.02*cos(5*x)"), SOFT),
    ],
    ids=["cylinder", "hole", "wave", "formula"],
)
def test_forces_on_a_strip_come_from_its_energy(substrate: Substrate, law: AdhesionLaw) -> None:
    """The residual is the energy's derivative and the tangent the residual's, on each curved substrate."""
    problem = strip(length=20.0, height=2.0, adhering_length=15.0)
    adhesion = replace(problem.adhesion, against=substrate, law=law)
    system = System(problem.changed(adhesion=adhesion), row_space("N2", (8, 2)))
    z, direction = 0.02 * np.random.default_rng(8).standard_normal((2, system.constraints.count))

    def energy_and_residual(step: float) -> tuple[float, FloatArray]:
        state = system.equilibrium(system.constraints.displacement(z + step * direction, 0.02))
        return state.stored_energy + state.adhesive_energy, state.residual

    ahead, behind, here = energy_and_residual(1e-5), energy_and_residual(-1e-5), energy_and_residual(0.0)
    # central differences: the law's third derivative reaches 1e4, the energy has 15 digits
    assert here[1] @ direction == pytest.approx((ahead[0] - behind[0]) / 2e-5, rel=1e-6)
    _, matrix = system.linearize(system.constraints.displacement(z, 0.02), "symmetric")
    # the lower triangle, a column of the matrix in each row, and its mirror image
    n, width = matrix.entries.shape
    change = np.zeros(n)
    for j, column in enumerate(matrix.entries):
        inside = min(width, n - j)
        change[j : j + inside] += column[:inside] * direction[j]
        change[j] += column[1:inside] @ direction[j + 1 : j + inside]
    difference = (ahead[1] - behind[1]) / 2e-5
    np.testing.assert_allclose(change, difference, rtol=0, atol=1e-7 * np.abs(change).max())


@pytest.mark.parametrize("name", ["n", "place", "parameters", "nan"])
def test_constants_do_not_meet_the_names_of_the_kernel(name: str) -> None:
    plain = FormulaSubstrate("b*sin(x)", {"b": 0.3})
    named = FormulaSubstrate(f"{name}*sin(x)", {name: 0.3})
    positions = random_points(2.0, 0.5, 4)
    np.testing.assert_array_equal(seen_from(named, positions)[0], seen_from(plain, positions)[0])


def test_substrates_travel_to_other_processes() -> None:
    for substrate in (CYLINDER, GENTLE, ROUGH):
        assert pickle.loads(pickle.dumps(substrate)) == substrate


@pytest.mark.parametrize(
    "substrate", [Flat(0.2), CYLINDER, HOLE, GENTLE, ROUGH], ids=lambda one: type(one).name
)
def test_a_receded_substrate_is_the_same_one_farther_away(substrate: Substrate) -> None:
    positions = random_points(2.0, 2.0, 40)
    receded = substrate.receded(0.3)
    assert type(receded) is type(substrate)
    assert receded.constant_curvature == substrate.constant_curvature
    gap, normal, curvature = seen_from(substrate, positions)
    if substrate.constant_curvature:
        # a parallel curve: farther by the gap, wherever it is seen from, to round-off
        assert np.ptp(curvature) == 0
        farther, same_normal, _ = seen_from(receded, positions)
        np.testing.assert_allclose(farther, gap + 0.3, rtol=0, atol=1e-15)
        np.testing.assert_array_equal(same_normal, normal)
    else:
        # straight down: what is seen from here was seen from higher up, to the round-off of the positions
        assert np.ptp(curvature) > 0
        moved = seen_from(receded, positions - [0.0, 0.3])
        for ours, expected in zip(moved, (gap, normal, curvature), strict=True):
            np.testing.assert_allclose(ours, expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    "substrate",
    [Flat(), Circle(2.0), Circle(2.0, "outside"), Wavy(0.3, 2.0)],
    ids=["flat", "cylinder", "hole", "wave"],
)
def test_a_substrate_without_a_place_touches_the_origin_from_below(substrate: Substrate) -> None:
    gap, normal, _ = seen_from(substrate, np.array([[0.0, 0.0], [0.0, 0.1]]))
    assert gap.tolist() == [0.0, pytest.approx(0.1, rel=1e-14)]  # round-off
    np.testing.assert_allclose(normal, [[0, 1]] * 2, rtol=0, atol=1e-15)


def test_nothing_is_left_of_a_cylinder_that_recedes_by_its_radius() -> None:
    with pytest.raises(InputError, match=r"substrate\.gap: 2\.0.*radius 0, which must be positive"):
        CYLINDER.receded(2.0)


@pytest.mark.parametrize("radius", [0.0, -1.0, np.inf, np.nan])
def test_circle_refuses_radii(radius: float) -> None:
    with pytest.raises(InputError, match=r"substrate\.radius"):
        Circle(radius, "inside", (0.0, 0.0))


@pytest.mark.parametrize(
    ("centre", "solid", "reason"),
    [
        ((0.0, np.nan), "inside", "two finite coordinates"),
        ((0.0,), "inside", "two finite coordinates"),
        ((0.0, 0.0), "above", "inside or outside"),
    ],
)
def test_circle_refuses_what_is_none(centre: tuple[float, float], solid: SolidPart, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        Circle(1.0, solid, centre)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"height": np.inf}, r"substrate\.height.*finite"),
        ({"phase": np.nan}, r"substrate\.phase.*finite"),
        ({"amplitude": -0.1}, r"substrate\.amplitude.*zero or positive"),
        ({"amplitude": np.nan}, r"substrate\.amplitude.*zero or positive"),
        ({"wavelength": 0.0}, r"substrate\.wavelength.*positive"),
        ({"wavelength": np.inf}, r"substrate\.wavelength.*positive"),
    ],
)
def test_wave_refuses_what_is_none(change: dict[str, float], reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        replace(GENTLE, **change)


@pytest.mark.parametrize(
    ("formula", "reason"),
    [
        ("sqrt(x**2)", "without jumps"),
        ("y + x", "a formula uses"),
        ("__import__('os')", "a formula uses"),
        ("sqrt(c - x**2)", "finite real values"),
        ("x +", "a formula uses"),
    ],
)
def test_a_formula_that_is_no_surface_is_refused(formula: str, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        FormulaSubstrate(formula, {"c": -1.0})


def test_the_place_is_no_constant() -> None:
    with pytest.raises(InputError, match=r"substrate\.constants"):
        FormulaSubstrate("x", {"x": 1.0})
