"""The traced path: reference values, energy balance, quadratic convergence, closed form, failures."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from isopeel import (
    ConvergenceError,
    InputError,
    NeoHooke,
    NewtonSettings,
    VanDerWaals,
    row_space,
    strip,
    trace,
)
from isopeel.assembly.system import System
from isopeel.matrix.cholesky import BandCholesky
from isopeel.matrix.factor import NotPositiveDefiniteError
from isopeel.matrix.factorize import factorize
from isopeel.matrix.lu import BandLU
from isopeel.post.closed_form import beam_peeling
from isopeel.problem import Traction
from isopeel.solve.newton import newton
from isopeel.solve.predictor import extrapolate
from isopeel.solve.step import State


def moment_at(
    angle: float,
    name: str,
    elements: tuple[int, int],
    step: float = 1.0,
    traction: Traction = "reference",
) -> float:
    """Moment at an angle in degrees, reached by steps; equilibria don't depend on the steps."""
    angles = np.radians(np.linspace(0, angle, round(angle / step) + 1))
    *_, last = trace(strip(traction=traction), row_space(name, elements), angles)
    return last.reaction


def test_reference_values_of_two_independent_codes() -> None:
    """L4 at 200 x 10; published to eight decimals by two codes that agree to 6e-9."""
    angles = np.arange(0, 121)
    steps = list(trace(strip(), row_space("L4", (200, 10)), np.radians(angles)))
    assert steps[100].reaction == pytest.approx(1.62928603, abs=1e-8)
    assert steps[120].reaction == pytest.approx(1.62944802, abs=1e-8)


def test_projected_force_against_another_program() -> None:
    """L2 at 200 x 10 with the unsymmetric tangent, by a scikit-fem program that shares no code with ours."""
    moment = moment_at(90.0, "L2", (200, 10), traction="projected")
    assert moment == pytest.approx(1.616095344503, abs=1e-9)  # what both tolerances leave
    assert moment == pytest.approx(1.6162, rel=1e-3)  # published mean of the plateau, fine spaces


def test_equilibria_do_not_depend_on_the_steps() -> None:
    coarse = moment_at(75.0, "N2.1", (80, 4), step=2.5)
    fine = moment_at(75.0, "N2.1", (80, 4), step=0.5)
    assert coarse == pytest.approx(fine, abs=2e-9)  # what the default tolerance leaves


@pytest.mark.parametrize("name", ["N2.1", "L2", "L1+N4"])
def test_external_work_is_stored_and_adhesive_energy(name: str) -> None:
    """The moment, integrated over the angle by Gauss points in each degree, is the change of energy."""
    points, weights = np.polynomial.legendre.leggauss(4)
    ends = np.radians(np.arange(0, 86))
    half = np.diff(ends)[:, None] / 2
    angles = np.concatenate([[0.0], (ends[:-1, None] + half * (points + 1)).ravel(), [ends[-1]]])
    steps = list(trace(strip(), row_space(name, (200, 3)), angles))
    moments = np.array([step.reaction for step in steps[1:-1]]).reshape(-1, 4)
    work = float(np.sum(half * weights * moments))
    first, last = steps[0], steps[-1]
    change = last.stored_energy + last.adhesive_energy - first.stored_energy - first.adhesive_energy
    assert work > 1.0  # peeling is under way
    # four Gauss points over a degree, in which the oscillating moment takes its turn
    assert work == pytest.approx(change, rel=1e-6)


@pytest.mark.parametrize("traction", ["reference", "projected"])
def test_newton_converges_quadratically(traction: Traction) -> None:
    """On the plateau: the energy residual, of second order in the error, falls as its square."""
    problem = strip(traction=traction)
    angles = np.radians(np.arange(0, 91.0))
    system = System(problem, row_space("N2.1", (200, 4)))
    *_, last = trace(problem, row_space("N2.1", (200, 4)), angles)
    start = system.constraints.unknown_values(last.displacement, last.parameter)
    tight = NewtonSettings(tolerance=1e-28)
    result = newton(system, start, last.parameter + np.radians(0.02), tight)
    residuals = np.array(result.iterations)
    tail = residuals[residuals < 1e-10][:3]
    orders = np.log(tail[1:] / tail[:-1])
    # each drop, in decades, is twice the last one; a linear rate would repeat it. The asymptotic range is
    # short: round-off ends it at 1e-28, about
    assert orders[1] / orders[0] > 1.5
    assert len(residuals) <= 8


@pytest.mark.parametrize("name", ["N2.1", "N4"])
def test_plateau_is_the_closed_form(name: str) -> None:
    closed_form = beam_peeling(strip())
    assert closed_form is not None
    moment = moment_at(100.0, name, (200, 10))
    assert moment == pytest.approx(closed_form.moment, rel=3e-3)  # thin-beam theory; h/rho = 0.19


def test_other_units_give_the_same_path() -> None:
    """In SI (metres, pascals) the moment is that in L0 and E0, scaled; nothing in the solver has a length."""
    metre, pascal = 1e-9, 2e9
    in_si = strip(
        length=200 * metre,
        height=10 * metre,
        adhering_length=150 * metre,
        material=NeoHooke(pascal, 0.2),
        law=VanDerWaals(1e-19, 0.4 * metre),
    )
    angles = np.radians(np.arange(0, 81, 2.0))
    space = row_space("N2.1", (120, 3))
    *_, ours = trace(strip(), space, angles)
    *_, theirs = trace(in_si, space, angles)
    assert theirs.reaction / (pascal * metre**2) == pytest.approx(ours.reaction, rel=1e-10)


def test_enriching_every_row_gives_the_richer_space() -> None:
    """N2+N4@4 on four rows is N4."""
    angle, elements = 20.0, (40, 3)
    assert moment_at(angle, "N2+N4@4", elements, 5.0) == pytest.approx(
        moment_at(angle, "N4", elements, 5.0), rel=1e-12
    )


def test_steps_are_immutable_and_numbered() -> None:
    steps = list(trace(strip(), row_space("L1", (20, 2)), np.radians([0.0, 1.0, 2.0])))
    assert [step.number for step in steps] == [0, 1, 2]
    assert steps[0].reaction == pytest.approx(0.0, abs=1e-14)
    with pytest.raises(ValueError, match="read-only"):
        steps[0].displacement[0, 0] = 1.0
    with pytest.raises(AttributeError):
        steps[0].reaction = 1.0  # type: ignore[misc]


def test_a_failed_step_reports_its_cause() -> None:
    with pytest.raises(ConvergenceError, match="inverted: det F = -"):
        list(trace(strip(), row_space("L1", (200, 10)), [0.0, 1.5]))


def test_a_step_that_does_not_settle_shows_its_iterations() -> None:
    system = System(strip(), row_space("N2", (60, 3)))
    with pytest.raises(ConvergenceError, match="after 2 iterations") as caught:
        newton(system, np.zeros(system.constraints.count), 0.02, NewtonSettings(iteration_limit=2))
    assert len(caught.value.iterations) == 2
    assert caught.value.iterations[1] < caught.value.iterations[0]


def test_the_plain_method_ends_at_the_published_angle() -> None:
    """L1 on 160 x 8 in steps of 0.1 degree does not converge, as published: a limit point."""
    angles = np.radians(np.arange(0, 150, 0.1))
    steps = trace(strip(), row_space("L1", (160, 8)), angles, NewtonSettings(plain=True))
    reached: list[float] = []
    with pytest.raises(ConvergenceError):
        reached.extend(np.degrees(step.parameter) for step in steps)
    assert 54 < reached[-1] < 100  # on the plateau, past the onset


def test_an_indefinite_tangent_falls_back_to_lu() -> None:
    system = System(strip(), row_space("L1", (20, 2)))
    u = np.zeros((system.space.size, 2))
    u[:16, 1] = 0.2  # the adhering face lifted: the law softens there
    _, matrix = system.linearize(u)
    with pytest.raises(NotPositiveDefiniteError):
        factorize(matrix)
    state, matrix = system.linearize(u, "general")
    solution = factorize(matrix).solve(state.residual)
    step = 1e-6
    ahead = system.constraints.condense(
        system.equilibrium(u + step * system.constraints.displacement(solution, 0.0)).forces
    )
    np.testing.assert_allclose(
        (ahead - state.residual) / step, state.residual, atol=1e-4
    )  # forward difference


def test_both_factorizations_solve_the_same_system() -> None:
    system = System(strip(), row_space("N2", (20, 3)))
    u = np.zeros((system.space.size, 2))
    right_side = np.random.default_rng(0).standard_normal(system.constraints.count)
    by_cholesky = factorize(system.linearize(u)[1])
    assert isinstance(by_cholesky, BandCholesky)
    one = by_cholesky.solve(right_side)
    by_lu = factorize(system.linearize(u, "general")[1])
    assert isinstance(by_lu, BandLU)
    np.testing.assert_allclose(one, by_lu.solve(right_side), rtol=1e-10)  # condition number about 1e5


def test_predictor_is_exact_for_parabolas() -> None:
    def state(x: float) -> np.ndarray:
        return np.array([1 + x, 2 - x + 3 * x**2])

    history = {x: state(x) for x in (0.0, 0.3, 0.4)}
    np.testing.assert_allclose(extrapolate(history, 0.9, 2), state(0.9), rtol=1e-14)
    np.testing.assert_array_equal(extrapolate({}, 0.9, 2), np.zeros(2))


def test_a_drive_may_turn_back() -> None:
    """Up, down and up again: with reversible adhesion the path returns through the same states."""
    angles = np.radians([0.0, 2.0, 4.0, 2.0, 4.0, 4.0, 0.0])
    moments = [step.reaction for step in trace(strip(), row_space("N2", (60, 3)), angles)]
    np.testing.assert_allclose(moments[3:5], moments[1:3], rtol=1e-9)  # what the tolerance leaves
    assert moments[5] == pytest.approx(moments[4], rel=1e-9)
    assert moments[6] == pytest.approx(0.0, abs=1e-9)


def test_a_path_continues_from_stored_states() -> None:
    angles = np.radians(np.arange(0, 61, 4.0))
    whole = list(trace(strip(), row_space("N2.1", (60, 3)), angles))
    start = [State(step.parameter, step.displacement) for step in whole[4:11]]
    rest = list(trace(strip(), row_space("N2.1", (60, 3)), angles[11:], start=start))
    for step, known in zip(rest, whole[11:], strict=True):
        # the same equilibria by another tangent: what the tolerance leaves
        assert step.reaction == pytest.approx(known.reaction, rel=1e-9)


def test_a_start_of_another_space_is_refused() -> None:
    with pytest.raises(InputError, match="start"):
        trace(strip(), row_space("N2", (20, 2)), [0.1], start=[State(0.0, np.zeros((5, 2)))])


@pytest.mark.chord_tangent
def test_a_start_with_the_history_of_another_joint_is_refused() -> None:
    """Compiled loops would read beyond its end."""
    space = row_space("N2", (20, 2))
    path = trace(strip(), space, np.radians([0.0, 0.1, 0.2]))
    state = [next(path), next(path)][-1].state
    assert state.solver_state is not None
    solver_state = replace(state.solver_state, maximum_openings=np.zeros((1, 1)))
    with pytest.raises(InputError, match=r"start: \(1, 1\) cannot be used"):
        trace(strip(), space, [0.004], start=[state._replace(solver_state=solver_state)])


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"tolerance": 0.0}, r"settings\.tolerance: 0\.0 cannot be used; it must be positive"),
        ({"tolerance": np.nan}, r"settings\.tolerance: nan cannot be used; it must be positive"),
        ({"iteration_limit": 0}, r"settings\.iteration_limit: 0 cannot be used; it must be at least 1"),
        (
            {"path_control": "newtn"},
            r"settings\.path_control: 'newtn' cannot be used; it is one of newton, auto",
        ),
    ],
)
def test_settings_are_checked(values: dict[str, Any], message: str) -> None:
    """An unknown path control was taken for continuation."""
    with pytest.raises(InputError, match=message):
        NewtonSettings(**values)


def test_constraints_map_there_and_back() -> None:
    system = System(strip(), row_space("N2.1", (12, 3)))
    constraints = system.constraints
    z = np.random.default_rng(2).standard_normal(constraints.count)
    u = constraints.displacement(z, 0.4)
    np.testing.assert_allclose(constraints.unknown_values(u, 0.4), z, rtol=0, atol=1e-14)  # one subtraction
    face = system.space.side_functions("right")
    points = np.stack([np.full(4, 200.0), np.linspace(0, 10, 4)], axis=1)
    arms = (points + u[face])[1:] - (points + u[face])[:-1]
    # the face stays straight, keeps its length and has turned by 0.4
    np.testing.assert_allclose(np.linalg.norm(arms, axis=1), 10 / 3, rtol=1e-14)
    np.testing.assert_allclose(np.arctan2(-arms[:, 0], arms[:, 1]), 0.4, rtol=1e-13)
    assert np.all(u[system.space.side_functions("left"), 0] == 0)
