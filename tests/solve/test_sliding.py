"""A cylinder that slides without friction: no work is done, and no energy is gained."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from isopeel import Body, Contact, Interface, MovedSide, NeoHooke, Problem, Step, Support, row_space, trace
from isopeel.problem.place import placed
from isopeel.problem.shapes.curved_strip import CurvedStrip
from isopeel.solve.balance import GAIN, MISFIT, Misfit, allowance, misfit
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.step import AcceptedState
from isopeel.splines.nurbs import rectangle

AUTO = NewtonSettings(path_control="auto")
STRIP = (0.6, 0.3)
SPACES = {
    "roller": row_space("N2", (24, 3), 2, (1.0, 8.0)),
    "strip": row_space("L2", (40, 3), 2, (1.0, 0.125)),
}


def pressed() -> Problem:
    """A soft layer on a rigid cylinder is pressed onto a strip of Lagrange elements, which has corners."""
    arc = 0.3
    shape = placed(
        CurvedStrip(arc, 0.3, 1.0, "up").surface(), (-np.sin(arc / 2), 1 - np.cos(arc / 2)), -arc / 2
    )
    roller = Body(shape, NeoHooke(1.0, 0.3), "roller")
    strip = Body(placed(rectangle(*STRIP), (-STRIP[0] / 2, -STRIP[1]), 0.0), NeoHooke(1.0, 0.3), "strip")
    joint = Interface(roller.side("bottom"), Contact(), strip.side("top"))
    press = MovedSide(roller.side("top"), -np.pi / 2, "held")
    return Problem("roller", (roller, strip), (joint,), (Support(strip.side("bottom"), (0, 1)),), press)


def energy(step: Step) -> float:
    return step.stored_energy + step.adhesive_energy


@pytest.fixture(scope="module")
def steps() -> list[Step]:
    problem = pressed()
    *_, last = trace(problem, SPACES, np.linspace(0.0, 0.004, 5), AUTO)
    slide = replace(problem, drive=MovedSide(problem.bodies[0].side("top"), 0.0, "held"))
    path = np.arange(0.0, 0.031, 0.006)
    return list(trace(slide, SPACES, path, AUTO, base=last.state))


def test_a_cylinder_slides_over_corners_without_a_jump(steps: list[Step]) -> None:
    """The work of each step is that of the mesh, which the trapezoidal rule misses: it counted as a gain."""
    assert [step.parameter for step in steps if step.kind == "requested"] == pytest.approx(
        np.arange(0.0, 0.031, 0.006)
    )
    assert {step.kind for step in steps} <= {"requested", "between"}
    for one, other in pairwise(steps):
        work = (one.reaction + other.reaction) / 2 * (other.parameter - one.parameter)
        gained = energy(other) - energy(one) - work
        # what a step may gain, and the error of the trapezoidal rule that it estimates: as much again
        assert gained < 2 * GAIN * energy(one) + MISFIT * abs(work)


def test_sliding_takes_no_force(steps: list[Step]) -> None:
    """But that of the mesh: the closed form is zero."""
    load = 1.3e-3  # pressed, see the benchmark `sliding`
    assert max(abs(step.reaction) for step in steps) < 1e-3 * load


def accepted(energies: list[float]) -> list[AcceptedState]:
    nothing = np.zeros(0)
    return [AcceptedState(0.1 * n, nothing, one, 1e-9, 0.0) for n, one in enumerate(energies)]


def judged(joint: float | None, gain: float) -> Misfit:
    """States of the energy 2 that do no work, and one that has gained."""
    *before, last = accepted([2.0, 2.0, 2.0, 2.0 + gain])
    return misfit(before, last, allowance(joint, before[-1], 1e-15), 1e-15)


def test_contact_may_gain_a_share_of_the_stored_energy_and_no_more() -> None:
    assert judged(None, 0.9 * GAIN * 2.0).fits
    assert judged(None, 1.1 * GAIN * 2.0).gains
    assert judged(None, -1.1 * GAIN * 2.0).releases


def test_a_joint_that_adheres_may_gain_a_share_of_the_work_only() -> None:
    """As before: of a step without work nothing but round-off, whatever the energy of the joint."""
    assert allowance(2.0, None, 0.0).of_step(1e-5) == pytest.approx(1e-8, rel=1e-12)
    assert judged(2.0, 0.9 * GAIN * 2.0).gains
    assert not judged(2.0, 1e-12).gains
