"""Drives on several boundaries, of one body and of two, by factors: reactions, forces and energies."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from isopeel import (
    Body,
    Boundary,
    Exponential,
    Flat,
    InputError,
    Interface,
    MovedSide,
    NeoHooke,
    NewtonSettings,
    Problem,
    PulledSide,
    RotatedSide,
    Support,
    row_space,
    trace,
)
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.problem import Drive, Place
from isopeel.solve.step import Step
from isopeel.splines.nurbs import rectangle

#: Two strips beside each other, one the mirror image of the other; weak and soft, for a coarse mesh.
LENGTH, HEIGHT = 24.0, 2.0
LAW, MATERIAL = Exponential(0.03, 0.015), NeoHooke(1.0, 0.2)
SPACE = row_space("N2", (24, 2))
ONE, OTHER = (Body(rectangle(LENGTH, HEIGHT), MATERIAL, name) for name in ("one", "other"))
JOINT = Interface(ONE.side("bottom", 0.0, 0.75), LAW, Flat(), sliding_length=0.3)
MIRRORED = replace(JOINT, boundary=OTHER.side("bottom", 0.25, 1.0))
RIGHT, LEFT = ONE.side("right"), OTHER.side("left")
ENDS = (Support(ONE.side("left"), (0,)), Support(OTHER.side("right"), (0,)))


def single(drive: Drive) -> Problem:
    return Problem("single", (ONE,), (JOINT,), ENDS[:1], drive)


def both(drive: Drive) -> Problem:
    return Problem("both", (ONE, OTHER), (JOINT, MIRRORED), ENDS, drive)


def path(
    problem: Problem, places: FloatArray, path_control: str = "newton", *, plain: bool = False
) -> list[Step]:
    settings = NewtonSettings(path_control=path_control, plain=plain)  # type: ignore[arg-type]
    spaces = {body.name: SPACE for body in problem.bodies}
    return list(trace(problem, spaces, places, settings))


#: Each with how far it goes; the mirror image of the motion is the opposite one.
MIRROR_DRIVES: dict[str, tuple[RotatedSide | MovedSide | PulledSide, float]] = {
    "rotation": (RotatedSide(RIGHT), 0.3),
    "displacement": (MovedSide(RIGHT, 0.0), 0.03),
    "force": (PulledSide(RIGHT, 0.0), 0.03),
    "force raised": (PulledSide(RIGHT, 0.0, control="force"), 3e-3),
}


@pytest.mark.parametrize("path_control", ["newton", "auto"])
@pytest.mark.parametrize("name", MIRROR_DRIVES)
def test_opposite_factors_on_mirror_images_give_the_curve_of_one(name: str, path_control: str) -> None:
    drive, to = MIRROR_DRIVES[name]
    places = np.linspace(0.0, to, 13)
    expected = np.array([step.reaction for step in path(single(drive), places, path_control)])
    pair = replace(drive, on=((RIGHT, 1.0), (LEFT, -1.0)))
    # the displacement on which a found force works is that of both
    doubled = name == "force"
    steps = path(both(pair), 2 * places if doubled else places, path_control)
    found = np.array([step.reaction for step in steps])
    each = np.array([step.reactions for step in steps])
    # two bodies in one system, to the tolerance of the solver
    allowed = 1e-8 * np.abs(expected).max()
    np.testing.assert_allclose(found, expected if doubled else 2 * expected, rtol=0, atol=allowed)
    np.testing.assert_allclose(each, np.outer(expected, [1.0, -1.0]), rtol=0, atol=allowed)
    assert np.abs(expected).max() > 0
    energies = [step.stored_energy + step.adhesive_energy for step in (steps[0], steps[-1])]
    assert energies[1] > energies[0]


#: A double cantilever: the lower arm adheres with its upper side to a plane that faces downwards.
_SHAPE = rectangle(LENGTH, HEIGHT)
LOWER = Body(replace(_SHAPE, control_points=_SHAPE.control_points - [0.0, HEIGHT]), MATERIAL, "lower")
BELOW = Interface(LOWER.side("top", 0.0, 0.75), LAW, Flat(0.0, -np.pi / 2), sliding_length=0.3)
ARMS = (ONE.side("right"), 1.0), (LOWER.side("right"), -1.0)


@pytest.mark.parametrize("path_control", ["newton", "auto"])
@pytest.mark.parametrize(
    "drive", [MovedSide(RIGHT, np.pi / 2), PulledSide(RIGHT, np.pi / 2)], ids=["moved", "pulled"]
)
def test_a_double_cantilever_has_the_forces_of_its_half(
    drive: MovedSide | PulledSide, path_control: str
) -> None:
    places = np.linspace(0.0, 3.0, 31)
    half = path(single(drive), places, path_control)
    expected = np.array([step.reaction for step in half])
    supports = (ENDS[0], Support(LOWER.side("left"), (0,)))
    whole = Problem("double", (ONE, LOWER), (JOINT, BELOW), supports, replace(drive, on=ARMS))
    is_pulled = isinstance(drive, PulledSide)
    # a force that is found works on the opening, a motion of both arms is that of each
    steps = path(whole, 2 * places if is_pulled else places, path_control)
    found, each = (np.array([getattr(step, name) for step in steps]) for name in ("reaction", "reactions"))
    # two bodies in one system, to the tolerance of the solver
    allowed = 1e-8 * np.abs(expected).max()
    np.testing.assert_allclose(each, np.outer(expected, [1.0, -1.0]), rtol=0, atol=allowed)
    np.testing.assert_allclose(found, (1 if is_pulled else 2) * expected, rtol=0, atol=allowed)
    # the joint opens
    assert steps[-1].adhesive_energy - steps[0].adhesive_energy > 0.01 * abs(steps[0].adhesive_energy)


@pytest.mark.parametrize("drive", [RotatedSide(RIGHT), MovedSide(RIGHT, np.pi / 2)])
def test_a_factor_scales_the_motion(drive: RotatedSide | MovedSide) -> None:
    """Bodies that do not meet: each has the reaction of its own motion, the factor times the parameter."""
    places = np.linspace(0.0, 0.2, 9)
    whole, half = (
        np.array([step.reaction for step in path(single(drive), factor * places)]) for factor in (1.0, 0.5)
    )
    # on its right side the mirror image is moved by the same motion only where it is symmetric across
    twin = replace(JOINT, boundary=OTHER.side("bottom", 0.0, 0.75))
    supports = (ENDS[0], Support(OTHER.side("left"), (0,)))
    pair = replace(drive, on=((RIGHT, 1.0), (OTHER.side("right"), 0.5)))
    problem = replace(both(pair), interfaces=(JOINT, twin), supports=supports)
    steps = path(problem, places)
    allowed = 1e-8 * np.abs(whole).max()
    # the correction of the whole reaction is shared by the factors: the rest is of the solver's tolerance
    each = np.array([step.reactions for step in steps])
    np.testing.assert_allclose(each, np.stack([whole, half], axis=1), rtol=0, atol=allowed)
    np.testing.assert_allclose([step.reaction for step in steps], whole + half / 2, rtol=0, atol=allowed)


@pytest.mark.parametrize("control", ["displacement", "force"])
def test_two_parts_of_a_side_are_pulled_as_the_whole(control: str) -> None:
    places = np.linspace(0.0, 0.5 if control == "displacement" else 2e-3, 11)
    whole = PulledSide(RIGHT, np.pi / 3, control=control)  # type: ignore[arg-type]
    parts = tuple((ONE.side("right", *part), size) for part, size in (((0.0, 0.3), 0.3), ((0.3, 1.0), 0.7)))
    # plain Newton's method converges to round-off
    expected = path(single(whole), places, plain=True)
    found = path(single(replace(whole, on=parts)), places, plain=True)
    for one, other in zip(found, expected, strict=True):
        # one traction, integrated in parts: to the round-off of sums, which steps enlarge
        assert one.reaction == pytest.approx(other.reaction, rel=1e-10, abs=1e-16)
        np.testing.assert_allclose(one.displacement, other.displacement, rtol=0, atol=1e-10)
    if control == "displacement":
        np.testing.assert_allclose(found[-1].reactions, np.array([0.3, 0.7]) * found[-1].reaction, rtol=1e-15)
    else:
        weighted = float(np.dot([0.3, 0.7], found[-1].reactions))
        assert weighted == pytest.approx(found[-1].reaction, rel=1e-12)


LEVER: Place = ((ONE.side("top", 0.7, 0.75), 1.0), (ONE.side("top", 0.9, 1.0), 0.25))
LEVERS: dict[str, tuple[MovedSide | PulledSide, float]] = {
    "found": (PulledSide(LEVER, np.pi / 2), 1.0),
    "raised": (PulledSide(LEVER, np.pi / 2, control="force"), 1.5e-3),
    "moved": (MovedSide(LEVER, np.pi / 2), 0.5),
}


@pytest.mark.parametrize("name", LEVERS)
def test_work_on_two_places_is_what_the_energies_take(name: str) -> None:
    drive, to = LEVERS[name]
    nodes, weights = np.polynomial.legendre.leggauss(8)
    ends = np.linspace(0.0, to, 5)
    places = [0.0]
    for start, end in pairwise(ends):
        places += [*(start + (end - start) * (nodes + 1) / 2), end]
    steps = path(single(drive), np.array(places))
    reaction = np.array([step.reaction for step in steps])
    work = float(np.sum(np.tile(np.append(weights, 0.0), 4) * reaction[1:])) * to / 8
    if name == "raised":
        work = reaction[-1] * to - work
    change = steps[-1].stored_energy + steps[-1].adhesive_energy - steps[0].stored_energy
    # eight Gauss points integrate a smooth curve over a quarter of it to better than 1e-8
    assert change - steps[0].adhesive_energy == pytest.approx(work, rel=1e-6)
    # the sum of the reactions by their factors
    scale = {"found": 1 + 0.25**2, "raised": 1.0, "moved": 1.0}[name]
    summed = np.array([step.reactions for step in steps]) @ [1.0, 0.25]
    np.testing.assert_allclose(summed, scale * reaction, rtol=1e-13, atol=1e-18)


@pytest.mark.parametrize(
    ("on", "message"),
    [
        (((RIGHT, 0.0),), "drive.on.1.factor: 0.0 cannot be used; its size must be from 1e-06"),
        (((RIGHT, float("nan")),), "drive.on.1.factor: nan"),
        (((RIGHT, 1.0), (RIGHT, 2.0)), "drive.on: 'one.right' cannot be used; the drive acts twice"),
        (((ONE.side("top", 0, 0.6), 1.0), (ONE.side("top", 0.5), 2.0)), "'one.top' cannot be used"),
        ((), "a drive acts on one boundary at least"),
        (((Boundary("", "top"), 1.0),), "needs the name of its body"),
    ],
)
def test_boundaries_that_make_no_drive(on: Place, message: str) -> None:
    for make in (RotatedSide, lambda on: MovedSide(on, 0.0), lambda on: PulledSide(on, 0.0)):
        with pytest.raises(InputError, match=message):
            make(on)


@pytest.mark.parametrize(
    ("drive", "message"),
    [
        (MovedSide(((LEFT, 1.0),), 0.0), "body: 'other' cannot be used; the bodies are one"),
        (
            MovedSide(((ONE.side("top", 0.0, 0.5), 1.0), (ONE.side("top", 0.5), -1.0)), np.pi / 2),
            "drive.on: 'one.top#2' cannot be used; the drive moves another boundary",
        ),
        (
            MovedSide(((RIGHT, 1.0), (ONE.side("left"), -1.0)), 0.0),
            "held: 'left' cannot be used; the drive moves the side left, which shares points",
        ),
        (
            PulledSide(((RIGHT, 1.0), (ONE.side("left"), -1.0)), 0.0),
            "held: 'left' cannot be used; the drive loads the side left along x, and all of it is held",
        ),
    ],
)
def test_boundaries_that_do_not_fit_the_problem(drive: Drive, message: str) -> None:
    with pytest.raises(InputError, match=message):
        System(single(drive), SPACE)


def test_a_distance_that_is_prescribed_does_not_hold_two_bodies() -> None:
    """One equation for two bodies: they can still move together."""
    loose = tuple(Support(body.side("bottom"), (1,)) for body in (ONE, OTHER))
    apart = PulledSide(((RIGHT, 1.0), (LEFT, -1.0)), 0.0)
    problem = Problem("loose", (ONE, OTHER), (), loose, apart)
    with pytest.raises(
        InputError, match=r"'a motion along x of the body \w+' cannot be used; nothing prevents"
    ):
        System(problem, {"one": SPACE, "other": SPACE})
    System(replace(problem, supports=(*loose, ENDS[0])), {"one": SPACE, "other": SPACE})


def test_boundaries_that_share_points_move_these_once() -> None:
    """Where its right side and the end of its upper side are moved alike, a body is moved as a whole."""
    boundaries = ((RIGHT, 1.0), (ONE.side("top", 0.75), 1.0))
    for order in (boundaries, boundaries[::-1]):
        drive = MovedSide(order, np.pi / 2, "held")
        steps = path(Problem("free", (ONE,), (), (), drive), np.array([0.0, 0.5, 1.0]))
        for step in steps:
            expected = np.tile([0.0, step.parameter], (SPACE.size, 1))
            # the tolerance of the solver on a body of the size 24
            np.testing.assert_allclose(step.displacement, expected, rtol=0, atol=1e-9)
            assert step.reaction == pytest.approx(0.0, abs=1e-9)


def test_shared_points_count_in_one_reaction() -> None:
    """A clamped strip is bent by two boundaries that meet: whichever comes first, the total is the same."""
    boundaries = ((RIGHT, 1.0), (ONE.side("top", 0.75), 1.0))
    clamped = (Support(ONE.side("left"), (0, 1)),)
    totals = []
    for order in (boundaries, boundaries[::-1]):
        steps = path(
            Problem("bent", (ONE,), (), clamped, MovedSide(order, np.pi / 2, "held")), np.array([0.0, 0.1])
        )
        totals.append(steps[-1].reaction)
        assert sum(steps[-1].reactions) == pytest.approx(totals[-1], rel=1e-12)  # a sum of two
    assert totals[0] > 0
    assert totals[0] == pytest.approx(totals[1], rel=1e-9)  # the tolerance of the solver


@pytest.mark.parametrize(
    "drive",
    [
        MovedSide(((RIGHT, 1.0), (ONE.side("top", 0.75), 0.5)), np.pi / 2, "held"),
        RotatedSide(((RIGHT, 1.0), (ONE.side("top", 0.75), 1.0))),
    ],
)
def test_boundaries_that_share_points_must_move_alike(drive: Drive) -> None:
    """By one factor; and a rotation ties the points of each boundary about a centre of its own."""
    with pytest.raises(InputError) as caught:
        System(single(drive), SPACE)
    assert (caught.value.field, caught.value.value) == ("drive.on", "one.top")
    assert "shares points with it, by another motion" in caught.value.allowed
