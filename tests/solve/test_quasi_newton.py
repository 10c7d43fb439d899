"""The chord tangent: the same equilibria as by plain Newton's method, from far fewer tangents."""

from dataclasses import replace

import numpy as np
import pytest

from isopeel.assembly.system import System
from isopeel.matrix.cholesky import BandCholesky
from isopeel.problem import Problem, PulledSide, strip
from isopeel.solve import quasi_newton
from isopeel.solve.lbfgs import MOST_PAIRS, LbfgsPairs
from isopeel.solve.newton import NewtonSettings, newton
from isopeel.solve.quasi_newton import QuasiNewton
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
    chord = path(space, plain=False)
    few = len(tangents)
    plain = path(space, plain=True)
    # to the tolerance: energies within 1e-20 per unknown, and moments of second order in what is left
    np.testing.assert_allclose([s.reaction for s in chord], [s.reaction for s in plain], rtol=0, atol=1e-8)
    last = np.abs(chord[-1].displacement - plain[-1].displacement).max()
    assert last < 1e-6 * np.abs(plain[-1].displacement).max()
    assert 2 * few < len(tangents) - few


def test_the_error_of_the_moment_is_of_second_order_in_the_residual() -> None:
    """With a coarse tolerance the moment has far more digits than the state."""
    exact = path("N2.1", plain=True)[-1]
    settings = NewtonSettings(tolerance=1e-11)
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
    pairs = LbfgsPairs.none(n)
    for _ in range(4):
        s = rng.standard_normal((n,))
        pairs = pairs.followed_by(s, K @ s + 0.1 * s)
        s, change = (vectors[-1].astype(np.float64) for vectors in (pairs.corrections, pairs.changes))
        rho = 1 / (s @ change)
        V = np.eye(n) - rho * np.outer(change, s)
        H = V.T @ H @ V + rho * np.outer(s, s)
    residual = rng.standard_normal((n,))
    for precision, close in ((np.float64, 1e-9), (np.float32, 1e-2)):  # condition number about 1e5
        found = pairs.correction(BandCholesky.of(matrix.entries, precision), residual)
        np.testing.assert_allclose(found, -H @ residual, rtol=0, atol=close * np.abs(found).max())


def test_pairs_are_the_last_ones_and_positive() -> None:
    numbers = np.arange(1.0, 60.0)
    pairs = LbfgsPairs.none(1)
    seen = []
    for x in numbers:
        pairs = pairs.followed_by(np.array([x]), np.array([2 * x]))
        # one that would make the tangent indefinite teaches nothing
        assert pairs.followed_by(np.array([x]), np.array([-x])) is pairs
        seen.append(pairs)
    for k, then in enumerate(seen, start=1):
        expected = numbers[max(k - MOST_PAIRS, 0) : k]
        np.testing.assert_array_equal(then.corrections[:, 0], expected)
        np.testing.assert_array_equal(then.changes[:, 0], 2 * expected)
    # a copy changes independently
    other = seen[4].copy().followed_by(np.array([7.0]), np.array([7.0]))
    assert other.corrections[-1] == 7
    np.testing.assert_array_equal(seen[5].corrections[:, 0], numbers[:6])


def test_it_stops_where_it_does_not_converge_well() -> None:
    system = System(strip(), row_space("N2", (60, 3)))
    method = QuasiNewton(system, NewtonSettings())
    assert method.equilibrium(np.zeros(system.count), 0.0) is not None
    assert method.solver_state is not None
    # a turn of a radian at once turns elements inside out
    assert method.equilibrium(np.zeros(system.count), 1.0) is None
    assert method.solver_state is None


def test_it_finds_the_equilibria_of_newtons_method() -> None:
    system = System(strip(), row_space("N2", (60, 3)))
    found = QuasiNewton(system, NewtonSettings()).equilibrium(np.zeros(system.count), 0.002)
    assert found is not None
    exact = newton(system, np.zeros(system.count), 0.002, NewtonSettings())
    largest = np.abs(exact.unknown_values).max()
    np.testing.assert_allclose(found.unknown_values, exact.unknown_values, rtol=0, atol=1e-8 * largest)


def test_the_step_after_a_new_tangent_ends_at_a_thousandth_of_the_tolerance() -> None:
    system = System(strip(), row_space("N2", (60, 3)))
    guess, limit = np.zeros(system.count), 1e-15
    settings, far = NewtonSettings(tolerance=limit / system.energy_scale), guess - 1e3
    method = QuasiNewton(system, settings)
    assert method.equilibrium(guess, 0.002, far) is not None
    solver_state = method.solver_state
    assert solver_state is not None
    assert solver_state.steps == 1
    after = QuasiNewton(system, settings, solver_state).equilibrium(guess, 0.003, far)
    later = QuasiNewton(system, settings, replace(solver_state, steps=2)).equilibrium(guess, 0.003, far)
    assert after is not None
    assert later is not None
    assert after.iterations[-1] <= 1e-3 * limit < later.iterations[-1] <= limit
    assert later.iterations == after.iterations[: len(later.iterations)]


def test_the_last_evaluation_of_forces_is_skipped(monkeypatch: pytest.MonkeyPatch) -> None:
    system = System(strip(), row_space("N2", (60, 3)))
    settings = NewtonSettings(tolerance=1e-16)
    exact = newton(system, np.zeros(system.count), 0.002, NewtonSettings()).unknown_values
    near = exact + 1e-9 * np.sin(np.arange(system.count))
    last = exact - 1e3
    skipped = QuasiNewton(system, settings).equilibrium(near, 0.002, last)
    monkeypatch.setattr(quasi_newton, "_SKIP_SHARE", 0.0)
    evaluated = QuasiNewton(system, settings).equilibrium(near, 0.002, last)
    assert skipped is not None
    assert evaluated is not None
    assert skipped.iterations == evaluated.iterations
    assert len(skipped.iterations) == 1
    # the same state, whose forces are those from before the correction
    np.testing.assert_array_equal(skipped.unknown_values, evaluated.unknown_values)
    np.testing.assert_array_equal(skipped.displacement, system.state(skipped.unknown_values, 0.002)[0])
    residuals = [np.abs(found.equilibrium.residual).max() for found in (skipped, evaluated)]
    assert residuals[0] > 10 * residuals[1]
    assert skipped.equilibrium.stored_energy == pytest.approx(evaluated.equilibrium.stored_energy, rel=1e-6)


@pytest.mark.parametrize(
    "problem",
    [
        strip().changed(adhesion=replace(strip().adhesion, irreversible=True)),
        replace(strip(), drive=PulledSide("top", 1.0, control="force")),
    ],
    ids=["irreversible", "load"],
)
def test_the_last_evaluation_is_not_skipped_for_loads_and_irreversible_joints(problem: Problem) -> None:
    """The maximum openings, and the displacement of a load, are known to first order only."""
    system = System(problem, row_space("N2", (60, 3)))
    settings = NewtonSettings(tolerance=1e-12)
    found = QuasiNewton(system, settings).equilibrium(
        np.zeros(system.count), 1e-6, np.full(system.count, 1e3)
    )
    assert found is not None
    u, load = system.state(found.unknown_values, 1e-6)
    expected = system.equilibrium(u, load).residual
    np.testing.assert_allclose(found.equilibrium.residual, expected, rtol=0, atol=1e-14)


def test_a_poorly_predicted_step_ends_at_a_thousandth_of_the_tolerance() -> None:
    system = System(strip(), row_space("N2", (60, 3)))
    guess, limit = np.zeros(system.count), 1e-15
    settings = NewtonSettings(tolerance=limit / system.energy_scale)
    blind = QuasiNewton(system, settings).equilibrium(guess, 0.002)
    # from a last state that far away, the guess is well predicted
    near = QuasiNewton(system, settings).equilibrium(guess, 0.002, guess - 1e3)
    assert blind is not None
    assert near is not None
    assert near.iterations[-1] <= limit < near.iterations[-2]
    assert blind.iterations[-1] <= 1e-3 * limit < blind.iterations[-2] <= limit
    assert near.iterations == blind.iterations[:-1]


@pytest.mark.chord_tangent
def test_only_the_last_step_has_the_solver_state() -> None:
    steps = trace(strip(), row_space("N2", (20, 2)), np.radians([0.0, 0.1, 0.2]))
    first, second = next(steps), next(steps)
    assert first.state.solver_state is None
    state = second.state
    assert state.solver_state is not None
    served = state.solver_state.steps
    next(steps)
    assert state.solver_state.steps == served  # a state that was read before the next step does not change
