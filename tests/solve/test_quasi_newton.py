"""The kept tangent: the same equilibria as by plain Newton's method, from far fewer tangents."""

import numpy as np
import pytest

from isopeel.assembly.system import System
from isopeel.problem import strip
from isopeel.solve.linear import BandCholesky
from isopeel.solve.newton import NewtonSettings, newton
from isopeel.solve.predictor import best_weights, slope
from isopeel.solve.quasi_newton import Pair, QuasiNewton, _product
from isopeel.solve.step import Step
from isopeel.solve.trace import trace
from isopeel.splines.rows import row_space

ANGLES = np.radians(np.arange(0.0, 64.0, 0.5))


@pytest.fixture
def tangents(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Counts the tangents that are made."""
    made: list[float] = []
    linearize = System.linearize

    def counted(system: System, *arguments: object, **named: object) -> object:
        made.append(0.0)
        return linearize(system, *arguments, **named)  # type: ignore[arg-type]

    monkeypatch.setattr(System, "linearize", counted)
    return made


def path(space: str, plain: bool) -> list[Step]:
    return list(trace(strip(), row_space(space, (150, 4)), ANGLES, NewtonSettings(plain=plain)))


@pytest.mark.parametrize("space", ["L1", "L2", "N3", "N2.1", "L1+N2.1"])
def test_the_path_is_that_of_plain_newton(space: str, tangents: list[float]) -> None:
    kept = path(space, plain=False)
    few = len(tangents)
    plain = path(space, plain=True)
    # to the tolerance: energies within 1e-20 per unknown, and moments of second order in what is left
    np.testing.assert_allclose([s.reaction for s in kept], [s.reaction for s in plain], rtol=0, atol=1e-8)
    last = np.abs(kept[-1].displacement - plain[-1].displacement).max()
    assert last < 1e-6 * np.abs(plain[-1].displacement).max()
    assert 2 * few < len(tangents) - few


def test_moment_is_of_second_order_in_what_is_left() -> None:
    """With a coarse tolerance the moment has far more digits than the state."""
    exact = path("N2.1", plain=True)[-1]
    settings = NewtonSettings(tolerance=1e-12)
    *_, coarse = trace(strip(), row_space("N2.1", (150, 4)), ANGLES, settings)
    state = np.abs(coarse.displacement - exact.displacement).max()
    assert state > 1e-6
    assert abs(coarse.reaction - exact.reaction) < 0.1 * state


def test_product_is_that_of_the_updates_one_by_one() -> None:
    """Nocedal and Wright, Eq. 6.17, as dense matrices: H+ = V^T H V + rho s s^T."""
    system = System(strip(), row_space("N2", (12, 2)))
    u, _ = system.state(np.zeros(system.count), 0.0)
    _, matrix = system.linearize(u)
    n, width = matrix.entries.shape
    K = np.zeros((n, n))
    for j in range(n):
        for i in range(j, min(n, j + width)):
            K[i, j] = K[j, i] = matrix.entries[j, i - j]
    H = np.linalg.inv(K)
    rng = np.random.default_rng(1)
    pairs = []
    for _ in range(4):
        s = rng.standard_normal((n,))
        pairs.append(Pair.of(s, K @ s + 0.1 * s))
        rho = 1 / pairs[-1].curvature
        V = np.eye(n) - rho * np.outer(pairs[-1].change, s)
        H = V.T @ H @ V + rho * np.outer(s, s)
    residual = rng.standard_normal((n,))
    found = _product(BandCholesky.of(matrix), pairs, residual)
    # condition number about 1e5
    np.testing.assert_allclose(found, -H @ residual, rtol=0, atol=1e-9 * np.abs(found).max())


def test_it_gives_up_where_it_does_not_converge_well() -> None:
    system = System(strip(), row_space("N2", (60, 3)))
    method = QuasiNewton(system, NewtonSettings())
    assert method.equilibrium(np.zeros(system.count), 0.0) is not None
    assert method.memory is not None
    # a turn of a radian at once turns elements inside out
    assert method.equilibrium(np.zeros(system.count), 1.0) is None
    assert method.memory is None


def test_it_finds_what_newton_finds() -> None:
    system = System(strip(), row_space("N2", (60, 3)))
    found = QuasiNewton(system, NewtonSettings()).equilibrium(np.zeros(system.count), 0.002)
    assert found is not None
    exact = newton(system, np.zeros(system.count), 0.002, NewtonSettings())
    largest = np.abs(exact.unknown_values).max()
    np.testing.assert_allclose(found.unknown_values, exact.unknown_values, rtol=0, atol=1e-8 * largest)


def test_a_step_that_was_not_foreseen_ends_at_a_hundredth_of_the_tolerance() -> None:
    system = System(strip(), row_space("N2", (60, 3)))
    guess, limit = np.zeros(system.count), 1e-15
    settings = NewtonSettings(tolerance=limit / system.energy_scale)
    blind = QuasiNewton(system, settings).equilibrium(guess, 0.002)
    # from a last state that far away, all of the way is foreseen but for a trifle
    near = QuasiNewton(system, settings).equilibrium(guess, 0.002, guess - 1e3)
    assert blind is not None
    assert near is not None
    assert near.iterations[-1] <= limit < near.iterations[-2]
    assert blind.iterations[-1] <= 1e-2 * limit < blind.iterations[-2] <= limit
    assert near.iterations == blind.iterations[:-1]


def _led(parameters: np.ndarray, energies: np.ndarray, values: np.ndarray, target: float) -> float:
    return float(best_weights(parameters, energies, values[:, None], target)[0] @ values)


def test_the_polynomial_is_the_one_that_did_best() -> None:
    x = np.arange(12.0)
    none = np.zeros(12)  # an energy that does not change is no measure of the way
    assert _led(x, none, x**2 + 1, 12.0) == pytest.approx(145, rel=1e-12)
    assert _led(x[:1], none[:1], x[:1] + 7, 1.0) == 7
    # a cubic, as far as its states go: one more is tried
    assert _led(x[:3], none[:3], x[:3] ** 3, 3.0) == pytest.approx(21, rel=1e-12)
    assert _led(x, none, np.where(x < 10, 0.0, 1.0), 12.0) == 1


def test_the_energy_leads_where_the_parameter_hesitates() -> None:
    # near the limit point of p = s - s^2/2 at s = 1: the state's slope by p grows without end
    parameters = 0.49 + 0.0009 * np.arange(11)
    way = 1 - np.sqrt(1 - 2 * parameters)
    target = parameters[-1] + 0.0009
    exact = 1 - np.sqrt(1 - 2 * target)
    cubed = _led(parameters, 5 * way - 3, way**3, target)
    assert cubed == pytest.approx(exact**3, rel=1e-9)  # 11 digits of the states, less what weights cost
    # without a measure but the parameter, a hundredth of the last step is missed at least
    blind = _led(parameters, np.zeros(11), way**3, target)
    assert abs(blind - exact**3) > 0.01 * (way[-1] ** 3 - way[-2] ** 3)
    # beyond the limit point there is nothing to lead to; some state comes back all the same
    assert np.isfinite(_led(parameters, 5 * way - 3, way**3, 0.52))


def test_slope_is_that_of_the_polynomial() -> None:
    p = np.array([0.0, 0.3, 0.4, 0.55, 0.6])
    assert slope(p, p, p**4 - p) == pytest.approx(4 * 0.6**3 - 1, rel=1e-12)
    assert slope(p[:1], p[:1], np.ones(1)) == 0.0
    # since the drive has turned: a joint that was torn before follows another law
    turned, values = np.array([0.1, 0.5, 0.7, 0.6, 0.4]), np.array([0.1, 0.5, 0.7, 0.36, 0.16])
    expected = np.polyval(np.polyder(np.polyfit(turned[2:], values[2:], 2)), 0.4)
    assert slope(turned, turned, values) == pytest.approx(expected, rel=1e-12)


def test_slope_follows_the_adhesive_energy_past_a_limit_point() -> None:
    s = np.array([0.1, 0.3, 0.4, 0.45, 0.6])
    p = s - s**2  # turns at s = 0.5
    assert slope(3 * s - 1, p, s**3) == pytest.approx(3 * 0.6**2 / (1 - 2 * 0.6), rel=1e-12)
    s[-1] = 0.52  # the last step crosses the limit point: forwards, while the slope is backwards
    assert slope(3 * s - 1, s - s**2, s**3) == 0.0


@pytest.mark.kept_tangent
def test_the_last_step_alone_keeps_the_memory() -> None:
    steps = trace(strip(), row_space("N2", (20, 2)), np.radians([0.0, 0.1, 0.2]))
    first, second = next(steps), next(steps)
    assert first.state.memory is None
    kept = second.state
    assert kept.memory is not None
    served = kept.memory.steps
    next(steps)
    assert kept.memory.steps == served  # a state that was asked for in time keeps its own
