"""Secant unloading: work along paths by quadrature, closed forms, and the limits in which nothing is lost."""

from contextlib import nullcontext
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

from isopeel import FormulaAdhesion, InputError, VanDerWaals, row_space, strip
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion import AdhesionLaw
from isopeel.physics.adhesion.bilinear import Bilinear
from isopeel.physics.adhesion.dugdale import Dugdale
from isopeel.physics.adhesion.exponential import Exponential
from isopeel.physics.adhesion.irreversible import SecantUnloading, check_envelope, secant_unloading
from isopeel.physics.adhesion.lennard_jones import LennardJones
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.adhesion.trapezoidal import Trapezoidal
from isopeel.physics.batch import evaluate_law

S, W = 0.06, 0.015
LAWS: dict[str, AdhesionLaw] = {
    "van der Waals": VanDerWaals(0.05, 0.4),
    "12-6": LennardJones(W, 0.25, 12, 6),
    "exponential": Exponential(S, W, 0.2),
    "bilinear": Bilinear(S, W, 0.2),
    "trapezoidal": Trapezoidal(S, W, 0.1, 0.4, equilibrium_gap=0.3),
    "dugdale": Dugdale(S, W, 0.3),
}
REFUSED = r"adhesion\.irreversible: True cannot be used; .* must not grow faster than the opening"
every_law = pytest.mark.parametrize("law", LAWS.values(), ids=LAWS.keys())


def state(
    law: AdhesionLaw, opening: FloatArray | float, history: float, curvature: float = 0.0
) -> SecantUnloading:
    gap = law.equilibrium_gap + np.asarray(opening, dtype=np.float64)
    return secant_unloading(law, gap, np.array(history), curvature)


def envelope(law: AdhesionLaw, opening: FloatArray, curvature: float = 0.0) -> tuple[FloatArray, ...]:
    gap = law.equilibrium_gap + opening
    return evaluate_law(law.kernel, law.parameters, gap, np.full(gap.shape, curvature))


def work(law: AdhesionLaw, start: float, end: float, history: float, curvature: float = 0.0) -> float:
    """Work per area that moves a joint from one opening to another, by pieces without kinks or nearly so."""
    low, high = min(start, end), max(start, end)
    cuts = [cut for cut in (0.0, history, *np.linspace(0.05, 0.45, 9)) if low < cut < high]
    total = sum(
        quad(
            lambda x: -float(state(law, x, history, curvature).traction),
            *piece,
            epsabs=1e-14,
            epsrel=1e-12,
            limit=200,
        )[0]
        for piece in pairwise([low, *sorted(cuts), high])
    )
    return float(total if start < end else -total)


@every_law
@pytest.mark.parametrize("curvature", [0.0, 0.3])
def test_work_along_a_path_is_stored_and_dissipated(law: AdhesionLaw, curvature: float) -> None:
    history = total = lost = 0.0
    for start, end in pairwise([0.0, 0.02, 0.005, 0.1, -0.05, 0.06, 0.03, 0.25, 0.0, 0.5]):
        total += work(law, start, end, history, curvature)
        now = state(law, end, history, curvature)
        # of the work of adhesion, whose round-off the quadrature adds up; the tolerance is 1e-10
        assert now.stored + now.dissipated == pytest.approx(total, abs=1e-10 * W)
        if end <= history:
            assert now.dissipated == pytest.approx(lost, abs=1e-15 * W)
        assert now.stored >= -1e-3 * curvature * W  # (pulled together at the gap of a flat substrate)
        history, lost = max(history, end), float(now.dissipated)


@every_law
def test_inside_the_envelope_every_path_is_reversible(law: AdhesionLaw) -> None:
    openings = np.array([-0.05, 0.12, 0.04, 0.15, -0.05])
    loop = sum(work(law, start, end, 0.15) for start, end in pairwise(openings))
    assert loop == pytest.approx(0.0, abs=1e-12 * W)  # of the quadrature
    inside = state(law, np.linspace(-0.05, 0.149, 40), 0.15)
    np.testing.assert_allclose(inside.dissipated, inside.dissipated[0], rtol=1e-14)
    opened = inside.stored[np.linspace(-0.05, 0.149, 40) >= 0]
    assert (np.diff(opened) > 0).all()


@every_law
def test_energies_traction_and_derivative_belong_together(law: AdhesionLaw) -> None:
    history, step = 0.15, 1e-6
    # three branches: compression, the secant, the envelope, each away from its ends
    openings = np.concatenate(
        [np.linspace(*ends, 25) for ends in ((-0.05, -0.001), (0.001, 0.149), (0.151, 0.5))]
    )
    here = state(law, openings, history)
    ahead, behind = state(law, openings + step, history), state(law, openings - step, history)
    energy = (ahead.stored + ahead.dissipated - behind.stored - behind.dissipated) / (2 * step)
    slope = (ahead.traction - behind.traction) / (2 * step)
    # round-off of the energies over the step; second and third derivatives of the envelopes times its square
    np.testing.assert_allclose(energy, -here.traction, rtol=0, atol=1e-10)
    np.testing.assert_allclose(slope, here.derivative, rtol=0, atol=1e-9)


@every_law
@pytest.mark.parametrize("curvature", [0.0, 0.3])
def test_branches_join_without_jumps(law: AdhesionLaw, curvature: float) -> None:
    history = 0.15
    for place in (0.0, history):
        sides = state(law, place + np.array([-1e-12, 1e-12]), history, curvature)
        # the stiffest law changes its traction by 13e-12 per 1e-12, its energies by less
        assert np.ptp(sides.traction) < 3e-11
        assert np.ptp(sides.stored) + np.ptp(sides.dissipated) < 1e-12


@every_law
def test_first_opening_and_compression_follow_the_envelope(law: AdhesionLaw) -> None:
    openings = np.linspace(-0.05, 0.5, 56)
    potential, traction, derivative = envelope(law, openings)
    first = state(law, openings, 0.0)
    np.testing.assert_array_equal(first.traction, traction)
    np.testing.assert_array_equal(first.derivative, derivative)
    # zero at the equilibrium gap instead of at infinity
    np.testing.assert_allclose(
        first.stored + first.dissipated, potential + law.work_of_adhesion, rtol=0, atol=1e-15
    )
    closed = openings < 0
    pressed = state(law, openings[closed], 0.3)
    np.testing.assert_array_equal(pressed.traction, traction[closed])
    np.testing.assert_array_equal(pressed.stored, first.stored[closed])


@every_law
def test_dissipation_grows_and_ends_at_the_work_of_adhesion(law: AdhesionLaw) -> None:
    lost = state(law, np.geomspace(1e-3, 1e6, 400), 0.0).dissipated
    assert (np.diff(lost) > -1e-15 * W).all()  # round-off, where the rise is straight
    # what the van der Waals law, the slowest to decay, keeps at an opening of 10^6 is 1e-12 of it
    assert lost[-1] == pytest.approx(law.work_of_adhesion, rel=1e-11)
    separated = state(law, -0.05, 1e6)
    assert separated.dissipated == pytest.approx(law.work_of_adhesion, rel=1e-11)


def test_nothing_is_lost_on_a_straight_rise() -> None:
    law = Bilinear(S, W, rise=0.2, rounding=0.25)
    straight = 0.75 * law.parameters[5]
    openings = np.linspace(-0.05, straight, 30)
    secant = state(law, openings, straight)
    _, traction, derivative = envelope(law, openings)
    np.testing.assert_allclose(secant.traction, traction, rtol=1e-14)
    np.testing.assert_allclose(secant.derivative, derivative, rtol=1e-14)
    np.testing.assert_allclose(secant.dissipated, 0.0, atol=1e-15 * W)


def test_the_loss_of_a_curved_rise_has_its_closed_form() -> None:
    law = Exponential(S, W)
    z = np.linspace(0.0, 5.0, 21)
    # W (1 - (1 + z) exp(-z)) under the envelope, z^2 exp(-z)/2 of it in the triangle under the secant
    expected = W * (1 - (1 + z + z**2 / 2) * np.exp(-z))
    lost = state(law, z * law.characteristic_length, 0.0).dissipated
    np.testing.assert_allclose(lost, expected, rtol=0, atol=1e-15 * W)


def test_openings_of_the_size_of_round_off_leave_the_initial_slope() -> None:
    law = VanDerWaals(0.05, 0.4)
    initial = envelope(law, np.array([0.0]))[2][0]
    for history in np.geomspace(1e-17, 1e-7, 41):
        # the gap is known to 6e-17, a secant of 3e-11 so to 2e-6; that of 1e-7 is as much less steep
        assert state(law, 0.5 * history, history).derivative == pytest.approx(initial, rel=1e-5)
    # a larger opening counts: the slope is that of the secant, 2.5e-5 less than the initial one
    secant = envelope(law, np.array([1e-6]))[1][0] / 1e-6
    assert state(law, 5e-7, 1e-6).derivative == pytest.approx(secant, rel=1e-9)


def test_the_envelope_may_be_a_formula() -> None:
    law = Exponential(S, W)
    constants = {"W": W, "d": law.characteristic_length}
    formula = FormulaAdhesion("-W*(1 + r/d)*exp(-r/d)", constants)
    gaps = np.linspace(0.0, 0.4, 20)
    for ours, derived in zip(
        secant_unloading(law, gaps, np.array(0.2)),
        secant_unloading(formula, gaps, np.array(0.2)),
        strict=True,
    ):
        np.testing.assert_allclose(ours, derived, rtol=1e-12, atol=1e-15)  # round-off of the same formulas


@every_law
def test_every_envelope_may_be_irreversible(law: AdhesionLaw) -> None:
    check_envelope(law)
    check_envelope(Mirrored(law))


def test_an_envelope_that_would_return_energy_is_refused() -> None:
    """A = 4 W z^3/d/(1 + z^4)^2 of z = x/d: D = W z^4 (z^4 - 1)/(1 + z^4)^2 is negative up to z = 1."""
    law = FormulaAdhesion("-W/(1 + (r/d)**4)", {"W": W, "d": 0.2})
    z = np.array([0.5, 1.0, 2.0])
    expected = W * z**4 * (z**4 - 1) / (1 + z**4) ** 2
    # the equilibrium gap is found to 1e-12, beside one of 0.2
    np.testing.assert_allclose(state(law, 0.2 * z, 0.0).dissipated, expected, rtol=0, atol=1e-11 * W)
    with pytest.raises(InputError, match=REFUSED):
        check_envelope(law)


@pytest.mark.parametrize("b", [0.25, 0.75])
def test_the_attraction_may_not_grow_faster_than_the_opening(b: float) -> None:
    """A/z = 2 W/d exp(-z^2) (1 - b + b z^2) falls from z = 0 on for b < 1/2, and grows first for others."""
    law = FormulaAdhesion("-W*(1 + b*(r/d)**2)*exp(-(r/d)**2)", {"W": W, "d": 0.2, "b": b})
    System(strip(law=law), row_space("L1", (40, 1)))
    with nullcontext() if b < 0.5 else pytest.raises(InputError, match=REFUSED):
        System(strip(law=law, irreversible=True), row_space("L1", (40, 1)))


def test_shapes_broadcast() -> None:
    surface = secant_unloading(LAWS["dugdale"], np.zeros((3, 1)), np.array([0.0, 0.1]))
    assert [values.shape for values in surface] == [(3, 2)] * 4


@pytest.mark.parametrize("history", [-0.1, np.nan, np.inf])
def test_histories_that_no_opening_leaves_are_refused(history: float) -> None:
    with pytest.raises(InputError, match=r"history: .* finite and at least zero"):
        state(LAWS["dugdale"], 0.1, history)
