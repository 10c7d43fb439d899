"""The energy release rates of opening and sliding by the loads of two equal arms."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from two_arms_apart import steps_of, two

from isopeel import (
    Body,
    HeldLoad,
    Interface,
    MixedModeBilinear,
    NeoHooke,
    Problem,
    PulledSide,
    RotatedSide,
    Step,
    Support,
    XuNeedleman,
    row_space,
)
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.post.contour import JIntegral, j_integral
from isopeel.post.crack import crack_lengths, fronts, load_position
from isopeel.post.front_readings import front_flows, front_readings
from isopeel.post.mode_ratio import ArmLoads, ModeRates, equal_arm_rates, mode_rates
from isopeel.problem.place import placed
from isopeel.results.fields import StoredState
from isopeel.splines.nurbs import rectangle

LENGTH, HEIGHT = 50.0, 2.0
MATERIAL = NeoHooke(1.0, 0.2)
MODULUS = plane_strain_modulus(MATERIAL)
BENDING = MODULUS * HEIGHT**3 / 12
LAW = XuNeedleman(0.1, 0.1, 0.02)
UPPER = Body(rectangle(LENGTH, HEIGHT), MATERIAL, "upper")
LOWER = Body(placed(rectangle(LENGTH, HEIGHT), (0.0, -HEIGHT), 0.0), MATERIAL, "lower")
SPACE = row_space("N2.1", (60, 2), 2)
SPACES = {"upper": SPACE, "lower": SPACE}


def joined(drive: Any, *, open_left: bool = False, swapped: bool = False) -> Problem:
    """Two arms that are joined on 60 % of their length, clamped there and driven at their open ends."""
    part = {"start": 0.4} if open_left else {"end": 0.6}
    faces = [UPPER.side("bottom", **part), LOWER.side("top", **part)]
    first, second = faces[::-1] if swapped else faces
    held = [Support(body.side("right" if open_left else "left"), (0, 1)) for body in (UPPER, LOWER)]
    ends = [body.side("left" if open_left else "right") for body in (UPPER, LOWER)]
    chosen = drive(*ends)
    return Problem("joined", (UPPER, LOWER), (Interface(first, LAW, second),), tuple(held), chosen)


def rates_of(problem: Problem, to: float) -> tuple[ModeRates, JIntegral, Step]:
    *_, step = steps_of(problem, SPACES, np.linspace(0.0, to, 4)[1:])
    state = StoredState.of(step, problem.drive)
    rates, flow = (find(problem, SPACES, state) for find in (mode_rates, j_integral))
    assert isinstance(rates, ModeRates), rates
    assert isinstance(flow, JIntegral), flow
    return rates, flow, step


def test_both_rates_are_the_energy_of_beams_before_and_behind_the_front() -> None:
    """G of beams for any loads (Hutchinson and Suo, Adv. Appl. Mech. 29, 1992)."""
    random = np.random.default_rng(1)
    for N1, N2, M1, M2 in random.normal(size=(20, 4)):
        M1, M2 = max(M1, M2), min(M1, M2)
        rates = equal_arm_rates(ArmLoads(N1, M1), ArmLoads(N2, M2), HEIGHT, BENDING)
        arms = (N1**2 + N2**2) / HEIGHT + 12 * (M1**2 + M2**2) / HEIGHT**3
        moment = M1 + M2 - (N1 - N2) * HEIGHT / 2  # about the middle of both
        whole = (N1 + N2) ** 2 / (2 * HEIGHT) + 12 * moment**2 / (2 * HEIGHT) ** 3
        assert rates.opening + rates.sliding == pytest.approx((arms - whole) / (2 * MODULUS), rel=1e-12)
    mirrored = equal_arm_rates(ArmLoads(0.3, 1.0), ArmLoads(0.3, -1.0), HEIGHT, BENDING)
    assert mirrored.ratio == 0.0
    assert equal_arm_rates(ArmLoads(0.3, 1.0), ArmLoads(-0.3, 1.0), HEIGHT, BENDING).ratio == 1.0
    # pressed together
    assert equal_arm_rates(ArmLoads(0.0, -1.0), ArmLoads(0.0, 1.0), HEIGHT, BENDING).opening == 0.0


@pytest.mark.parametrize("open_left", [False, True])
@pytest.mark.parametrize("swapped", [False, True])
def test_rates_of_arms_that_moments_turn(open_left: bool, swapped: bool) -> None:
    turn = -1.0 if open_left else 1.0
    problem = joined(
        lambda upper, lower: RotatedSide(((upper, turn), (lower, -0.3 * turn))),
        open_left=open_left,
        swapped=swapped,
    )
    rates, flow, step = rates_of(problem, 0.05)
    first, second = step.reactions
    # sections have the moments of the ends, to the error of their stresses
    assert rates.opening == pytest.approx(((first - second) / 2) ** 2 / BENDING, rel=2e-4)
    assert rates.sliding == pytest.approx(3 * ((first + second) / 2) ** 2 / (4 * BENDING), rel=2e-4)
    # measured 1e-5: beams of small strain
    assert rates.opening + rates.sliding == pytest.approx(flow.value, rel=1e-4)


def test_rates_of_arms_that_slide_under_axial_forces() -> None:
    problem = joined(lambda upper, lower: PulledSide(((upper, 1.0), (lower, -1.0)), 0.0))
    # small, so that the arms stay straight
    rates, flow, step = rates_of(problem, 1e-4)
    assert rates.sliding == pytest.approx(step.reaction**2 * HEIGHT**2 / (48 * BENDING), rel=1e-3)
    assert rates.ratio == pytest.approx(1.0, abs=1e-5)
    assert rates.sliding == pytest.approx(flow.value, rel=1e-4)


def test_the_front_of_faces_that_slide_is_where_the_compliance_puts_it() -> None:
    """End forces +-P: (2 a + 1.5 (L - a)) P/(E' h) is the distance of the ends, and P^2/(4 E' h) is G_II."""
    strain = 1e-6  # of the free parts: beams stay straight
    work = MODULUS * HEIGHT * strain**2 / 4
    strength = np.sqrt(MODULUS * work) / 5  # a front of several elements
    law = MixedModeBilinear(strength, strength, work, work, 0.2)
    problem = joined(lambda upper, lower: PulledSide(((upper, 1.0), (lower, -1.0)), 0.0))
    (joint,) = problem.interfaces
    problem = replace(problem, interfaces=(replace(joint, law=law),))
    steps = steps_of(problem, SPACES, strain * np.array([60.0, 80.0, 90.0, 92.5, 95.0, 97.0]))
    found = fronts(problem, SPACES, [StoredState.of(step, problem.drive) for step in steps], "upper.bottom")
    lengths = crack_lengths(found)
    (first, before), (last, after) = [
        (step, lengths[k]) for k, step in enumerate(steps) if step.parameter in (90 * strain, 97 * strain)
    ]
    free = [2 * MODULUS * HEIGHT * step.parameter / step.reaction for step in (first, last)]
    assert free[1] - free[0] > 10.0
    # two places of a front, known to a twentieth of an element of 0.8
    assert after - before == pytest.approx(free[1] - free[0], abs=0.08)
    # to the error of the mesh at a front of four elements
    assert found[len(steps) - 1].zone.peak == pytest.approx(strength, rel=0.05)
    assert last.reaction == pytest.approx(np.sqrt(4 * MODULUS * HEIGHT * work), rel=5e-3)


def test_cracks_are_measured_from_the_end_of_the_faces_of_a_crack() -> None:
    problem = joined(lambda upper, lower: RotatedSide(((upper, 1.0), (lower, -0.3))), open_left=True)
    (joint,) = problem.interfaces
    middle = PulledSide(((UPPER.side("top", 0.45, 0.55), 1.0),), -np.pi / 2)
    bent = replace(problem, drive=middle)
    assert load_position(bent, "upper.bottom") == LENGTH / 2
    cracked = replace(
        joint,
        boundary=replace(joint.boundary, start=0.0, end=joint.boundary.start),
        law=MixedModeBilinear(0.1, 0.1, 0.02, 0.02, 0.2, initial_damage=1.0),
    )
    assert load_position(replace(bent, interfaces=(joint, cracked)), "upper.bottom") == 0.0


def test_a_load_on_the_joined_part_releases_nothing() -> None:
    """It bends the joined part, but not the section at the front; the joint there carries it."""
    problem = joined(lambda upper, lower: RotatedSide(((upper, 1.0), (lower, -0.3))))
    ahead = HeldLoad(UPPER.side("top", 0.3, 0.4), 1e-3, -np.pi / 2)
    rates, flow, _ = rates_of(replace(problem, loads=(ahead,)), 0.05)
    # measured 2e-6: beams of small strain
    assert rates.opening + rates.sliding == pytest.approx(flow.value, rel=1e-4)


def test_they_are_readings() -> None:
    problem = joined(lambda upper, lower: RotatedSide(((upper, 1.0), (lower, -0.3))))
    rates, flow, step = rates_of(problem, 0.05)
    state = StoredState.of(step, problem.drive)
    found = front_flows(problem, SPACES, [state], "upper.bottom")
    readings = {one.name: one for one in front_readings(problem, found[state.step], "upper.bottom")}
    values = [readings[name].value for name in ("J-integral", "G_I", "G_II", "mode ratio")]
    assert values == [flow.value, rates.opening, rates.sliding, rates.ratio]
    assert readings["mode ratio"].words == "G_II/(G_I + G_II); this sum is 100 % of the J-integral"


def test_they_are_not_given_without_a_joint_law_or_for_arms_that_differ() -> None:
    state = StoredState(0, 0.0, np.zeros((2 * SPACE.size, 2)))
    words = "faces that slide without friction have no mode ratio: it needs a joint law"
    assert mode_rates(two(), SPACES, state, "upper.bottom") == words
    problem = joined(lambda upper, lower: RotatedSide(((upper, 1.0), (lower, -0.3))))
    assert mode_rates(problem, SPACES, state) == "the joint carries no traction"
    stiff = replace(problem, bodies=(UPPER, replace(LOWER, material=NeoHooke(2.0, 0.2))))
    *_, step = steps_of(stiff, SPACES, np.array([0.01]))
    found = mode_rates(stiff, SPACES, StoredState.of(step, stiff.drive))
    assert found == "the arms differ, and moments do not divide the energy into opening and sliding"
