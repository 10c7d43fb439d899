"""Adhesion laws and substrates against closed forms, quadrature and finite differences."""

import pickle

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq, minimize_scalar

from isopeel import Exponential, Flat, FormulaAdhesion, InputError, MooneyRivlin, VanDerWaals, Yeoh
from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion import AdhesionLaw
from isopeel.physics.adhesion.irreversible import secant_unloading
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.batch import evaluate_law, evaluate_substrate

A_H, R0 = 1e-19, 0.4e-9  # J, m: SI, to hold the law against the published figures in their units
IN_SI = VanDerWaals(hamaker_constant=A_H, equilibrium_distance=R0)
LAW = VanDerWaals(hamaker_constant=0.05, equilibrium_distance=0.4)


def law_at(law: AdhesionLaw, gap: FloatArray, curvature: float = 0.0) -> tuple[FloatArray, ...]:
    return evaluate_law(law.kernel, law.parameters, gap, np.full(gap.shape, curvature))


def published_traction(r: float, radius: float = np.inf) -> float:
    """T(r) as printed, with the surface's curvature radius R."""
    f1 = f2 = 1.0
    if np.isfinite(radius):
        f1 = (radius**2 + 9 / 4 * radius * r + 9 / 7 * r**2) / (radius + r) ** 2
        f2 = (radius**2 + 3 * radius * r + 3 * r**2) / (radius + r) ** 2
    return 0.05 / (2 * np.pi * 0.4**3) * (f1 / 45 * (0.4 / r) ** 9 - f2 / 3 * (0.4 / r) ** 3)


def test_published_figures_of_the_flat_law() -> None:
    # each to a unit of its last published digit (the first is cut off there, not rounded)
    assert IN_SI.equilibrium_gap == pytest.approx(0.25470e-9, abs=1e-14)
    assert IN_SI.work_of_adhesion == pytest.approx(0.030665, abs=1e-6)
    peak = minimize_scalar(
        lambda r: float(law_at(IN_SI, np.array([r * 1e-9]))[1][0]), bounds=(0.26, 0.5), method="bounded"
    )
    assert peak.x == pytest.approx(0.3059, abs=1e-4)
    assert peak.fun == pytest.approx(-123.6e6, abs=0.1e6)


@pytest.mark.parametrize("radius", [np.inf, 20.0, 1.5, -5.0])
def test_traction_is_the_published_formula(radius: float) -> None:
    gaps = np.linspace(0.3, 3.0, 40)
    _, traction, _ = law_at(LAW, gaps, curvature=1 / radius)
    expected = [published_traction(gap, radius) for gap in gaps]
    np.testing.assert_allclose(traction, expected, rtol=1e-13)  # round-off of ninth powers


@pytest.mark.parametrize("radius", [np.inf, 20.0, 1.5])
def test_potential_is_the_integral_of_the_traction(radius: float) -> None:
    for gap in (0.2, 0.2547, 0.3, 1.0):
        potential = law_at(LAW, np.array([gap]), curvature=1 / radius)[0][0]
        work, error = quad(
            lambda r: law_at(LAW, np.array([r]), curvature=1 / radius)[1][0],
            gap,
            np.inf,
            epsabs=1e-13,
            epsrel=1e-11,
            limit=400,
        )
        # the integrand has a kink in its second derivative where the regularisation begins
        assert potential == pytest.approx(work, abs=max(10 * error, 1e-11))
    flat = law_at(LAW, np.array([LAW.equilibrium_gap]))[0][0]
    assert flat == pytest.approx(-LAW.work_of_adhesion, rel=1e-14)  # round-off


@pytest.mark.parametrize("curvature", [0.0, 0.05, 0.7, -0.2])
def test_derivative_and_smooth_regularisation(curvature: float) -> None:
    gaps = np.linspace(0.15, 2.0, 60)
    _, _, derivative = law_at(LAW, gaps, curvature)
    step = 1e-6
    ahead, behind = law_at(LAW, gaps + step, curvature)[1], law_at(LAW, gaps - step, curvature)[1]
    # central differences of a law whose third derivative reaches 1e3
    np.testing.assert_allclose((ahead - behind) / (2 * step), derivative, atol=2e-9 * 1e3)
    below = law_at(LAW, np.array([0.10, 0.15, 0.20]), curvature)[1]
    assert below[0] - below[1] == pytest.approx(below[1] - below[2], rel=1e-12)  # a straight line


@pytest.mark.parametrize("curvature", [1e6, 3.0, -1.0, -1.5])
def test_equilibrium_on_strongly_curved_substrates(curvature: float) -> None:
    """T vanishes there, and is a straight line below; (r0/r)^6 = 15 f2/f1 is 35 on a sharp tip."""
    gap = brentq(lambda r: published_traction(r, 1 / curvature), 0.2, 0.28, xtol=1e-16)
    if curvature == 1e6:
        assert gap == pytest.approx(0.4 / 35 ** (1 / 6), rel=1e-5)  # the next term is 1/(k r)
    _, traction, derivative = law_at(LAW, gap * np.array([1 - 1e-9, 1.0, 0.5]), curvature)
    # round-off of ninth powers, and of the gap where T is a hundred times its peak per length
    assert traction[1] == pytest.approx(0.0, abs=1e-13)
    assert traction[2] == pytest.approx(-0.5 * gap * derivative[0], rel=1e-12)


FORMULA = "W*((s/r)**8/3 - 4/3*(s/r)**2)"


@pytest.mark.parametrize(
    "law",
    [LAW, Mirrored(LAW), FormulaAdhesion(FORMULA, {"W": 0.01, "s": 0.25})],
    ids=["written", "mirrored", "formula with a pole"],
)
def test_a_point_without_a_gap_has_no_traction(law: AdhesionLaw) -> None:
    """Not even a finite one, as by max(nan, r_eq): by nan the solver detects that a point has no gap."""
    assert np.isnan(law_at(law, np.array([np.nan]))).all()
    lost = secant_unloading(law, np.array([np.nan, np.nan]), np.array([0.0, 0.1]))
    assert np.isnan([lost.stored, lost.traction]).all()


def test_a_formula_gives_the_same_law() -> None:
    formula = FormulaAdhesion("A/(2*pi*r0**3) * (r0**9/(360*r**8) - r0**3/(6*r**2))", {"A": 0.05, "r0": 0.4})
    gaps = np.linspace(0.26, 2.0, 30)  # above the equilibrium gap, where the formula has no regularisation
    for ours, derived in zip(law_at(LAW, gaps), law_at(formula, gaps), strict=True):
        np.testing.assert_allclose(ours, derived, rtol=0, atol=1e-12)  # round-off of values up to 60
    assert formula.equilibrium_gap == pytest.approx(LAW.equilibrium_gap, rel=1e-12)
    # a gap of 10^6 stands for infinity: the rest decays with its square
    assert formula.work_of_adhesion == pytest.approx(LAW.work_of_adhesion, rel=1e-10)


def test_the_potential_of_a_formula_counts_from_infinity() -> None:
    """By the potential itself a joint is held along the substrate, see `physics.adhesion.sliding`."""
    constants = {"W": 0.015, "a": 0.3, "r0": 0.3}
    morse = "W*(1 - exp(-(r - r0)/a))**2"
    gaps = np.linspace(0.2, 3.0, 30)
    values = law_at(FormulaAdhesion(morse, constants), gaps)
    for ours, shifted in zip(values, law_at(FormulaAdhesion(f"{morse} - W", constants), gaps), strict=True):
        np.testing.assert_allclose(ours, shifted, rtol=0, atol=1e-15)  # round-off of stiffnesses up to 1
    assert values[0].min() >= -0.015


NAMES_OF_THE_KERNEL = ["n", "count", "gap", "traction", "potential", "parameters", "range", "shared_0", "nan"]


@pytest.mark.parametrize("name", NAMES_OF_THE_KERNEL)
def test_constants_do_not_meet_the_names_of_the_kernel(name: str) -> None:
    plain = FormulaAdhesion("W*((s/r)**(2*m)/m - 2*(s/r)**m/m)", {"W": 0.01, "s": 0.3, "m": 4.0})
    named = FormulaAdhesion(plain.potential.replace("m", f"{name}"), {"W": 0.01, "s": 0.3, name: 4.0})
    gaps = np.linspace(0.25, 1.0, 7)
    # the same formula: only the order of its operations may change with the names
    np.testing.assert_allclose(law_at(named, gaps), law_at(plain, gaps), rtol=1e-13)


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e3])
def test_a_formula_may_have_any_unit_of_length(scale: float) -> None:
    law = FormulaAdhesion("W*((s/r)**8/3 - 4/3*(s/r)**2)", {"W": 0.01, "s": 0.25 * scale})
    assert law.equilibrium_gap == pytest.approx(0.25 * scale, rel=1e-12)
    assert law.work_of_adhesion == pytest.approx(0.01, rel=1e-10)


def test_a_law_that_is_singular_at_contact_ends_there() -> None:
    singular = FormulaAdhesion("W*((s/r)**8/3 - 4/3*(s/r)**2)", {"W": 0.01, "s": 0.25})
    assert np.isnan(law_at(singular, np.array([-0.1, 0.0]))).all()


def test_the_exponential_law_has_its_equilibrium_at_contact() -> None:
    law = FormulaAdhesion("-W*(1 + r/d)*exp(-r/d)", {"W": 0.01, "d": 0.3})
    assert law.equilibrium_gap == pytest.approx(0.0, abs=1e-12)  # the first gap of the search
    assert law.work_of_adhesion == pytest.approx(0.01, rel=1e-14)
    _, traction, _ = law_at(law, np.array([-0.1, 0.3]))
    # T = -W r/d^2 exp(-r/d); strongest attraction W/(e d) at r = d
    np.testing.assert_allclose(traction, [0.01 / 0.9 * np.exp(1 / 3), -0.01 / 0.3 / np.e], rtol=1e-13)


def test_laws_from_formulas_travel_to_other_processes() -> None:
    law = FormulaAdhesion("W*((s/r)**8/3 - 4/3*(s/r)**2)", {"W": 0.01, "s": 0.25})
    assert pickle.loads(pickle.dumps(law)) == law


@pytest.mark.parametrize(
    ("potential", "reason"),
    [
        ("-1/(1 + r)", "minimum over the gap"),
        ("r", "minimum over the gap"),
        ("exp(r)", "minimum over the gap"),
        ("0*r", "minimum over the gap"),
        ("exp(-r)", "minimum over the gap"),
        ("(r - 1)**2*exp(-r)", "work of adhesion must be positive"),
        ("r**2", "attraction must vanish with the gap"),
        ("log(1 + (r - 1)**2)", "attraction must vanish with the gap"),
        ("cosh(r - 1)", "work of adhesion must be positive and finite"),
        ("sqrt((r - 1)**2)", "without jumps"),
        ("(-1)**0.5*r", "a formula uses"),
        ("r + 2**(1/0)", "a formula uses"),
    ],
)
def test_a_formula_that_is_no_law_is_refused(potential: str, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        FormulaAdhesion(potential)


@pytest.mark.parametrize(("hamaker", "distance"), [(0.0, 0.4), (-1.0, 0.4), (0.05, 0.0), (0.05, np.nan)])
def test_van_der_waals_refuses_constants(hamaker: float, distance: float) -> None:
    with pytest.raises(InputError, match="it must be positive"):
        VanDerWaals(hamaker, distance)


def test_flat_substrate() -> None:
    flat = Flat(height=-0.5)
    positions = np.array([[3.0, 1.0], [4.0, -2.0]])
    gap, normal, curvature = evaluate_substrate(flat.kernel, flat.parameters, positions)
    assert gap.tolist() == [1.5, -1.5]
    assert normal.tolist() == [[0.0, 1.0], [0.0, 1.0]]
    assert curvature.tolist() == [0.0, 0.0]


def test_whole_numbers_are_constants_too() -> None:
    """Kernels take floating-point parameters only."""
    for parameters in (
        VanDerWaals(1, 1).parameters,
        Flat(1).parameters,
        MooneyRivlin(1, 0, 5).parameters,
        Yeoh(1, 0, 0, 5).parameters,
        Exponential(1, 1).parameters,
    ):
        assert parameters.dtype == np.float64
