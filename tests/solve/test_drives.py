"""Drives: consistent tangents, Newton's convergence, energies, stages, and elementary closed forms."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.matrix.bordered import Border, Bordered
from isopeel.matrix.factorize import factorize
from isopeel.physics.adhesion import Exponential
from isopeel.physics.materials import NeoHooke
from isopeel.problem import (
    Boundary,
    Drive,
    Load,
    MovedSide,
    Problem,
    PulledSide,
    RotatedSide,
    Support,
    strip,
)
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.step import Step
from isopeel.solve.trace import trace
from isopeel.splines.rows import row_space

# weaker and softer than the strip's, so that a coarse mesh resolves the front
LAW = Exponential(0.03, 0.015)
PART = Boundary("", "top", 0.7)
DRIVES: dict[str, tuple[Drive, float]] = {
    "rotation": (RotatedSide("right"), 0.3),
    "displacement": (MovedSide("right", np.pi / 2), 3.0),
    "held across": (MovedSide("right", np.pi / 3, "held"), 3.0),
    "force found": (PulledSide("right", np.pi / 2), 3.0),
    "force at an angle": (PulledSide("right", np.pi / 6), 1.0),
    "force raised": (PulledSide("right", np.pi / 2, control="force"), 1e-3),
    "following force": (PulledSide("right", np.pi / 2, follows=True), 3.0),
    "following force raised": (PulledSide("right", np.pi / 2, follows=True, control="force"), 1e-3),
    "on a part of the top": (PulledSide(Boundary("", "top", 0.7, 0.9), np.pi / 2), 2.0),
    "pressure on a part": (PulledSide(PART, -np.pi / 2, follows=True, control="force"), 1e-3),
}
SPACE = row_space("N2", (60, 2))


def problem(drive: Drive, sliding_length: float | None = None) -> Problem:
    made = strip(length=60.0, height=4.0, adhering_length=40.0, law=LAW)
    adhesion = replace(made.adhesion, sliding_length=sliding_length)
    return made.changed(drive=drive, adhesion=adhesion)


def path(drive: Drive, to: float, count: int = 21, settings: NewtonSettings | None = None) -> list[Step]:
    return list(trace(problem(drive, 0.3), SPACE, np.linspace(0.0, to, count), settings))


def residual(system: System, y: FloatArray, parameter: float) -> FloatArray:
    """All equations, with that of the load's displacement last."""
    u, load = system.state(y, parameter)
    equations = system.equilibrium(u, load).residual
    if not system.global_unknowns:
        return equations
    return np.append(equations, system.control.equation(u, parameter)[0])


@pytest.mark.parametrize("name", DRIVES)
def test_tangent_is_the_derivative_of_the_residual(name: str) -> None:
    """K dy of a solved system gives back dy: the tangent's factor against central differences."""
    drive, parameter = DRIVES[name]
    system = System(problem(drive, 0.3), row_space("N2", (20, 2)))
    rng = np.random.default_rng(3)
    y, direction = 0.02 * rng.standard_normal((2, system.count))
    change = (
        residual(system, y + 1e-5 * direction, parameter) - residual(system, y - 1e-5 * direction, parameter)
    ) / 2e-5
    u, load = system.state(y, parameter)
    factor = factorize(system.linearize(u, "general", load)[1])
    if system.global_unknowns:
        _, column, row = system.control.equation(u, parameter)
        factor = Bordered.of(factor, Border(column, row))
    # central differences of step 1e-5 leave 1e-10 of the third derivative, which the solution enlarges
    np.testing.assert_allclose(factor.solve(change), direction, rtol=0, atol=1e-6 * np.abs(direction).max())


@pytest.mark.parametrize("name", DRIVES)
def test_newton_converges_quadratically(name: str) -> None:
    """The energy residual goes with the fourth power of the error: its exponent doubles, until round-off."""
    drive, to = DRIVES[name]
    last = path(drive, to, 3, NewtonSettings(plain=True))[-1]
    large, small = last.iterations[-2], last.iterations[-1]
    scale = 60.0 * 4.0  # E times the area
    # the error squares, times a constant; an iteration that is linear would gain a few digits at most
    assert small < max(1e-28 * scale, 1e3 * (large / scale) ** 1.5 * scale)


#: Those with a potential.
DEAD = [name for name, (drive, _) in DRIVES.items() if not (isinstance(drive, Load) and drive.follows)]


@pytest.mark.parametrize("name", DEAD)
def test_work_of_the_drive_is_what_the_energies_take(name: str) -> None:
    drive, to = DRIVES[name]
    nodes, weights = np.polynomial.legendre.leggauss(8)
    ends = np.linspace(0.0, to, 7)
    places = [0.0]
    for start, end in pairwise(ends):
        places += [*(start + (end - start) * (nodes + 1) / 2), end]
    steps = list(trace(problem(drive, 0.3), SPACE, places))
    energy = np.array([s.stored_energy + s.adhesive_energy for s in steps])
    reaction = np.array([s.reaction for s in steps])
    work = sum(float(w @ reaction[1:].reshape(6, -1)[k, :-1]) for k, w in enumerate([weights * to / 12] * 6))
    if isinstance(drive, Load) and drive.control == "force":
        work = reaction[-1] * to - work  # integral of the force over the displacement
    # eight Gauss points integrate a smooth curve over a sixth of it to better than 1e-8
    assert energy[-1] - energy[0] == pytest.approx(work, rel=1e-6)


def test_work_of_a_following_force() -> None:
    """It has no potential: its work is the integral of force times q(u) . du along the path."""
    drive, to = DRIVES["following force"]
    system = System(problem(drive, 0.3), SPACE)
    steps = list(trace(problem(drive, 0.3), SPACE, np.linspace(0.0, to, 129)))
    (load,) = system.loads
    works = []
    for every in (2, 1):
        chosen = steps[::every]
        forces = [s.reaction * load.forces(s.displacement) for s in chosen]
        moves = [b.displacement - a.displacement for a, b in pairwise(chosen)]
        works.append(
            sum(float(np.sum((f + g) / 2 * du)) for (f, g), du in zip(pairwise(forces), moves, strict=True))
        )
    work = (4 * works[1] - works[0]) / 3  # the trapezoidal rule's error falls with the square of the step
    energy = [s.stored_energy + s.adhesive_energy for s in (steps[0], steps[-1])]
    assert energy[1] - energy[0] == pytest.approx(work, rel=1e-6)
    dead = list(trace(problem(PulledSide("right", np.pi / 2), 0.3), SPACE, np.linspace(0.0, to, 17)))
    # the force that follows has turned by now: it is another one
    assert abs(steps[-1].reaction / dead[-1].reaction - 1) > 1e-3


def test_unknown_and_prescribed_force_give_one_path() -> None:
    found = path(PulledSide("right", np.pi / 2), 3.0)
    forces = [s.reaction for s in found]
    raised = list(trace(problem(PulledSide("right", np.pi / 2, control="force"), 0.3), SPACE, forces))
    # two ways to solve one set of equations: to the tolerance of Newton's method
    np.testing.assert_allclose([s.reaction for s in raised], [s.parameter for s in found], rtol=0, atol=1e-9)


def test_a_bar_under_a_dead_force() -> None:
    """Stretched along its length while it slides on the substrate: E' times strain, to first order."""
    made = strip(length=60.0, height=4.0, adhering_length=1.0, material=NeoHooke(1.0, 0.3), law=LAW)
    pulled = replace(made, drive=PulledSide("right", 0.0, control="force"))
    (step,) = trace(pulled, row_space("N2", (30, 2)), [1e-6])
    # large strains add a share of the order of the strain, 2.5e-7; the adhesion holds the height of an end
    assert step.reaction == pytest.approx(1e-6 / 4.0 * (1 - 0.3**2) * 60.0, rel=1e-4)


def test_a_clamp_moves_along_a_slanted_line() -> None:
    last = path(MovedSide("right", np.pi / 3, "held"), 3.0)[-1]
    side = last.displacement[SPACE.side_functions("right")]
    np.testing.assert_allclose(side, np.broadcast_to([1.5, 3.0 * np.sqrt(0.75)], side.shape), rtol=1e-15)


def test_stages_go_on_where_the_last_one_ended() -> None:
    """Lifted by 2, and by 1 more as a second stage: the same as lifted by 3; then turned where it is."""
    lift = problem(MovedSide("right", np.pi / 2, "held"))
    whole = list(trace(lift, SPACE, np.linspace(0.0, 3.0, 31)))
    first = list(trace(lift, SPACE, np.linspace(0.0, 2.0, 21)))
    base = first[-1].state
    second = list(trace(lift, SPACE, np.linspace(0.0, 1.0, 11), base=base))
    # two paths to the same equilibria: to the tolerance of Newton's method
    np.testing.assert_allclose(second[-1].displacement, whole[-1].displacement, rtol=0, atol=1e-8)
    assert second[0].reaction == pytest.approx(first[-1].reaction, rel=1e-9)
    turned = replace(lift, drive=RotatedSide("right"))
    # its centre becomes free, so that the force goes, and only the side's line is kept
    steps = list(trace(turned, SPACE, np.radians(np.linspace(0.0, 20.0, 41)), base=base))
    side = SPACE.side_functions("right")
    line = np.array([60.0, 0.0]) + steps[-1].displacement[side] + [[0.0, 0.0], [0.0, 2.0], [0.0, 4.0]]
    edge = line[-1] - line[0]
    np.testing.assert_allclose(edge, 4.0 * np.array([-np.sin(np.pi / 9), np.cos(np.pi / 9)]), rtol=1e-12)


def test_a_force_that_is_unknown_continues_in_a_stage() -> None:
    pull = problem(PulledSide("right", np.pi / 2))
    whole = list(trace(pull, SPACE, np.linspace(0.0, 3.0, 31)))
    base = list(trace(pull, SPACE, np.linspace(0.0, 2.0, 21)))[-1].state
    second = list(trace(pull, SPACE, np.linspace(0.0, 1.0, 11), base=base))
    # two paths to the same equilibria: to the tolerance of Newton's method
    np.testing.assert_allclose([s.reaction for s in second], [s.reaction for s in whole[20:]], rtol=1e-8)
    back = list(trace(pull, SPACE, np.linspace(0.0, -2.0, 21), base=base))[-1]
    assert back.reaction == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(back.displacement, 0.0, rtol=0, atol=1e-7)


@pytest.mark.parametrize("name", DRIVES)
def test_a_path_continues_from_the_last_states_bit_for_bit(name: str) -> None:
    drive, to = DRIVES[name]
    steps, states = [], []
    for step in trace(problem(drive, 0.3), SPACE, np.linspace(0.0, to, 24)):
        steps.append(step)
        states.append(step.state)  # which has the solver state as long as the path exists
    later = [s.parameter for s in steps[14:]]
    again = list(trace(problem(drive, 0.3), SPACE, later, start=[states[13]]))
    for one, other in zip(again, steps[14:], strict=True):
        assert one.reaction == other.reaction
        np.testing.assert_array_equal(one.displacement, other.displacement)


@pytest.mark.parametrize(
    ("drive", "fixed", "motion"),
    [
        (PulledSide("right", 0.0, control="force"), (), "along x"),
        (MovedSide("right", np.pi / 2), (), "along x"),
        (RotatedSide("right"), (), "along x"),
    ],
)
def test_a_free_rigid_motion_is_refused(drive: Drive, fixed: tuple[Support, ...], motion: str) -> None:
    free = problem(drive).changed(supports=fixed)
    with pytest.raises(InputError, match=f"held: 'a motion {motion}' cannot be used"):
        System(free, SPACE)
    System(free.changed(adhesion=replace(free.adhesion, sliding_length=0.3)), SPACE)  # held by adhesion


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: MovedSide("right", 0.3), "drive.angle: 0.3 cannot be used; at this angle"),
        (lambda: MovedSide("right", float("nan"), "held"), "drive.angle: nan"),
        (lambda: MovedSide("right", 0.0, "loose"), "drive.transverse: 'loose'"),  # type: ignore[arg-type]
        (lambda: PulledSide("east", 0.0), "drive.side: 'east'"),  # type: ignore[arg-type]
        (lambda: PulledSide(Boundary("", "top", 0.5, 0.5), 0.0), "need 0 <= start < end <= 1"),
        (lambda: PulledSide("top", 0.0, control="wish"), "drive.control: 'wish'"),  # type: ignore[arg-type]
        (lambda: PulledSide("top", float("inf")), "drive.angle: inf"),
    ],
)
def test_drives_that_make_no_sense(make: object, message: str) -> None:
    assert callable(make)
    with pytest.raises(InputError, match=message):
        make()
