"""Bodies that overlap: which do, and how deep, in undeformed and in deformed states."""

from dataclasses import replace

import numpy as np
import pytest

from isopeel import Body, Exponential, Interface, NeoHooke, Problem, RotatedSide, Support, Tie, row_space
from isopeel.assembly.spaces import Spaces
from isopeel.common.units import UnitSystem
from isopeel.post.laboratory import Laboratory
from isopeel.post.overlap import Overlap, overlap_notes, overlap_notes_at_rest, overlaps
from isopeel.problem.place import placed
from isopeel.results.fields import StoredState
from isopeel.splines.nurbs import NurbsSurface, annulus_sector, rectangle

BLOCK = rectangle(10.0, 2.0)
COARSE = row_space("L1", (4, 1))


def problem_of(*shapes: NurbsSurface) -> Problem:
    bodies = tuple(Body(shape, NeoHooke(1.0, 0.2), name) for shape, name in zip(shapes, "ABC", strict=False))
    supports = tuple(Support(body.side("left"), (0, 1)) for body in bodies)
    return Problem("pair", bodies, (), supports, RotatedSide("right"))


def found(*shapes: NurbsSurface) -> list[Overlap]:
    problem = problem_of(*shapes)
    spaces = {
        body.name: row_space("N2", (4, 1), 2, shape=body.shape) if len(body.shape.weights) > 2 else COARSE
        for body in problem.bodies
    }
    return overlaps(problem, spaces, np.zeros((sum(space.size for space in spaces.values()), 2)))


@pytest.mark.parametrize(
    ("at", "angle", "depth"),
    [
        ((5.0, 1.0), 0.0, 1.0),  # the upper side of the first is in the middle of the second
        ((0.0, 0.0), 0.0, 1.0),  # the same place: half of the height
        ((9.5, 0.5), 0.0, 0.5),  # the ends only
        ((6.0, -4.0), np.pi / 2, 1.0),  # crossed: no corner of one is inside the other
    ],
)
def test_two_blocks_overlap(at: tuple[float, float], angle: float, depth: float) -> None:
    """Sides and middles of the blocks have points, so that the depth is exact."""
    ((pair, deepest, _),) = found(BLOCK, placed(BLOCK, at, angle))
    assert pair == ("A", "B")
    assert deepest == pytest.approx(depth, abs=1e-12)


@pytest.mark.parametrize(
    ("at", "angle"),
    [
        ((0.0, 2.0), 0.0),  # one lies on the other
        ((10.0, 2.0), 0.0),  # a corner meets a corner
        ((0.0, 2.5), 0.0),
        ((10.2, -3.0), np.pi / 4),  # their boxes overlap
        ((3.0, 1.97), 0.0),  # by less than a fiftieth of their thickness, 2 x 20/24
    ],
)
def test_two_blocks_touch_at_most(at: tuple[float, float], angle: float) -> None:
    assert found(BLOCK, placed(BLOCK, at, angle)) == []


def test_rings_that_share_an_arc_touch() -> None:
    inner, outer = annulus_sector(10.0, 12.0, 1.0), annulus_sector(12.0, 14.0, 1.0)
    assert found(inner, outer) == []
    ((_, depth, _),) = found(inner, annulus_sector(11.0, 14.0, 1.0))
    assert depth == pytest.approx(1.0, abs=1e-3)  # from one arc to the chords of the other


def test_notes_name_the_bodies_the_first_state_and_the_deepest() -> None:
    problem = problem_of(BLOCK, placed(BLOCK, (0.0, 3.0), 0.0), placed(BLOCK, (30.0, 0.0), 0.0))
    spaces = dict.fromkeys("ABC", COARSE)
    laboratory = Laboratory.of(UnitSystem(), problem)
    assert overlap_notes_at_rest(problem, spaces, laboratory) == []
    states = []
    for step, fall in enumerate((0.0, 0.5, 1.25, 2.0, 1.5)):
        u = np.zeros((3 * COARSE.size, 2))
        u[COARSE.size : 2 * COARSE.size, 1] = -fall
        states.append(StoredState(step, 10.0 * step, u))
    (note,) = overlap_notes(problem, spaces, states, laboratory)
    assert note.subject == "penetration"
    assert note.text == (
        "the bodies A and B overlap from 20 deg on, by up to 1 nm: there is no contact between them"
    )


def test_a_thin_body_overlaps_by_a_share_of_its_thickness() -> None:
    """A film a thousand times as long as thick lies half in a block: its length is no measure of a depth."""
    ((pair, depth, _),) = found(placed(rectangle(1000.0, 1.0), (-500.0, 1.5), 0.0), BLOCK)
    assert pair == ("A", "B")
    assert depth == pytest.approx(0.5, abs=1e-12)


@pytest.mark.parametrize("depth", [0.05, 0.3, 0.4, 1.0])
def test_bodies_with_an_interface_overlap_where_its_law_gives_way(depth: float) -> None:
    """A note is written from a fifth of their thickness on, which is 2 x 20/24."""
    problem = problem_of(BLOCK, placed(BLOCK, (0.0, 2.0 - depth), 0.0))
    one, other = problem.bodies
    joint = Interface(one.side("top"), Exponential(0.03, 0.015), other.side("bottom"))
    joined, spaces = replace(problem, interfaces=(joint,)), dict.fromkeys("AB", COARSE)
    at_rest = np.zeros((2 * COARSE.size, 2))
    notes = overlap_notes_at_rest(joined, spaces, Laboratory.of(UnitSystem(), joined))
    if depth < 0.2 * 40 / 24:
        assert overlaps(joined, spaces, at_rest) == []
        assert notes == []
    else:
        ((pair, deepest, by_law),) = overlaps(joined, spaces, at_rest)
        assert pair == ("A", "B")
        assert by_law
        assert deepest == pytest.approx(depth, abs=1e-12)
        assert notes[0].text == (
            f"the bodies A and B overlap at the start, by up to {depth:g} nm, {60 * depth:g} % of the"
            " thickness of A: the law of their interface gives way in compression"
        )


def test_sides_that_are_tied_do_not_overlap() -> None:
    problem = problem_of(BLOCK, placed(BLOCK, (0.0, 1.9), 0.0))
    at_rest, spaces = np.zeros((2 * COARSE.size, 2)), dict.fromkeys("AB", COARSE)
    assert len(overlaps(problem, spaces, at_rest)) == 1
    one, other = problem.bodies
    tied = replace(problem, ties=(Tie(one.side("top"), other.side("bottom")),))
    assert overlaps(tied, spaces, at_rest) == []


def test_bodies_with_an_interface_overlap_through_other_sides() -> None:
    """The end of B is in the right end of A, by half a unit, and they adhere elsewhere."""
    problem = problem_of(BLOCK, placed(BLOCK, (9.5, 0.5), 0.0))
    one, other = problem.bodies
    joint = Interface(one.side("left"), Exponential(0.03, 0.015), other.side("right"))
    joined, spaces = replace(problem, interfaces=(joint,)), dict.fromkeys("AB", COARSE)
    ((pair, depth, _),) = overlaps(joined, spaces, np.zeros((2 * COARSE.size, 2)))
    assert pair == ("A", "B")
    (note,) = overlap_notes_at_rest(joined, spaces, Laboratory.of(UnitSystem(), joined))
    assert "there is no interface between the sides that meet" in note.text
    # corners of B are 0.5 from the right side of A, and middles 0.5 from that or from its upper side
    assert depth == pytest.approx(0.5, abs=1e-12)


@pytest.mark.parametrize(("pitch", "depth"), [(1.5, 0.5), (2.5, 0.0), (2.05, 0.0)])
def test_a_strip_that_is_rolled_up_overlaps_itself(pitch: float, depth: float) -> None:
    """A strip of height 2 as one and a half turns of a spiral, whose turns are a pitch apart."""
    strip, space = rectangle(100.0, 2.0), row_space("L1", (150, 1))
    problem = Problem("roll", (Body(strip, NeoHooke(1.0, 0.2), "A"),), (), (), RotatedSide("right"))
    at_rest = Spaces.on(problem, space).control_points()
    angle = 3 * np.pi * at_rest[:, 0] / 100.0
    radius = 10.0 - pitch * angle / (2 * np.pi) + at_rest[:, 1]
    rolled = radius[:, None] * np.stack([np.sin(angle), np.cos(angle)], axis=1)
    laboratory = Laboratory.of(UnitSystem(), problem)
    notes = overlap_notes(problem, space, [StoredState(7, 0.5, rolled - at_rest)], laboratory)
    found = overlaps(problem, space, rolled - at_rest)
    assert len(notes) == len(found) == (depth > 0)
    for one in found:
        assert one.bodies == ("A", "A")
        # chords of 3.6 degrees leave a circle of radius 12 by 12 (1 - cos(1.8 degrees)) = 0.006
        assert one.depth == pytest.approx(depth, abs=0.006)
        assert "the body A overlaps itself from" in notes[0].text
