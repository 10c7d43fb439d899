"""Paths of bodies that a joint law holds together: mirror images, damage, double cantilever beams."""

from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from isopeel import (
    Body,
    Flat,
    Interface,
    MixedModeBilinear,
    MovedSide,
    NeoHooke,
    NewtonSettings,
    Problem,
    PulledSide,
    RotatedSide,
    Support,
    XuNeedleman,
    row_space,
    trace,
)
from isopeel.assembly.interface import InterfacePoints
from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.joints import JointLaw
from isopeel.post.closed_form import BondedBeams, double_cantilever_force
from isopeel.post.front import front_profile, process_zone
from isopeel.problem.place import placed
from isopeel.results.layout import Layout, read_history
from isopeel.splines.nurbs import rectangle

SOFT = NeoHooke(1.0, 0.3)
LENGTH, HEIGHT = 50.0, 5.0
UPPER = Body(placed(rectangle(LENGTH, HEIGHT), (0.0, 0.0), 0.0), SOFT, "upper")
LOWER = Body(placed(rectangle(LENGTH, HEIGHT), (0.0, -HEIGHT), 0.0), SOFT, "lower")
SPACE = row_space("N2", (50, 3), 2)
SPACES = {"upper": SPACE, "lower": SPACE}
BILINEAR = MixedModeBilinear(0.1, 0.1, 0.005, 0.01, 0.3)


def two_arms(law: JointLaw) -> Problem:
    """Two arms that are joined on three quarters of their length, and turned apart at the ends."""
    joint = Interface(UPPER.side("bottom", end=0.75), law, LOWER.side("top"))
    turn = RotatedSide(((UPPER.side("right"), 1.0), (LOWER.side("right"), -1.0)))
    held = Support(UPPER.side("left"), (0,)), Support(LOWER.side("left"), (0, 1))
    return Problem("two arms", (UPPER, LOWER), (joint,), held, turn)


def reactions(problem: Problem, space: object, angles: FloatArray) -> tuple[FloatArray, FloatArray]:
    settings = NewtonSettings(path_control="auto")
    steps = [
        step
        for step in trace(problem, space, angles, settings)  # type: ignore[arg-type]
        if step.kind == "requested"
    ]
    return np.array([step.reaction for step in steps]), np.array([step.dissipated_energy for step in steps])


@pytest.mark.parametrize(
    ("law", "angles"),
    [
        (XuNeedleman(0.1, 0.1, 0.02), np.arange(0.0, 30.5, 2.0)),
        # peeled, closed in part and peeled further
        (
            BILINEAR,
            np.concatenate([np.arange(0.0, 38.5, 2.0), np.arange(36.0, 19.0, -4.0), [32.0, 38.0, 40.0]]),
        ),
    ],
    ids=["reversible", "damaged"],
)
def test_a_body_joined_to_its_copy_is_one_that_adheres_to_its_mirror_image(
    law: JointLaw, angles: FloatArray
) -> None:
    joint = Interface(UPPER.side("bottom", end=0.75), Mirrored(law), Flat(), irreversible=bool(law.history))
    alone = Problem("one", (UPPER,), (joint,), (Support(UPPER.side("left"), (0,)),), RotatedSide("right"))
    expected, lost = reactions(alone, SPACE, np.radians(angles))
    found, dissipated = reactions(two_arms(law), SPACES, np.radians(angles))
    # reactions are known to 5e-9 of the largest
    np.testing.assert_allclose(found, 2 * expected, atol=5e-9 * np.abs(2 * expected).max())
    np.testing.assert_allclose(dissipated, 2 * lost, atol=1e-8 * max(2 * lost.max(), 1e-30))
    if law.history:
        # more than a unit of length has parted
        assert 2 * lost[-1] > law.work_of_adhesion


def test_a_joint_with_damage_continues_bit_for_bit() -> None:
    problem, angles = two_arms(BILINEAR), np.radians(np.arange(2.0, 31.0, 2.0))
    settings = NewtonSettings(path_control="auto")
    steps = [(step, step.state) for step in trace(problem, SPACES, angles, settings)]
    number, state = next((n, state) for n, (step, state) in enumerate(steps) if step.parameter >= angles[-4])
    assert steps[number][0].dissipated_energy > 0
    again = list(trace(problem, SPACES, angles[-3:], settings, start=[state]))
    assert len(again) == len(steps[number + 1 :])
    for (one, _), other in zip(steps[number + 1 :], again, strict=True):
        assert other.reaction == one.reaction
        np.testing.assert_array_equal(other.maximum_openings, one.maximum_openings)


def test_the_history_is_stored_by_the_names_of_its_variables(tmp_path: Path) -> None:
    problem = two_arms(BILINEAR)
    settings = NewtonSettings(path_control="auto")
    *_, last = trace(problem, SPACES, np.radians(np.arange(2.0, 33.0, 2.0)), settings)
    layout = Layout.of(problem, SPACES)
    with h5py.File(tmp_path / "run.h5", "w") as file:
        layout.write_history(file, [last.maximum_openings])
        found = read_history(file, 1, last.maximum_openings.shape)
        damage = file["history/upper.bottom/damage"]
        assert damage.attrs["unit"] == "1"
        assert damage.shape[1:] == (38, 3)
        assert damage[:].max() == 1.0
        # opening alone, to the tolerance of the solver; far from the front there is nothing but that
        assert file["history/upper.bottom/mixity"][:][damage[:] > 0].max() < 1e-9
        lost = file["history/upper.bottom/dissipated"][:].ravel()
    assert found is not None
    np.testing.assert_array_equal(found[0], last.maximum_openings)
    points = InterfacePoints.of_contact(problem, SPACES)
    # the step was evaluated with the mixity before it, which is the same in pure opening
    assert np.sum(points.lengths.ravel() * lost) == pytest.approx(last.dissipated_energy, rel=1e-9)
    state = points.state(last.displacement, last.maximum_openings)
    assert np.sum(points.lengths * state.dissipated) == pytest.approx(last.dissipated_energy, rel=1e-9)
    # by symmetry there is none; displacements are known to the tolerance of the solver, measured 5e-8
    assert np.abs(state.tangential_traction).max() < 1e-6 * BILINEAR.strength
    profile = front_profile(problem, SPACES, last.displacement, maximum_openings=last.maximum_openings)
    # three points of an element of 1 see a process zone of 3: the peak may lie between them
    assert 0.5 < -profile.adhesive_traction.min() / BILINEAR.strength < 1.1
    assert process_zone(profile) is not None


def test_newtons_method_converges_quadratically() -> None:
    problem = two_arms(XuNeedleman(0.1, 0.1, 0.02, 0.8, 0.2))
    *_, step = trace(problem, SPACES, np.radians([2.0, 4.0, 8.0]), NewtonSettings(plain=True))
    # the order that energy residuals fall with, in the end: 2 but for what comes after the leading term
    before, last, final = np.log(step.iterations[-3:])
    assert (final - last) / (last - before) > 1.8


ARM_HEIGHT, MODULUS = 10.0, NeoHooke(1.0, 0.2)
PLANE_STRAIN = 1.0 / (1 - 0.2**2)
BENDING = PLANE_STRAIN * ARM_HEIGHT**3 / 12
WORK = 4.34e-5  # an arm of a crack has the curvature 1/1400
MIXED = MixedModeBilinear(0.002, 0.002, WORK, 2 * WORK, 0.2)


def test_a_double_cantilever_beam_grows_at_the_force_of_beam_theory() -> None:
    """P = (2/3)^(1/2) G^(3/4) (E'I)^(1/4) D^(-1/2) per width, whatever the rotation of the arms' roots."""
    length, crack = 130.0, 60.0
    upper = Body(rectangle(length, ARM_HEIGHT), MODULUS, "upper")
    lower = Body(placed(rectangle(length, ARM_HEIGHT), (0.0, -ARM_HEIGHT), 0.0), MODULUS, "lower")
    joint = Interface(upper.side("bottom", end=1 - crack / length), MIXED, lower.side("top"))
    held = Support(upper.side("left"), (0,)), Support(lower.side("left"), (0, 1))
    pull = PulledSide(((upper.side("right"), 1.0), (lower.side("right"), -1.0)), np.pi / 2)
    problem = Problem("double cantilever beam", (upper, lower), (joint,), held, pull)
    space = row_space("N2.1", (104, 2), 2)
    openings = np.array([1.0, 1.6, 2.0, *np.arange(2.2, 3.01, 0.1)])
    settings = NewtonSettings(path_control="auto")
    steps = [
        step
        for step in trace(problem, {"upper": space, "lower": space}, openings, settings)
        if step.kind == "requested" and step.parameter > 2.35
    ]
    opening = np.array([step.parameter for step in steps])
    force = np.array([step.reaction for step in steps])
    assert len(steps) == 7
    # elements of 1.25 in a process zone of 10: the force oscillates by 0.3 %
    expected = [double_cantilever_force(WORK, BENDING, float(one)) for one in opening]
    np.testing.assert_allclose(force, expected, rtol=0.01)


def test_faces_of_a_crack_that_barely_touch_find_their_contact() -> None:
    """Two beams are pressed down on supports: the upper one bears on the lower one at their cracked end."""
    length, crack = 100.0, 30.0
    upper = Body(rectangle(length, HEIGHT), SOFT, "upper")
    lower = Body(placed(rectangle(length, HEIGHT), (0.0, -HEIGHT), 0.0), SOFT, "lower")
    joint = Interface(upper.side("bottom", start=crack / length), BILINEAR, lower.side("top"))
    cracked = replace(BILINEAR, initial_damage=1.0)
    faces = Interface(upper.side("bottom", end=crack / length), cracked, lower.side("top"))
    held = (
        Support(lower.side("left"), (1,)),
        Support(lower.side("right"), (1,)),
        Support(lower.side("bottom", start=0.95), (0,)),
    )
    press = PulledSide(upper.side("top", 0.45, 0.55), -np.pi / 2)
    problem = Problem("pressed", (upper, lower), (joint, faces), held, press)
    space = row_space("N2", (40, 2), 2)
    # too few corrections to open and close all points one after the other: the descent finds the state
    settings = NewtonSettings(path_control="auto", iteration_limit=5)
    (step,) = trace(problem, {"upper": space, "lower": space}, [1.0], settings)
    # bending, the crack lengthened by 0.42 chi h, and shear: 4 % for beams of ten heights
    beams = BondedBeams(1 / 0.91, 1 / 2.6, HEIGHT, length / 2)
    assert step.parameter / step.reaction == pytest.approx(beams.compliance(crack), rel=0.04)
    assert step.dissipated_energy == 0.0


@pytest.mark.parametrize("mixity", [0.0, 0.4, 1.0])
def test_blocks_that_are_parted_in_loops_unload_and_reload_along_the_secant(mixity: float) -> None:
    """A joint of stiff blocks opens and slides by half, goes back, beyond and back, and parts."""
    law = MixedModeBilinear(1e-3, 1.5e-3, 1e-4, 3e-4, 0.2)
    stiff, length = NeoHooke(100.0, 0.0), 4.0
    upper = Body(rectangle(length, 1.0), stiff, "upper")
    lower = Body(placed(rectangle(length, 1.0), (0.0, -1.0), 0.0), stiff, "lower")
    K_n, K_t = law.stiffnesses
    energy = law.work_at(mixity) / law.rise
    jump = np.sqrt([2 * (1 - mixity) * energy / K_n, 2 * mixity * energy / K_t])
    problem = Problem(
        "blocks",
        (upper, lower),
        (Interface(upper.side("bottom"), law, lower.side("top")),),
        (Support(lower.side("bottom"), (0, 1)),),
        MovedSide(upper.side("top"), float(np.arctan2(*jump)), "held"),
    )
    legs = [np.linspace(0.0, 0.5, 51), np.linspace(0.5, 0.0, 21), np.linspace(0.0, 0.7, 71)]
    legs += [np.linspace(0.7, 0.0, 21), np.linspace(0.0, 1.02, 103)]
    share = np.concatenate([legs[0], *(leg[1:] for leg in legs[1:])])
    space = row_space("N2", (2, 1), 2)
    path = share * float(np.hypot(*jump))
    steps = list(trace(problem, {"upper": space, "lower": space}, path))
    traction = np.array([step.reaction for step in steps]) / length
    lost = np.array([step.dissipated_energy for step in steps]) / length
    assert len(steps) == share.size
    # the bilinear law of the largest share so far; blocks yield by 2e-3 of a jump at the onset of damage
    largest = np.maximum.accumulate(share)
    stiffness = traction[1] / share[1]
    kept = law.rise * (1 - largest.clip(law.rise, 1.0)) / (largest.clip(law.rise) * (1 - law.rise))
    expected = stiffness * kept * share
    np.testing.assert_allclose(traction, expected, atol=5e-3 * expected.max())
    # nothing is lost below the largest share, to the round-off of 250 sums; all of the work in the end
    back = largest[1:] == largest[:-1]
    np.testing.assert_allclose(np.diff(lost)[back], 0.0, atol=1e-9 * lost[-1])
    assert lost[-1] == pytest.approx(law.work_at(mixity), rel=1e-3)
