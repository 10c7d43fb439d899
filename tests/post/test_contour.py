"""The J-integral of fronts and the means over sections, compared with closed forms."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from two_arms_apart import LAW, SOFT, one, run_of, steps_of, two

from isopeel import (
    Body,
    Contact,
    Exponential,
    Flat,
    HeldLoad,
    Interface,
    Problem,
    PulledSide,
    RotatedSide,
    Step,
    Support,
    XuNeedleman,
    row_space,
)
from isopeel.assembly.spaces import SpaceOfBodies
from isopeel.physics.joints import JointLaw
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.physics.substrates import Circle
from isopeel.post.contour import JIntegral, j_integral
from isopeel.post.findings import find
from isopeel.post.sections import section_means
from isopeel.post.table import write_curve
from isopeel.problem.place import placed
from isopeel.problem.tie import Tie
from isopeel.results.fields import StoredState
from isopeel.splines.nurbs import annulus_sector, rectangle

MODULUS = plane_strain_modulus(SOFT)
X = np.array([1.0, 0.0])


def j_of(problem: Problem, space: SpaceOfBodies, step: Step, interface: str = "") -> JIntegral:
    found = j_integral(problem, space, StoredState.of(step, problem.drive), interface)
    assert isinstance(found, JIntegral), found
    return found


def test_sections_of_a_bent_arm_have_its_moment_and_the_energy_of_a_beam() -> None:
    arm = Body(rectangle(30.0, 3.0), SOFT, "arm")
    held = Support(arm.side("left"), (0, 1))
    problem = Problem("arm", (arm,), (), (held,), RotatedSide("right"))
    space = row_space("N2.1", (30, 2), 2)
    *_, step = steps_of(problem, space, np.radians([5.0, 10.0]))
    stretch = arm.side("bottom", 0.41, 0.77)
    means = section_means(problem, space, step.displacement, stretch, X, np.array([3.0, -7.0]))
    moment = step.reaction
    # a free body: the same moment about any point, to the error of the stresses
    assert means.moment == pytest.approx(moment, rel=1e-6)
    assert np.abs(means.force).max() < 1e-6 * moment
    # beam theory; the strain at the surface is 0.9 %
    assert means.energy == pytest.approx(-(moment**2) / (2 * MODULUS * 3.0**3 / 12), rel=1e-3)
    other = section_means(problem, space, step.displacement, arm.side("top", 0.3, 0.5), -X, np.zeros(2))
    # e and N turn together
    assert other.energy == pytest.approx(means.energy, rel=1e-5)
    assert other.moment == pytest.approx(-moment, rel=1e-6)


@pytest.mark.parametrize("problem", [one(), two(), two("biased")], ids=["mirrored", "unbiased", "biased"])
def test_a_front_that_moves_takes_the_work_of_adhesion(problem: Problem) -> None:
    space = row_space("N2", (60, 2), 2)
    spaces = {body.name: space for body in problem.bodies}
    *_, before, last = steps_of(problem, spaces, np.radians([5.0, 20.0, 40.0, 60.0, 80.0, 110.0]))
    for step in (before, last):
        found = j_of(problem, spaces, step)
        assert found.parted
        # the arm is not parted completely where it is cut, or the joint not closed
        assert 0 < found.neglected < 2e-3 * LAW.work_of_adhesion
        # what the mesh leaves, with six elements in the process zone
        assert found.value + found.neglected == pytest.approx(LAW.work_of_adhesion, rel=1.5e-3)


def test_j_does_not_depend_on_the_sections_and_before_peeling_it_is_what_the_moments_release() -> None:
    """G = M^2/(E'I) of two equal arms: each stores M^2/(2 E'I) per length, and the joined part nothing."""
    problem, space = two(), row_space("N2", (60, 2), 2)
    spaces = {"upper": space, "lower": space}
    *_, step = steps_of(problem, spaces, np.radians([3.0, 6.0, 9.0]))
    found = j_of(problem, spaces, step)
    assert not found.parted
    moment = step.reaction / 2
    # at a rotation of 9 degrees beams are straight within 0.2 %
    assert found.value == pytest.approx(moment**2 / (MODULUS * 3.0**3 / 12), rel=5e-3)
    means = [
        section_means(
            problem, spaces, step.displacement, problem.bodies[0].side("bottom", *part), X, X
        ).energy
        for part in ((0.75, 0.8), (0.8, 0.9), (0.9, 0.95))
    ]
    # stresses of degree 1 in each element
    assert np.ptp(means) < 1e-3 * abs(means[0])


@pytest.mark.parametrize("law", [XuNeedleman(0.03, 0.03, 0.02), Exponential(0.03, 0.02)])
def test_forces_that_pull_arms_apart_release_the_work_of_the_law(law: JointLaw | Exponential) -> None:
    """T-peel: 2 S + S^2/(E'h) = W, a balance of energies of the steady state, and J = W in each state."""
    length, height = 40.0, 2.0
    upper = Body(rectangle(length, height), SOFT, "upper")
    place = (0.0, -height - law.equilibrium_gap)
    lower = Body(placed(rectangle(length, height), place, 0.0), SOFT, "lower")
    joint = Interface(upper.side("bottom", end=0.75), law, lower.side("top", end=0.75))
    drive = PulledSide(((upper.side("right"), 1.0), (lower.side("right"), -1.0)), np.pi / 2)
    held = Support(upper.side("left"), (0, 1)), Support(lower.side("left"), (0, 1))
    problem, space = Problem("peel", (upper, lower), (joint,), held, drive), row_space("N2", (80, 2), 2)
    spaces = {"upper": space, "lower": space}
    *_, step = steps_of(problem, spaces, np.linspace(0.0, 28.0, 15)[1:])
    found = j_of(problem, spaces, step)
    assert found.parted
    assert found.value + found.neglected == pytest.approx(law.work_of_adhesion, rel=2e-3)


def test_j_of_a_tape_that_holds_along_a_substrate_is_the_work_of_adhesion() -> None:
    tape = Body(rectangle(40.0, 2.0), SOFT, "tape")
    law = Exponential(0.03, 0.02)
    substrate = Flat(-law.equilibrium_gap)
    joint = Interface(tape.side("bottom", end=0.75), law, substrate, sliding_length=0.5)
    held = Support(tape.side("left"), (0, 1))
    problem = Problem("tape", (tape,), (joint,), (held,), PulledSide(tape.side("right"), np.radians(60.0)))
    space = row_space("N2", (80, 2), 2)
    *_, step = steps_of(problem, space, np.linspace(0.0, 16.0, 17)[1:])
    found = j_of(problem, space, step)
    assert found.parted
    assert found.value + found.neglected == pytest.approx(law.work_of_adhesion, rel=2e-3)


@pytest.mark.parametrize("backing_elements", [80, 60])
def test_j_of_a_tape_of_tied_layers_is_the_work_of_adhesion(backing_elements: int) -> None:
    adhesive = Body(rectangle(40.0, 1.5), SOFT, "adhesive")
    stiff = replace(SOFT, youngs_modulus=4 * SOFT.youngs_modulus)
    backing = Body(placed(rectangle(40.0, 0.5), (0.0, 1.5), 0.0), stiff, "backing")
    joint = Interface(adhesive.side("bottom", end=0.75), LAW, Flat(-LAW.equilibrium_gap))
    held = Support(adhesive.side("left"), (0,)), Support(backing.side("left"), (0,))
    drive, tie = (
        PulledSide(backing.side("right"), np.pi / 2),
        Tie(backing.side("bottom"), adhesive.side("top")),
    )
    problem = Problem("tape", (adhesive, backing), (joint,), held, drive, ties=(tie,))
    spaces = {"adhesive": row_space("N2", (80, 2), 2), "backing": row_space("N2", (backing_elements, 1), 2)}
    *_, step = steps_of(problem, spaces, np.linspace(0.0, 20.0, 21)[1:])
    found = j_of(problem, spaces, step)
    assert found.parted
    assert found.value + found.neglected == pytest.approx(LAW.work_of_adhesion, rel=2e-3)


def test_points_without_a_partner_do_not_make_a_joint_part() -> None:
    """The upper arm ends beyond the lower one: J was compared with W before the joint had opened."""
    upper, lower = two().bodies
    lower = replace(lower, shape=placed(rectangle(21.0, 3.0), (0.0, -3.0), 0.0))
    joint = Interface(upper.side("bottom"), LAW, lower.side("top"), scheme="biased")
    held = Support(upper.side("left"), (0,)), Support(lower.side("bottom"), (0, 1))
    problem = Problem("short", (upper, lower), (joint,), held, RotatedSide(upper.side("right")))
    spaces = {"upper": row_space("N2", (60, 2), 2), "lower": row_space("N2", (42, 2), 2)}
    *_, step = steps_of(problem, spaces, np.radians([3.0]))
    found = j_of(problem, spaces, step)
    assert not found.parted
    # measured 2e-5, a thousandth of the work that parts the faces
    assert found.value < 0.01 * LAW.work_of_adhesion


@pytest.mark.parametrize("gap", [0.0, 20.0])
def test_a_note_names_faces_that_are_too_far_apart_for_their_law(gap: float) -> None:
    """Such a run ended with forces and jumps of round-off, and no word on their cause."""
    problem, space = two("biased"), row_space("N2", (30, 2), 2)
    upper, lower = problem.bodies
    away = replace(lower, shape=placed(lower.shape, (0.0, -gap), 0.0))
    held = tuple(Support(body.side("left"), (0, 1)) for body in (upper, away))
    problem = replace(problem, bodies=(upper, away), supports=held)
    spaces = {"upper": space, "lower": space}
    run = run_of(problem, spaces, steps_of(problem, spaces, np.radians([0.0, 1.0, 2.0])))
    texts = [note.text for note in find(problem, spaces, run, None).notes]
    # exp(-80) of the strength acts over 20 L0
    assert any(text.startswith("upper.bottom: it carries no traction") for text in texts) == (gap > 0)


def test_it_is_a_reading_and_a_column_of_two_bodies(tmp_path: Path) -> None:
    problem, space = two(), row_space("N2", (30, 2), 2)
    spaces = {"upper": space, "lower": space}
    run = run_of(problem, spaces, steps_of(problem, spaces))
    found = find(problem, spaces, run, None)
    (reading,) = (one for one in found.readings if one.name == "J-integral")
    assert reading.theory == LAW.work_of_adhesion
    assert reading.value == pytest.approx(LAW.work_of_adhesion, rel=5e-3)
    # in nm and GPa
    units = found.laboratory
    write_curve(tmp_path / "curve.csv", run.curve, problem, units, found.fronts, found.flows)
    with (tmp_path / "curve.csv").open(newline="") as file:
        column = [row["J_integral upper.bottom [J/m^2]"] for row in csv.DictReader(file)]
    assert float(column[-1]) == reading.value * units.unit("toughness").factor
    stored = {state.step for state in run.states if state.parameter > 0}
    assert {step for step, value in enumerate(column) if value} == stored
    # until the joint parts J rises, as does the moment
    rising = [flow.j.value for flow in found.flows["upper.bottom"].values() if not flow.j.parted]
    assert len(rising) > 1
    assert np.all(np.diff(rising) > 0)


def test_it_is_not_given_where_it_has_no_meaning() -> None:
    problem, space = two(), row_space("N2", (30, 2), 2)
    spaces = {"upper": space, "lower": space}
    rest = StoredState(0, 0.0, np.zeros((2 * space.size, 2)))
    (joint,) = problem.interfaces
    upper, lower = problem.bodies
    assert j_integral(problem, spaces, rest) == "the joint carries no traction"
    passive = replace(problem, interfaces=(replace(joint, scheme="two-half-pass"),))
    assert j_integral(passive, spaces, rest, "upper.bottom") == "the forces of the interface have no energy"
    touching = replace(problem, interfaces=(replace(joint, law=Contact(1.0)),))
    assert j_integral(touching, spaces, rest, "upper.bottom") == "nothing adheres"
    bent = replace(problem, bodies=(upper, Body(annulus_sector(20.0, 23.0, 1.0), SOFT, "lower")))
    words = "the sides that face each other, and the opposite ones, are not straight and parallel"
    assert j_integral(bent, spaces, rest, "upper.bottom") == words
    third = Body(placed(rectangle(30.0, 1.0), (0.0, 3.0), 0.0), SOFT, "third")
    tie = Tie(third.side("bottom"), upper.side("top"))
    layers = replace(problem, bodies=(*problem.bodies, third), ties=(tie,))
    spaces_of_three = {**spaces, "third": space}
    at_rest = rest._replace(displacement=np.zeros((3 * space.size, 2)))
    words = "the joint carries no traction"
    assert j_integral(layers, spaces_of_three, at_rest, "upper.bottom") == words
    ends = tuple(
        Body(placed(rectangle(15.0, 1.0), (start, 3.0), 0.0), SOFT, f"from {start:g}")
        for start in (0.0, 15.0)
    )
    ties = tuple(
        Tie(body.side("bottom"), upper.side("top", *part))
        for body, part in zip(ends, ((0.0, 0.5), (0.5, 1.0)), strict=True)
    )
    halves = replace(problem, bodies=(*problem.bodies, *ends), ties=ties)
    words = "several bodies are tied to one side"
    assert j_integral(halves, spaces | {body.name: space for body in ends}, rest, "upper.bottom") == words
    held_below = Interface(lower.side("bottom"), LAW, Flat(-6.0))
    sandwich = replace(problem, interfaces=(joint, held_below))
    assert j_integral(sandwich, spaces, rest, "upper.bottom") == "another interface acts on the same body"
    around = Interface(upper.side("bottom", end=0.7), LAW, Circle(50.0))
    alone = Problem("one", (upper,), (around,), problem.supports[:1], RotatedSide("right"))
    assert j_integral(alone, space, StoredState(0, 0.0, rest.displacement[: space.size])) == (
        "the substrate is not flat"
    )
    opening = rest.displacement.copy()
    opening[: space.size, 1] = 1e-3
    pressed = replace(problem, loads=(HeldLoad(upper.side("top"), 1e-9, np.pi / 2),))
    there = StoredState(0, 0.0, opening)
    assert j_integral(pressed, spaces, there, "upper.bottom") == "upper is loaded beside the front"
