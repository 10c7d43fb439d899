"""Bodies that overlap each other: without an interface between them, nothing keeps them apart."""

from collections.abc import Iterable
from itertools import combinations
from typing import NamedTuple

import numpy as np

from isopeel.assembly.spaces import SpaceOfBodies, Spaces, spaces_by_name
from isopeel.common.arrays import FloatArray
from isopeel.post.fields import sample_fields
from isopeel.post.laboratory import Laboratory
from isopeel.post.states import smooth_cells
from isopeel.problem import Boundary, Problem
from isopeel.results.fields import StoredState
from isopeel.results.notes import Note

#: Depth up to which two bodies touch, as a share of the size of the smaller one: where two faces are pressed
#: on one plane, their laws let them pass it a little. Chords leave curved sides by much less.
_TOUCHES = 1e-3
#: Points that are compared with all chords of an outline at once, to save memory.
_AT_ONCE = 500


class Overlap(NamedTuple):
    """The names of two bodies, and how deep a point of one lies inside the other."""

    bodies: tuple[str, str]
    depth: float


def overlaps(problem: Problem, space: SpaceOfBodies, displacement: FloatArray) -> list[Overlap]:
    """Return the pairs of bodies without an interface that overlap in a state, coefficients (size, 2)."""
    if len(problem.bodies) == 1:
        return []
    joined = [
        {one.boundary.body, one.against.body}
        for one in problem.interfaces
        if isinstance(one.against, Boundary)
    ]
    spaces = Spaces.on(problem, space)
    # a body lies in the box about its control points
    points = spaces.control_points() + displacement
    boxes = {
        name: (points[place].min(axis=0), points[place].max(axis=0)) for name, place in spaces.places.items()
    }
    grids: dict[str, FloatArray] = {}
    found = []
    for pair in combinations(boxes, 2):
        touches = _TOUCHES * min(float(np.max(boxes[name][1] - boxes[name][0])) for name in pair)
        low = np.maximum(*(boxes[name][0] for name in pair)) - touches
        high = np.minimum(*(boxes[name][1] for name in pair)) + touches
        if (high - low <= 3 * touches).any() or {*pair} in joined:
            continue
        for name in pair:
            if name not in grids:
                cells = smooth_cells(spaces.of[name])
                grids[name] = _joined(sample_fields(problem, space, displacement, cells, name).position)
        depth = 0.0
        for one, other in (pair, pair[::-1]):
            near = grids[one].reshape(-1, 2)
            near = near[((near >= low) & (near <= high)).all(axis=1)]
            depth = max(depth, _depth(near, _outline(grids[other])))
        if depth > touches:
            found.append(Overlap(pair, depth))
    return found


def overlap_notes_at_rest(problem: Problem, space: SpaceOfBodies, laboratory: Laboratory) -> list[Note]:
    """Return a note on each pair of bodies that overlap before the first step."""
    if len(problem.bodies) == 1:
        return []
    at_rest = np.zeros((sum(one.size for one in spaces_by_name(problem, space).values()), 2))
    found = overlaps(problem, space, at_rest)
    return [_note(pair, depth, "at the start", laboratory) for pair, depth in found]


def overlap_notes(
    problem: Problem, space: SpaceOfBodies, states: Iterable[StoredState], laboratory: Laboratory
) -> list[Note]:
    """Return a note on each pair of bodies that overlap in one of the states."""
    first: dict[tuple[str, str], float] = {}
    deepest: dict[tuple[str, str], float] = {}
    for state in states:
        for pair, depth in overlaps(problem, space, state.displacement):
            first.setdefault(pair, state.parameter)
            deepest[pair] = max(deepest.get(pair, 0.0), depth)
    column = problem.drive.parameter_column
    return [
        _note(pair, depth, f"from {laboratory.parameter(column, first[pair])} on", laboratory)
        for pair, depth in deepest.items()
    ]


def _note(pair: tuple[str, str], depth: float, when: str, laboratory: Laboratory) -> Note:
    one, other = pair
    by = laboratory.text(depth, "length", 2)
    text = f"the bodies {one} and {other} overlap {when}, by up to {by}: there is no contact between them"
    return Note("penetration", text)


def _joined(position: FloatArray) -> FloatArray:
    """Return positions (n_x, n_y, a, b, 2) at the nodes of all elements as one grid (rows, columns, 2)."""
    n_x, n_y, a, b, _ = position.shape
    grid = position.transpose(0, 2, 1, 3, 4).reshape(n_x * a, n_y * b, 2)
    # elements share their edges
    rows, columns = (np.delete(np.arange(n * m), np.arange(m, n * m, m)) for n, m in ((n_x, a), (n_y, b)))
    joined: FloatArray = grid[np.ix_(rows, columns)]
    return joined


def _outline(grid: FloatArray) -> FloatArray:
    """Return the corners (n, 2) of the closed polygon about a grid."""
    return np.concatenate([grid[:-1, 0], grid[-1, :-1], grid[:0:-1, -1], grid[0, :0:-1]])


def _depth(points: FloatArray, outline: FloatArray) -> float:
    """Return how deep a point (n, 2) lies inside a closed polygon (m, 2), zero where all are outside."""
    start, end = outline, np.roll(outline, -1, axis=0)
    along = end - start
    squares = np.maximum((along**2).sum(axis=1), np.finfo(np.float64).tiny)
    depth = 0.0
    for at in np.split(points, range(_AT_ONCE, len(points), _AT_ONCE)):
        to = at[:, None] - start
        # a ray to the right crosses the outline an odd number of times
        rises = (start[:, 1] <= at[:, None, 1]) != (end[:, 1] <= at[:, None, 1])
        left = (to[..., 0] * along[:, 1] < to[..., 1] * along[:, 0]) == (along[:, 1] > 0)
        inside = np.count_nonzero(rises & left, axis=1) % 2 == 1
        if inside.any():
            to = to[inside]
            share = np.clip((to * along).sum(axis=2) / squares, 0.0, 1.0)
            distance = np.linalg.norm(to - share[..., None] * along, axis=2).min(axis=1)
            depth = max(depth, float(distance.max()))
    return depth
