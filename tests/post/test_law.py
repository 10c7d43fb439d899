"""What laws amount to, against their closed forms."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import lambertw

from isopeel import Bilinear, Exponential, FormulaAdhesion, InputError, LennardJones, VanDerWaals
from isopeel.physics.adhesion import AdhesionLaw
from isopeel.post.figures import law_figure
from isopeel.post.law import evaluate_flat, law_character, opened_flat


def test_van_der_waals_against_the_published_numbers() -> None:
    """A_H = 1e-19 J and r0 = 0.4 nm, in units of 2 GPa and 1 nm."""
    character = law_character(VanDerWaals(0.05, 0.4))
    assert 2000 * character.strength == pytest.approx(123.6, abs=0.05)  # MPa, to the digit
    assert character.strongest_gap == pytest.approx(0.3059, abs=5e-5)
    assert 2 * character.work_of_adhesion == pytest.approx(0.030665, abs=5e-7)
    # in closed form: A_H sqrt(5)/(9 pi r0^3) at r0/5^(1/6), to what a search for a flat peak leaves
    assert character.strength == pytest.approx(0.05 * 5**0.5 / (9 * np.pi * 0.4**3), rel=1e-13)
    assert character.strongest_gap == pytest.approx(0.4 / 5 ** (1 / 6), rel=1e-6)
    # T' = A_H/(2 pi r0^4) [(r0/r)^4 - (r0/r)^10/5] at r0/15^(1/6)
    expected = 0.05 / (2 * np.pi * 0.4**4) * (15 ** (10 / 6) / 5 - 15 ** (4 / 6))
    assert character.stiffness == pytest.approx(expected, rel=1e-12)


def test_exponential_in_closed_form() -> None:
    character = law_character(Exponential(0.06, 0.015, 0.1))
    length = 0.015 / (np.e * 0.06)
    assert character.strength == pytest.approx(0.06, rel=1e-13)
    assert character.strongest_gap == pytest.approx(0.1 + length, rel=1e-6)
    assert character.stiffness == pytest.approx(0.015 / length**2, rel=1e-13)
    # z exp(1 - z) = 1/2 beyond z = 1; the secant gives back z^2/2 exp(-z) of 1 - (1 + z) exp(-z)
    z = -float(lambertw(-0.5 / np.e, -1).real)
    returned, work = z**2 / 2 * np.exp(-z), 1 - (1 + z) * np.exp(-z)
    assert character.softened_gap == pytest.approx(0.1 + z * length, rel=1e-12)
    assert character.dissipated_energy == pytest.approx(0.015 * (work - returned), rel=1e-12)
    assert character.dissipated_share == pytest.approx(1 - returned / work, rel=1e-12)


@pytest.mark.parametrize("law", [VanDerWaals(0.05, 0.4), LennardJones(0.015, 0.25, 12.0, 6.0)])
def test_work_is_the_integral_of_the_attraction(law: AdhesionLaw) -> None:
    def attraction(gap: float) -> float:
        return -float(evaluate_flat(law, np.array([gap]))[1][0])

    work, _ = quad(attraction, law.equilibrium_gap, np.inf, epsabs=1e-12, epsrel=1e-10)
    assert law_character(law).work_of_adhesion == pytest.approx(work, rel=1e-8)  # the quadrature's
    # parted, an irreversible joint gives nothing back; T and the area under the secant vanish with the gap
    assert opened_flat(law, np.array([1e6])).dissipated[0] == pytest.approx(work, rel=1e-8)


@pytest.mark.parametrize("rise", [0.02, 0.08, 0.3])
def test_half_of_the_strength_is_found_wherever_a_sharp_peak_lies(rise: float) -> None:
    """A peak between the places that are looked at is higher than at them, and so is its half."""
    for work in np.geomspace(1e-4, 1e-3, 200):
        law = Bilinear(0.00195, work, rise)
        character = law_character(law)
        at = character.softened_gap + np.array([-0.001, 0.0, 0.001]) * work / 0.00195
        before, half, after = -evaluate_flat(law, at)[1] / character.strength
        # to what the search for the peak leaves
        assert half == pytest.approx(0.5, rel=1e-6)
        assert before > 0.5 > after


def test_a_law_whose_peak_is_too_far_away_is_refused() -> None:
    """Its strongest attraction acts at an opening of 1e8."""
    with pytest.raises(InputError, match="attract most"):
        law_character(Exponential(1e-8 / np.e, 1.0))


def test_the_figure_holds_the_law() -> None:
    law = VanDerWaals(0.05, 0.4)
    panels = law_figure(law).axes
    character = law_character(law)
    curves = [max(axes.lines, key=lambda line: len(np.asarray(line.get_xdata()))) for axes in panels]
    gap = np.asarray(curves[0].get_xdata(), dtype=np.float64)
    assert gap[0] < law.equilibrium_gap < character.strongest_gap < character.softened_gap < gap[-1]
    potential, traction, derivative = evaluate_flat(law, gap)
    # what was opened to a gap takes the area under the secant back, and leaves the rest of the work
    opening = np.maximum(gap - law.equilibrium_gap, 0.0)
    dissipated = np.where(opening > 0, potential + law.work_of_adhesion + 0.5 * traction * opening, 0.0)
    for curve, values in zip(curves, (traction, derivative, potential, dissipated), strict=True):
        # round-off
        np.testing.assert_allclose(np.asarray(curve.get_ydata()), values, rtol=1e-13, atol=1e-16)
    unloading = panels[0].lines[-1]
    np.testing.assert_array_equal(
        np.asarray(unloading.get_xdata()), [law.equilibrium_gap, character.softened_gap]
    )
    np.testing.assert_allclose(
        np.asarray(unloading.get_ydata()), [0.0, -character.strength / 2], rtol=1e-12, atol=1e-16
    )


def test_a_law_from_a_formula_has_a_character_too() -> None:
    law = FormulaAdhesion("W*((s/r)**8/3 - 4/3*(s/r)**2)", {"W": 0.015, "s": 0.25})
    character = law_character(law)
    assert character.equilibrium_gap == pytest.approx(0.25, rel=1e-9)
    assert character.work_of_adhesion == pytest.approx(0.015, rel=1e-9)
    # -T = 8 W/(3 s) [x^3 - x^9] with x = s/r is largest at x^6 = 1/3
    assert character.strength == pytest.approx(8 * 0.015 / (3 * 0.25) * (2 / 3) / 3**0.5, rel=1e-12)
