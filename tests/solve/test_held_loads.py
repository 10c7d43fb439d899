"""Loads that are held while the drive moves: closed forms, the balance of energy, supports, stages."""

import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from isopeel import (
    Body,
    HeldLoad,
    InputError,
    MovedSide,
    NeoHooke,
    NewtonSettings,
    Problem,
    PulledSide,
    RotatedSide,
    Support,
    row_space,
    strip,
    support_reactions,
    trace,
)
from isopeel.assembly.system import System
from isopeel.common.path_control import PathControl
from isopeel.physics.adhesion import Exponential
from isopeel.problem import Drive
from isopeel.solve.convergence import ConvergenceError
from isopeel.splines.nurbs import rectangle

BAR = Body(rectangle(20.0, 2.0), NeoHooke(3.0, 0.2))
STIFFNESS = 3.0 / (1 - 0.2**2) * 2.0 / 20.0
ON_ROLLERS = (Support(BAR.side("left"), (0,)), Support(BAR.side("bottom"), (1,)))


def test_a_bar_with_a_load_along_it() -> None:
    """Its ends share the load: R = E' h u/L - F/2; the load works on the mean displacement of its side."""
    load = HeldLoad(BAR.side("top"), 1e-6, 0.0)
    problem = Problem("bar", (BAR,), (), ON_ROLLERS, MovedSide("right", 0.0), (load,))
    space = row_space("N2", (8, 2))
    moves = np.linspace(0.0, 2e-5, 5)
    steps = list(trace(problem, space, moves))
    # in proportion to the strain, 1e-6, and to the load, by the symmetry of both ends
    np.testing.assert_allclose([step.reaction for step in steps], STIFFNESS * moves - 5e-7, rtol=1e-5)
    for step in steps:
        held = support_reactions(problem, space, step)
        # the forces on the bar are in balance, to the tolerance of the solver
        assert held["body.left"][0] + step.reaction + 1e-6 == pytest.approx(0.0, abs=1e-13)
        assert held["body.left"][1] == 0.0
        assert held["body.bottom"][1] == pytest.approx(0.0, abs=1e-12)
    # by the linear part of the displacement, u/2 on the mean
    assert steps[-1].load_work is not None
    assert steps[0].load_work is not None
    assert steps[-1].load_work - steps[0].load_work == pytest.approx(1e-6 * 1e-5, rel=1e-4)


def test_a_propped_cantilever() -> None:
    """Its end is kept at a height w under a load q L along it: R = 3 E'I w/L^3 + 3 q L/8 (beam theory)."""
    beam = Body(rectangle(80.0, 1.0), NeoHooke(1.0, 0.0))
    load = HeldLoad(beam.side("top"), 1e-8, -np.pi / 2)
    prop = PulledSide("right", np.pi / 2)
    problem = Problem("beam", (beam,), (), (Support(beam.side("left"), (0, 1)),), prop, (load,))
    heights = np.array([0.0, 0.01, 0.02])
    steps = list(trace(problem, row_space("N2.1", (40, 1), 2), heights))
    expected = 3 / 12 / 80.0**3 * heights + 3 / 8 * 1e-8
    # shear adds a share of the square of height over length, 2e-4
    np.testing.assert_allclose([step.reaction for step in steps], expected, rtol=1e-3)


DRIVES: dict[str, tuple[Drive, float]] = {
    "rotation": (RotatedSide("right"), 0.3),
    "displacement": (MovedSide("right", np.pi / 2), 3.0),
    "force found": (PulledSide("right", np.pi / 2), 3.0),
    "force raised": (PulledSide("right", np.pi / 2, control="force"), 1e-3),
}
SPACE = row_space("N2", (60, 2))


def peeled(drive: Drive) -> Problem:
    made = strip(length=60.0, height=4.0, adhering_length=40.0, law=Exponential(0.03, 0.015))
    made = made.changed(drive=drive, adhesion=replace(made.adhesion, sliding_length=0.3))
    return replace(made, loads=(HeldLoad(made.body.side("top", 0.6, 0.8), 4e-4, -np.pi / 3),))


@pytest.mark.parametrize("name", DRIVES)
def test_energies_take_the_work_of_drive_and_load(name: str) -> None:
    drive, to = DRIVES[name]
    nodes, weights = np.polynomial.legendre.leggauss(8)
    places = [0.0]
    for start, end in pairwise(np.linspace(0.0, to, 7)):
        places += [*(start + (end - start) * (nodes + 1) / 2), end]
    steps = list(trace(peeled(drive), SPACE, places))
    reaction = np.array([step.reaction for step in steps])
    work = float(np.sum(np.tile(np.append(weights, 0.0), 6) * reaction[1:])) * to / 12
    if name == "force raised":
        work = reaction[-1] * to - work
    loads = [step.load_work for step in steps if step.load_work is not None]
    energy = [step.stored_energy + step.adhesive_energy for step in steps]
    # eight Gauss points integrate a smooth curve over a sixth of it to better than 1e-8
    assert energy[-1] - energy[0] == pytest.approx(work + loads[-1] - loads[0], rel=1e-6)
    assert abs(loads[-1] - loads[0]) > 1e-3 * abs(work)


def test_a_load_is_held_in_the_next_stage() -> None:
    """Lifted by 2 and then by 1 is lifted by 3, under the same load; its work counts from the stage on."""
    problem = peeled(MovedSide("right", np.pi / 2, "held"))
    whole = list(trace(problem, SPACE, np.linspace(0.0, 3.0, 31)))
    base = list(trace(problem, SPACE, np.linspace(0.0, 2.0, 21)))[-1].state
    second = list(trace(problem, SPACE, np.linspace(0.0, 1.0, 11), base=base))
    # two paths to the same equilibria: to the tolerance of the chord method
    np.testing.assert_allclose(second[-1].displacement, whole[-1].displacement, rtol=0, atol=1e-7)
    assert second[-1].reaction == pytest.approx(whole[-1].reaction, rel=1e-9)
    works = [whole[k].load_work for k in (20, 30)]
    assert works[0] is not None
    assert works[1] is not None
    assert second[-1].load_work == pytest.approx(works[1] - works[0], rel=1e-7)


@pytest.mark.parametrize("name", DRIVES)
def test_a_path_with_a_load_continues_bit_for_bit(name: str) -> None:
    drive, to = DRIVES[name]
    steps, states = [], []
    for step in trace(peeled(drive), SPACE, np.linspace(0.0, to, 16)):
        steps.append(step)
        states.append(step.state)
    again = trace(peeled(drive), SPACE, [step.parameter for step in steps[9:]], start=[states[8]])
    for one, other in zip(again, steps[9:], strict=True):
        assert (one.reaction, one.load_work) == (other.reaction, other.load_work)
        np.testing.assert_array_equal(one.displacement, other.displacement)


def test_loads_that_make_no_sense() -> None:
    side = BAR.side("top")
    for force, angle, message in (
        (0.0, 0.0, "load.force: 0.0 cannot be used; it must be finite, and not zero"),
        (float("inf"), 0.0, "load.force: inf"),
        (1.0, float("nan"), "load.angle: nan"),
    ):
        with pytest.raises(InputError, match=message):
            HeldLoad(side, force, angle)
    problem = Problem("bar", (BAR,), (), ON_ROLLERS, MovedSide("right", 0.0))
    space = row_space("N2", (8, 2))
    for end in (BAR.side("left"), BAR.side("right")):
        load = HeldLoad(end, 1.0, 0.0)
        with pytest.raises(InputError, match=f"held: '{end.side}' cannot be used; a load that is held acts"):
            System(replace(problem, loads=(load,)), space)
    with pytest.raises(InputError, match="body: 'other' cannot be used; the bodies are body"):
        replace(problem, loads=(HeldLoad(replace(BAR, name="other").side("top"), 1.0, 0.0),))


#: A cantilever, and a load at its end that bends it by nearly a right angle.
BEAM = Body(rectangle(40.0, 1.0), NeoHooke(1.0, 0.0))
HEAVY = 1e-3


def test_a_load_that_is_too_large_for_one_step_is_applied_in_parts() -> None:
    """The end state is that of a force which the drive raises to the same size."""
    end, clamped = BEAM.side("right"), (Support(BEAM.side("left"), (0, 1)),)
    space = row_space("N2.1", (20, 1), 2)
    held = Problem(
        "held",
        (BEAM,),
        (),
        clamped,
        PulledSide("top", 0.0, control="force"),
        (HeldLoad(end, HEAVY, np.pi / 2),),
    )
    (first,) = trace(held, space, [0.0])
    raised = replace(held, drive=PulledSide("right", np.pi / 2, control="force"), loads=())
    *_, last = trace(raised, space, np.linspace(0.0, HEAVY, 41))
    # two paths to one equilibrium: to the tolerance of the solver
    np.testing.assert_allclose(first.displacement, last.displacement, rtol=0, atol=1e-6)
    assert np.abs(first.displacement).max() > 20


def beyond_the_largest(control: PathControl, force: float) -> ConvergenceError:
    """The error under a load above a joint that bears its strength times its length, 0.03 times 40."""
    made = peeled(MovedSide("right", 0.0))
    load = HeldLoad(made.body.side("top", 0.0, 2 / 3), force, np.pi / 2)
    with pytest.raises(ConvergenceError) as caught:
        list(trace(replace(made, loads=(load,)), SPACE, [0.0], NewtonSettings(path_control=control)))
    assert caught.value.cause == "held load"
    assert "make the held loads smaller" in caught.value.hint
    return caught.value


@pytest.mark.parametrize("force", [1.3, 10.0, 1e4])
@pytest.mark.parametrize("control", ["newton", "auto", "jump", "continuation"])
def test_a_load_beyond_the_largest_is_named_as_that(control: PathControl, force: float) -> None:
    reason = beyond_the_largest(control, force).reason
    (share,) = re.findall(r"an equilibrium is found under ([\d.]+) % of the held loads", reason)
    # the load is uniform above the joint, which opens nearly evenly
    assert 0.97 * 1.2 < float(share) / 100 * force <= 1.2


def test_a_load_far_beyond_the_largest_has_no_share() -> None:
    assert beyond_the_largest("auto", 1e8).reason.endswith("even under 1e-06 of the held loads")
