"""Jumps: past a limit point the path goes on from the next stable equilibrium, with the energy released."""

from dataclasses import replace

import numpy as np
import pytest

from isopeel.assembly.system import System
from isopeel.common.errors import InputError
from isopeel.matrix.factorize import factorize
from isopeel.problem import MovedSide, PulledSide, strip
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.descent import descend, potential_energy
from isopeel.solve.newton import NewtonSettings, newton
from isopeel.solve.step import Step
from isopeel.solve.trace import trace
from isopeel.splines.rows import row_space

# of the published study: plain Newton ends at 69.0 degrees, in print and here
SPACE = row_space("L1", (160, 8))
ANGLES = np.radians(np.arange(0.0, 74.05, 0.1))


@pytest.fixture(scope="module")
def path() -> list[Step]:
    return list(trace(strip(), SPACE, ANGLES, NewtonSettings(path_control="auto", plain=True)))


def energy(step: Step) -> float:
    return step.stored_energy + step.adhesive_energy


def test_the_path_continues_where_plain_newton_ends(path: list[Step]) -> None:
    plain: list[Step] = []
    steps = trace(strip(), SPACE, ANGLES, NewtonSettings(plain=True))
    with pytest.raises(ConvergenceError, match=r"no equilibrium at 1\.20"):
        plain.extend(iter(lambda: next(steps), None))
    # with the steps that were cut between, and the jumps that these have located
    requested = set(ANGLES.tolist())
    assert [step.parameter for step in path if step.parameter in requested] == ANGLES.tolist()
    assert np.degrees(plain[-1].parameter) == pytest.approx(68.9, abs=0.05)
    # the two are one path up to the first step that is cut: plain Newton has passed a snap-back there, whose
    # limit point is at 65.485 degrees by the continued curve
    first = next(k for k, step in enumerate(path) if step.kind != "requested")
    assert 65.4 < np.degrees(path[first].parameter) < 65.5
    assert [step.reaction for step in path[:first]] == [step.reaction for step in plain[:first]]


def test_energy_is_released_by_a_jump(path: list[Step]) -> None:
    """Work of the drive = energy gained + energy released, in the step of the largest jump."""
    largest = max(range(1, len(path)), key=lambda k: path[k].released_energy)
    released = path[largest].released_energy
    assert released > 1e-5
    reaction = np.array([step.reaction for step in path[largest - 2 : largest]])
    steps = path[largest - 1 : largest + 1]
    size = steps[1].parameter - steps[0].parameter
    # the moment falls somewhere in the step: at its start, or at the end of the extrapolated branch
    late = size * (reaction[1] + (reaction[1] - reaction[0]) / 2)
    early = size * steps[1].reaction
    gained = energy(steps[1]) - energy(steps[0])
    assert early - gained < released < late - gained
    # before it the steps are smooth: the rule's error
    before = [abs(step.released_energy) for step in path[:600]]
    assert max(before) < 1e-2 * released


def test_letting_go_releases_what_the_side_was_held_with() -> None:
    """Lifted by its whole end face, which is then released at once: energy is released without work."""
    lift = replace(strip(length=60.0, height=4.0, adhering_length=40.0), drive=MovedSide("right", np.pi / 2))
    space = row_space("N2", (60, 2))
    lifted = list(trace(lift, space, np.linspace(0.0, 1.0, 11)))[-1]
    let_go = replace(lift, drive=MovedSide("left", np.pi / 2))
    (rest,) = trace(let_go, space, [0.0], base=lifted.state)
    assert rest.released_energy == pytest.approx(energy(lifted) - energy(rest), rel=1e-12)
    # all that bent the free arm: half of force times displacement, where all is linear
    assert rest.released_energy == pytest.approx(lifted.reaction / 2, rel=0.05)


def test_a_jump_ends_in_a_stable_state(path: list[Step]) -> None:
    jump = next(step for step in path if step.released_energy)
    system = System(strip(), SPACE)
    _, matrix = system.linearize(jump.displacement)
    factorize(matrix)  # Cholesky: the tangent is positive definite
    assert matrix.storage == "symmetric"


def test_the_energy_falls_along_the_path() -> None:
    system = System(strip(), row_space("N2", (40, 2)))
    start = np.zeros(system.count)
    parameter = 0.4
    found = descend(system, start, parameter).unknown_values
    assert potential_energy(system, found, parameter) < potential_energy(system, start, parameter)
    result = newton(system, found, parameter, NewtonSettings())
    # it ends next to the minimum: one or two corrections are left
    assert len(result.iterations) <= 2


def test_an_unknown_load_keeps_its_displacement() -> None:
    problem = replace(
        strip(length=60.0, height=4.0, adhering_length=40.0), drive=PulledSide("right", np.pi / 2)
    )
    system = System(problem, row_space("N2", (60, 2)))
    found = descend(system, np.zeros(system.count), 2.0).unknown_values
    u, _ = system.state(found, 2.0)
    # a linear equation, solved by steps
    assert system.control.displacement(u) == pytest.approx(2.0, rel=1e-12)


def test_a_jump_without_a_start_is_reported() -> None:
    """A side pushed through the body in one step: there is no start whose elements are all sound."""
    pushed = replace(strip(), drive=MovedSide("right", np.pi, "held"))
    with pytest.raises(ConvergenceError, match="an element is inverted"):
        list(trace(pushed, row_space("N2", (40, 2)), [300.0], NewtonSettings(path_control="auto")))


def test_a_load_at_rest_converges_at_once() -> None:
    """At the parameter zero the control is met to round-off, which must not count as astray."""
    problem = replace(
        strip(length=60.0, height=4.0, adhering_length=40.0), drive=PulledSide("right", np.pi / 2)
    )
    system = System(problem, row_space("N2", (60, 2)))
    start = 1e-3 * np.random.default_rng(4).standard_normal(system.count)
    found = descend(system, start, 0.0).unknown_values
    result = newton(system, found, 0.0, NewtonSettings())
    # all that is left is the tolerance of Newton's method
    np.testing.assert_allclose(result.displacement, 0.0, rtol=0, atol=1e-7)


def test_forces_without_an_energy_cannot_jump() -> None:
    projected = strip(traction="projected")
    following = replace(strip(), drive=PulledSide("right", 1.0, follows=True))
    for problem in (projected, following):
        with pytest.raises(InputError, match=r"drive.path_control"):
            trace(problem, row_space("L1", (20, 2)), [0.0], NewtonSettings(path_control="jump"))
    trace(replace(strip(), drive=MovedSide("right", 0.0)), SPACE, [0.0], NewtonSettings(path_control="auto"))
