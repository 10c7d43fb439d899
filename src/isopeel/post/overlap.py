"""Bodies that overlap each other, or themselves, and which interfaces give way in compression."""

from collections.abc import Iterable
from itertools import combinations
from typing import NamedTuple, get_args

import numpy as np

from isopeel.assembly.spaces import SpaceOfBodies, Spaces, spaces_by_name
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.post.fields import sample_fields
from isopeel.post.laboratory import Laboratory
from isopeel.post.states import smooth_cells
from isopeel.problem import Body, Boundary, Problem
from isopeel.results.fields import StoredState
from isopeel.results.notes import Note
from isopeel.splines.nurbs import Side

#: Depth up to which two bodies touch, as a share of the thickness of the thinner one: where two faces are
#: pressed on one plane, their laws let them pass it a little. Chords leave curved sides by less than that.
_TOUCHES = 0.02
#: The same for sides with an interface. A soft joint gives way near its front by some percent, which changes
#: nothing: by 10 % in the T-peel whose force is 0.02 % above the closed form. In transfer printing, 23 % of
#: the film changed the largest force by 4 %, as the lever arm between both bodies is shorter.
_GIVES_WAY = 0.2
#: Points that are compared with all chords of an outline at once, to save memory.
_AT_ONCE = 500
#: A side whose tangents keep within this angle is a graph over some direction, which cannot meet itself. The
#: angle of a graph is below pi; control points leave the rest.
_GRAPH = 0.95 * np.pi
#: Distance by which a point of an outline is moved outwards to see whether another part of the body is there,
#: as a share of the size of the body.
_BESIDE = 1e-6


class Overlap(NamedTuple):
    """The names of two bodies, and how deep a point of one lies inside the other.

    A body that overlaps itself has its name twice. `by_law` means that the law of an interface lets them
    overlap.
    """

    bodies: tuple[str, str]
    depth: float
    by_law: bool = False


class _Outline(NamedTuple):
    """The closed polygon about a body, anticlockwise."""

    corners: FloatArray  # (n, 2)
    sides: tuple[Side, ...]  # of the n chords, each from its corner to the next one


def overlaps(problem: Problem, space: SpaceOfBodies, displacement: FloatArray) -> list[Overlap]:
    """Return the bodies that overlap each other or themselves in a state, coefficients (size, 2).

    Two bodies with an interface overlap where one enters the other through a side without one, deeper than
    through a side with one: there the law lets them overlap a little. They also overlap where it lets them
    overlap by more than a fifth of the thickness of the thinner body. Sides that are tied do not overlap.
    """
    spaces = Spaces.on(problem, space)
    return _overlaps(spaces, space, spaces.control_points(), displacement)


def _overlaps(
    spaces: Spaces, space: SpaceOfBodies, at_rest: FloatArray, displacement: FloatArray
) -> list[Overlap]:
    """Return the overlaps in a state of bodies whose control points at rest (size, 2) are known."""
    problem = spaces.problem
    # a body lies in the box about its control points
    points = at_rest + displacement
    boxes = {
        name: (points[place].min(axis=0), points[place].max(axis=0)) for name, place in spaces.places.items()
    }
    thickness = {body.name: _thickness(body) for body in problem.bodies}
    grids: dict[str, FloatArray] = {}

    def grid(name: str) -> FloatArray:
        if name not in grids:
            cells = smooth_cells(spaces.of[name])
            grids[name] = _joined(sample_fields(problem, space, displacement, cells, name).position)
        return grids[name]

    found = []
    for body in problem.bodies:
        if not _turns_back(spaces, body, points):
            continue
        depth = _depth_in_itself(_outline(grid(body.name)))
        if depth > _TOUCHES * thickness[body.name]:
            found.append(Overlap((body.name, body.name), depth))
    for pair in combinations(boxes, 2):
        thinner = min(thickness[name] for name in pair)
        touches = _TOUCHES * thinner
        low = np.maximum(*(boxes[name][0] for name in pair)) - touches
        high = np.minimum(*(boxes[name][1] for name in pair)) + touches
        if (high - low <= 3 * touches).any():
            continue
        free, tied, by_law = 0.0, 0.0, 0.0
        for one, other in (pair, pair[::-1]):
            near = grid(one).reshape(-1, 2)
            near = near[((near >= low) & (near <= high)).all(axis=1)]
            outline = _outline(grid(other))
            depths, chords = _depths(near, outline)
            sides = np.array(outline.sides)[chords]
            adheres = np.isin(sides, _sides_towards(problem, other, one))
            follows = np.isin(sides, _tied_sides(problem, other, one))
            free = max(free, float(depths[~adheres & ~follows].max(initial=0.0)))
            tied = max(tied, float(depths[follows].max(initial=0.0)))
            by_law = max(by_law, float(depths[adheres].max(initial=0.0)))
        if free > max(touches, tied, by_law):
            found.append(Overlap(pair, free))
        elif by_law > _GIVES_WAY * thinner:
            found.append(Overlap(pair, by_law, by_law=True))
    return found


def _thickness(body: Body) -> float:
    """Return twice the area of a body at rest over its perimeter: of a long strip, its height."""
    return 2 * body.shape.area() / sum(body.shape.boundary(side).length() for side in get_args(Side))


def _sides_towards(problem: Problem, name: str, other: str) -> list[Side]:
    """Return the sides of a body that have an interface with another one."""
    return [
        near.side
        for interface in problem.interfaces
        if isinstance(interface.against, Boundary)
        for near, far in ((interface.boundary, interface.against), (interface.against, interface.boundary))
        if (near.body, far.body) == (name, other)
    ]


def _tied_sides(problem: Problem, name: str, other: str) -> list[Side]:
    """Return the sides of a body that are tied to another one."""
    return [
        near.side
        for tie in problem.ties
        for near, far in ((tie.boundary, tie.to), (tie.to, tie.boundary))
        if (near.body, far.body) == (name, other)
    ]


def _turns_back(spaces: Spaces, body: Body, points: FloatArray) -> bool:
    """Return whether a side of a body turns so far that it may meet itself, by control points (size, 2)."""
    for side in get_args(Side):
        legs = np.diff(points[spaces.boundary(body.side(side))], axis=0)
        if np.ptp(np.unwrap(np.arctan2(legs[:, 1], legs[:, 0]))) >= _GRAPH:
            return True
    return False


def overlap_notes_at_rest(problem: Problem, space: SpaceOfBodies, laboratory: Laboratory) -> list[Note]:
    """Return a note on the bodies that overlap each other or themselves before the first step."""
    at_rest = np.zeros((sum(one.size for one in spaces_by_name(problem, space).values()), 2))
    return [_note(problem, one, "at the start", laboratory) for one in overlaps(problem, space, at_rest)]


def overlap_notes(
    problem: Problem, space: SpaceOfBodies, states: Iterable[StoredState], laboratory: Laboratory
) -> list[Note]:
    """Return a note on the bodies that overlap each other or themselves in one of the states."""
    first: dict[tuple[tuple[str, str], bool], float] = {}
    deepest: dict[tuple[tuple[str, str], bool], Overlap] = {}
    spaces = Spaces.on(problem, space)
    at_rest = spaces.control_points()
    for state in states:
        for one in _overlaps(spaces, space, at_rest, state.displacement):
            key = one.bodies, one.by_law
            first.setdefault(key, state.parameter)
            deepest[key] = max(deepest.get(key, one), one)
    column = problem.drive.parameter_column
    return [
        _note(problem, one, f"from {laboratory.parameter(column, first[key])} on", laboratory)
        for key, one in deepest.items()
    ]


def _note(problem: Problem, overlap: Overlap, when: str, laboratory: Laboratory) -> Note:
    one, other = overlap.bodies
    by = laboratory.text(overlap.depth, "length", 2)
    if one == other:
        text = f"the body {one} overlaps itself {when}, by up to {by}: there is no contact with itself"
    elif overlap.by_law:
        thinner = min((problem.body_of(name) for name in overlap.bodies), key=_thickness)
        share = 100 * overlap.depth / _thickness(thinner)
        text = (
            f"the bodies {one} and {other} overlap {when}, by up to {by}, {share:.0f} % of the thickness of"
            f" {thinner.name}: the law of their interface gives way in compression"
        )
    else:
        joined = bool(_sides_towards(problem, one, other))
        what = "no interface between the sides that meet" if joined else "no contact between them"
        text = f"the bodies {one} and {other} overlap {when}, by up to {by}: there is {what}"
    return Note("penetration", text)


def _joined(position: FloatArray) -> FloatArray:
    """Return positions (n_x, n_y, a, b, 2) at the nodes of all elements as one grid (rows, columns, 2)."""
    n_x, n_y, a, b, _ = position.shape
    grid = position.transpose(0, 2, 1, 3, 4).reshape(n_x * a, n_y * b, 2)
    # elements share their edges
    rows, columns = (np.delete(np.arange(n * m), np.arange(m, n * m, m)) for n, m in ((n_x, a), (n_y, b)))
    joined: FloatArray = grid[np.ix_(rows, columns)]
    return joined


def _outline(grid: FloatArray) -> _Outline:
    """Return the closed polygon about a grid (rows, columns, 2)."""
    corners = np.concatenate([grid[:-1, 0], grid[-1, :-1], grid[:0:-1, -1], grid[0, :0:-1]])
    along, across = len(grid) - 1, grid.shape[1] - 1
    names: tuple[tuple[Side, int], ...] = (
        ("bottom", along),
        ("right", across),
        ("top", along),
        ("left", across),
    )
    return _Outline(corners, tuple(side for side, count in names for _ in range(count)))


def _depths(points: FloatArray, outline: _Outline) -> tuple[FloatArray, IntArray]:
    """Return the depths of the points (n, 2) that lie inside a polygon, and their closest chords."""
    depths, chords = [np.zeros(0)], [np.zeros(0, dtype=np.int64)]
    for at in np.split(points, range(_AT_ONCE, len(points), _AT_ONCE)):
        inside = _windings(at, outline) != 0
        if inside.any():
            distance = _distances(at[inside], outline)
            chords.append(distance.argmin(axis=1))
            depths.append(distance.min(axis=1))
    return np.concatenate(depths), np.concatenate(chords)


def _depth_in_itself(outline: _Outline) -> float:
    """Return how deep a part of a closed polygon lies inside another part of it, zero where it does not."""
    corners = outline.corners
    along = np.roll(corners, -1, axis=0) - corners
    outward = np.stack([along[:, 1], -along[:, 0]], axis=1)
    outward /= np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), np.finfo(np.float64).tiny)
    normal = outward + np.roll(outward, 1, axis=0)
    beside = corners + _BESIDE * np.ptp(corners, axis=0).max() * normal
    depth = 0.0
    for some in np.split(np.arange(len(corners)), range(_AT_ONCE, len(corners), _AT_ONCE)):
        covered = some[_windings(beside[some], outline) != 0]
        # the part that it has entered faces it; its own chords do not
        facing = normal[covered] @ outward.T < 0.0
        distance = np.where(facing, _distances(corners[covered], outline), np.inf).min(axis=1, initial=np.inf)
        depth = max(depth, float(distance[np.isfinite(distance)].max(initial=0.0)))
    return depth


def _windings(points: FloatArray, outline: _Outline) -> IntArray:
    """Return how often a closed polygon goes anticlockwise around each point (n, 2)."""
    x, y = points[:, :1], points[:, 1:]
    (x0, y0), (x1, y1) = outline.corners.T, np.roll(outline.corners, -1, axis=0).T
    # a ray to the right crosses a chord that rises with the point on its left, or falls with it on its right
    meets = (y0 <= y) != (y1 <= y)
    left = (x1 - x0) * y - (y1 - y0) * x > (x1 - x0) * y0 - (y1 - y0) * x0
    rises = y1 > y0
    windings: IntArray = np.where(meets & (left == rises), np.where(rises, 1, -1), 0).sum(axis=1)
    return windings


def _distances(points: FloatArray, outline: _Outline) -> FloatArray:
    """Return the distances (n, chords) of points (n, 2) from the chords of a polygon."""
    start = outline.corners
    along, to = np.roll(start, -1, axis=0) - start, points[:, None] - start
    squares = np.maximum((along**2).sum(axis=1), np.finfo(np.float64).tiny)
    share = np.clip((to * along).sum(axis=2) / squares, 0.0, 1.0)
    distances: FloatArray = np.linalg.norm(to - share[..., None] * along, axis=2)
    return distances
