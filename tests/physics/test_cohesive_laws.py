"""Laws of an opening against quadrature, finite differences, published formulas and their own limits."""

import pickle
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

from isopeel import InputError, NewtonSettings, VanDerWaals, row_space, strip, trace
from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion import AdhesionLaw
from isopeel.physics.adhesion.bilinear import Bilinear
from isopeel.physics.adhesion.dugdale import Dugdale
from isopeel.physics.adhesion.exponential import Exponential
from isopeel.physics.adhesion.lennard_jones import LennardJones
from isopeel.physics.adhesion.trapezoidal import Trapezoidal
from isopeel.physics.batch import evaluate_law
from isopeel.post.closed_form import beam_peeling

S, W = 0.06, 0.015  # the strength and work of the strip's van der Waals law, in its units: nearly
CRITICAL = W / S
Law = LennardJones | Exponential | Bilinear | Trapezoidal | Dugdale
LAWS: dict[str, Law] = {
    "9-3": LennardJones(W, 0.25),
    "12-6": LennardJones(W, 0.25, 12, 6),
    "3.5-1.5": LennardJones(W, 0.25, 3.5, 1.5),
    "exponential": Exponential(S, W),
    "exponential at a gap": Exponential(S, W, 0.2),
    "bilinear": Bilinear(S, W, 0.1),
    "bilinear at a gap": Bilinear(S, W, 0.3, 0.2, 0.2),
    "bilinear, round from the start": Bilinear(S, W, 0.3, 1.0),
    "bilinear, averages wider than half": Bilinear(S, W, 0.8, 0.625),
    "trapezoidal": Trapezoidal(S, W, 0.1, 0.4),
    "trapezoidal, averages meet": Trapezoidal(S, W, 0.3, 0.1, 0.8),
    "trapezoidal, hardly round": Trapezoidal(S, W, 0.2, 0.5, 1e-6, 0.1),
    "dugdale": Dugdale(S, W, 0.2),
    "dugdale without a plateau": Dugdale(S, W, 8 / 9, 0.1),
}
every_law = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS.keys())
#: From compression to where the laws that end have ended.
OPENINGS = np.linspace(-0.1, 0.7, 161) + 1e-4


def law_at(law: AdhesionLaw, opening: FloatArray, curvature: float = 0.0) -> tuple[FloatArray, ...]:
    gap = law.equilibrium_gap + opening
    return evaluate_law(law.kernel, law.parameters, gap, np.full(gap.shape, curvature))


def pull(law: AdhesionLaw) -> Callable[[float], float]:
    return lambda opening: -float(law_at(law, np.array([opening]))[1][0])


def corners(law: Law) -> list[float]:
    """Openings at which a law's formula changes."""
    p = law.parameters
    if isinstance(law, Dugdale):
        return [p[3], p[4], p[3] + p[4]]
    if isinstance(law, Bilinear | Trapezoidal):
        return [kink + width for kink in p[5:] for width in (-p[4], p[4])]
    return []


@every_law
def test_potential_and_derivative_by_finite_differences(law: Law) -> None:
    step = 1e-6
    away = np.array([all(abs(x - corner) > step for corner in (0.0, *corners(law))) for x in OPENINGS])
    openings = OPENINGS[away]
    values = law_at(law, openings)
    ahead, behind = law_at(law, openings + step), law_at(law, openings - step)
    slopes = [(after - before) / (2 * step) for after, before in zip(ahead, behind, strict=True)]
    # third derivatives of potential and traction, 1e3 and 6.5e4 for the 12-6 law, times step^2/6
    np.testing.assert_allclose(slopes[0], -values[1], rtol=0, atol=3e-10)
    np.testing.assert_allclose(slopes[1], values[2], rtol=0, atol=2e-8)


@every_law
def test_potential_traction_and_derivative_have_no_jumps(law: Law) -> None:
    stiffness = -law_at(law, np.array([0.0]))[2][0]
    for corner in (0.0, *corners(law)):
        jumps = [np.ptp(values) for values in law_at(law, corner + np.array([-1e-12, 1e-12]))]
        # what the law may change by over such an opening, and round-off
        assert jumps[0] < 2.1e-12 * S + 1e-16
        assert jumps[1] < 1e-11 * stiffness
        # where averages are over 1.3e-7 only, the slope turns by 1.5e-5 of it over so short an opening
        assert jumps[2] < 5e-5 * stiffness


@every_law
def test_work_of_adhesion_is_the_integral_of_the_attraction(law: Law) -> None:
    ends = [0.0, *sorted(corners(law))]
    if isinstance(law, LennardJones | Exponential):
        ends += [1.0, np.inf]
    work = sum(quad(pull(law), *span, epsabs=1e-14, epsrel=1e-12, limit=200)[0] for span in pairwise(ends))
    # the tolerance of quad on each span
    assert work == pytest.approx(law.work_of_adhesion, rel=1e-11)
    # zero at infinity, as for the van der Waals law
    assert law_at(law, np.array([0.0]))[0][0] == pytest.approx(-law.work_of_adhesion, rel=1e-14)


@every_law
def test_strength_is_the_largest_attraction(law: Law) -> None:
    peak = minimize_scalar(
        lambda x: -pull(law)(x), bounds=(0, 0.7), method="bounded", options={"xatol": 1e-9}
    )
    # the error of a smooth maximum is the square of that of its place
    assert -peak.fun == pytest.approx(law.strength, rel=1e-10)


@every_law
def test_compression_continues_with_the_initial_stiffness(law: Law) -> None:
    openings = np.array([-0.2, -0.1, 0.0])
    _, traction, derivative = law_at(law, openings)
    assert derivative[0] < 0
    np.testing.assert_allclose(derivative, derivative[2], rtol=1e-14)  # round-off
    np.testing.assert_allclose(traction, derivative[0] * openings, rtol=1e-13, atol=1e-15)


@every_law
def test_the_substrate_counts_as_flat(law: Law) -> None:
    np.testing.assert_array_equal(law_at(law, OPENINGS, curvature=0.5), law_at(law, OPENINGS))


@every_law
def test_laws_travel_to_other_processes_and_keep_nan(law: Law) -> None:
    assert pickle.loads(pickle.dumps(law)) == law
    # by nan the solver detects that a point has no gap
    assert np.isnan(law_at(law, np.array([np.nan]))[1]).all()


def test_lennard_jones_9_3_is_the_flat_van_der_waals_law() -> None:
    matched = VanDerWaals(hamaker_constant=0.05, equilibrium_distance=0.4)
    law = LennardJones(matched.work_of_adhesion, matched.equilibrium_gap)
    # round-off of ninth powers, of a traction that vanishes at the first opening
    for ours, published in zip(law_at(law, OPENINGS), law_at(matched, OPENINGS), strict=True):
        np.testing.assert_allclose(ours, published, rtol=1e-12, atol=1e-15)
    # C = 8 W/(3 r_eq), with the attraction at its largest at r = 3^(1/6) r_eq: Greenwood (1997)
    expected = 8 * law.work_of_adhesion / (3 * law.equilibrium_gap) * (3**-0.5 - 3**-1.5)
    assert law.strength == pytest.approx(expected, rel=1e-14)


def test_exponential_is_the_published_formula() -> None:
    law = Exponential(S, W, 0.2)
    x, d = OPENINGS[OPENINGS > 0], law.characteristic_length
    # phi = e sigma_max delta and T = phi/delta x/delta exp(-x/delta): Xu and Needleman (1994)
    assert np.e * S * d == pytest.approx(W, rel=1e-15)
    np.testing.assert_allclose(law_at(law, x)[1], -W / d * (x / d) * np.exp(-x / d), rtol=1e-12)  # of x


def sharp(law: Trapezoidal) -> Callable[[FloatArray], FloatArray]:
    """Attraction of the law that a trapezoidal one averages, straight between its kinks."""
    _, _, rise, fall, _, first, second, end = law.parameters
    assert rise * first == pytest.approx(fall * (end - second), rel=1e-14)
    points = [-first, 0.0, first, second, end, 2 * end]
    return lambda x: np.interp(x, points, np.array([-1.0, 0.0, 1.0, 1.0, 0.0, 0.0]) * rise * first)


@pytest.mark.parametrize("plateau", [0.0, 0.1, 0.4])
@pytest.mark.parametrize("rounding", [0.3, 1.0])
def test_trapezoidal_is_the_average_of_straight_lines(plateau: float, rounding: float) -> None:
    law = Trapezoidal(S, W, 0.3, plateau, rounding)
    width, first, second, end = law.parameters[4:]
    assert width == pytest.approx(rounding * first, rel=1e-14)
    assert [first / end, (second - first) / end] == pytest.approx([0.3, plateau], abs=1e-15)
    for x in np.linspace(0.0, end + width, 23):
        inside = [kink for kink in (first, second, end) if abs(kink - x) < width]
        mean = quad(sharp(law), x - width, x + width, points=inside or None, epsabs=1e-15)[0] / (2 * width)
        assert pull(law)(x) == pytest.approx(mean, abs=1e-13)  # of quad


def test_trapezoidal_with_kinks_hardly_rounded() -> None:
    law = Trapezoidal(S, W, 0.2, 0.5, 1e-9)
    end = 2 * W / (S * 1.5)
    openings = np.linspace(0.0, 1.1 * end, 100)
    expected = np.interp(openings, [0.0, 0.2 * end, 0.7 * end, end], [0.0, S, S, 0.0])
    np.testing.assert_allclose(-law_at(law, openings)[1], expected, rtol=0, atol=1e-9 * S)  # the rounding


def test_bilinear_is_trapezoidal_without_plateau() -> None:
    law, plain = Bilinear(S, W, 0.1, 0.4, 0.2), Trapezoidal(S, W, 0.1, 0.0, 0.4, 0.2)
    np.testing.assert_array_equal(law_at(law, OPENINGS), law_at(plain, OPENINGS))
    short = Trapezoidal(S, W, 0.1, 1e-10, 0.4, 0.2)
    stiffness = -law_at(law, np.array([0.0]))[2][0]
    # a plateau of 1e-10 moves the kinks by as much
    np.testing.assert_allclose(law_at(short, OPENINGS)[1], law_at(law, OPENINGS)[1], atol=1e-9 * stiffness)


def test_dugdale_with_a_sharp_transition() -> None:
    law = Dugdale(S, W, 1e-9)
    inside = np.linspace(2e-9, 1 - 1e-9, 20) * CRITICAL
    np.testing.assert_array_equal(law_at(law, inside)[1], -S)
    np.testing.assert_array_equal(law_at(law, np.array([1 + 1e-9, 2.0]) * CRITICAL)[1], 0.0)


def test_a_strip_peels_over_rounded_kinks_with_quadratic_convergence() -> None:
    problem = strip(law=Bilinear(strength=S, work_of_adhesion=W, rise=0.3))
    space, angles = row_space("N2.1", (100, 4)), np.radians(np.arange(0, 81, 2.5))
    *_, before = trace(problem, space, angles[:-1])
    (step,) = trace(problem, space, angles[-1:], NewtonSettings(plain=True), start=[before.state])
    expected = beam_peeling(problem)
    assert expected is not None
    # the beam's theory neglects what the joint gives, and the moment oscillates with the elements
    assert step.reaction == pytest.approx(expected.moment, rel=5e-3)
    # the order that energy residuals fall with, in the end: 2 but for what comes after the leading term
    before, last, final = np.log(step.iterations[-3:])
    assert (final - last) / (last - before) > 1.8


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: Exponential(0.0, W), "adhesion.strength"),
        (lambda: Dugdale(np.nan, W, 0.2), "adhesion.strength"),
        (lambda: Bilinear(S, -1.0, 0.1), "adhesion.work_of_adhesion"),
        (lambda: Exponential(S, np.inf), "adhesion.work_of_adhesion"),
        (lambda: Exponential(S, W, -0.1), "adhesion.equilibrium_gap"),
        (lambda: Trapezoidal(S, W, 0.0, 0.1), "adhesion.rise"),
        (lambda: Bilinear(S, W, 1.0), "adhesion.rise"),
        (lambda: Trapezoidal(S, W, 0.3, 0.7), "adhesion.plateau"),
        (lambda: Trapezoidal(S, W, 0.3, -0.1), "adhesion.plateau"),
        (lambda: Bilinear(S, W, 0.3, 0.0), "adhesion.rounding"),
        (lambda: Bilinear(S, W, 0.3, 1.1), "adhesion.rounding"),
        (lambda: Bilinear(S, W, 0.8, 0.7), "adhesion.rounding"),
        (lambda: Dugdale(S, W, 0.0), "adhesion.transition"),
        (lambda: Dugdale(S, W, 0.9), "adhesion.transition"),
        (lambda: LennardJones(0.0, 0.25), "adhesion.work_of_adhesion"),
        (lambda: LennardJones(W, 0.0), "adhesion.equilibrium_gap"),
        (lambda: LennardJones(W, 0.25, 9, 1), "adhesion.attractive_exponent"),
        (lambda: LennardJones(W, 0.25, 3, 3), "adhesion.repulsive_exponent"),
        (lambda: LennardJones(W, 0.25, np.inf, 3), "adhesion.repulsive_exponent"),
    ],
)
def test_constants_that_make_no_law_are_refused(make: Callable[[], Law], field: str) -> None:
    with pytest.raises(InputError) as refused:
        make()
    assert refused.value.field == field
