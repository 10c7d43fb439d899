"""The side of a body of Lagrange elements as a smooth auxiliary curve that is tied to its nodes.

Points of contact are y = N T u with the splines N of the curve and the interpolation T of the nodes (Otto, De
Lorenzis and Unger, Comput. Mech. 63, 2019). Here T is Bessel's method: a cubic spline through all nodes with
continuous tangents, which are those of the parabolas through three nodes (Piegl and Tiller, The NURBS Book,
Eqs. 9.30 and 9.31). It is local: a point of contact feels four nodes, so that the tangent stays narrow.
"""

from typing import TYPE_CHECKING

import numpy as np

from isopeel.assembly.facing_curve import FacingCurve
from isopeel.assembly.spaces import Spaces
from isopeel.assembly.tables import element_ends, table_at
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.problem import Boundary
from isopeel.splines.nurbs import NurbsCurve
from isopeel.splines.rows import RowSpace
from isopeel.splines.space import SplineSpace

if TYPE_CHECKING:
    from scipy.sparse import csr_array

#: Distance from a breakpoint of a shape at which its tangents on both sides are compared, and the sine of
#: their angle above which the shape has a corner there: a smooth shape turns less over the distance.
_ASIDE, _CORNER = 1e-7, 1e-4


def is_lagrange(spaces: Spaces, boundary: Boundary) -> bool:
    """Return whether a side consists of several elements whose functions are only continuous."""
    space = _along(spaces.of[boundary.body], boundary)
    return space.elements > 1 and space.size == space.elements * space.degree + 1


def smoothed_curve(spaces: Spaces, boundary: Boundary) -> FacingCurve:
    """Return the smooth curve through the nodes of the whole side that a boundary is a part of.

    The nodes of an element of degree p are at p + 1 equal distances of the parameter. They carry the shape of
    the curve too, so that forces on them have the moment of those on the curve. Corners of the shape remain.
    """
    from scipy.sparse import csr_array

    body, side = spaces.problem.body_of(boundary.body), boundary.side
    space, edge = spaces.of[boundary.body], body.shape.boundary(side)
    ends, degree = element_ends(space, side, (0.0, 1.0)), _along(space, boundary).degree
    places = ends[:-1, None] + np.diff(ends)[:, None] * np.arange(degree + 1) / degree
    places[:, -1] = ends[1:]
    table = table_at(body.shape, space, side, places, np.zeros(places.shape)).of_values()
    # the last node of an element is the first one of the next
    kept = np.ones(places.shape, dtype=bool)
    kept[:-1, -1] = False
    nodes, positions = places[kept], table.positions[kept]
    functions = np.broadcast_to(table.functions[:, None], table.values.shape)[kept]
    rows = np.broadcast_to(np.arange(nodes.size)[:, None], functions.shape)
    values = csr_array(
        (table.values[kept].ravel(), (rows.ravel(), functions.ravel())), (nodes.size, spaces.size)
    )
    points = _bezier_points(nodes, _corners(edge, nodes))
    segment_functions, numerators = _by_functions([of_point @ values for of_point in points])
    shape = np.stack([of_point @ positions for of_point in points], axis=-1)
    return FacingCurve(
        ends=nodes,
        functions=spaces.places[boundary.body].start + segment_functions,
        values=numerators,
        weights=np.ones((nodes.size - 1, 4)),
        shape=np.ascontiguousarray(shape),
        # the boundary of the body runs anticlockwise
        orientation=1.0 if side in ("bottom", "right") else -1.0,
    )


def _along(space: RowSpace, boundary: Boundary) -> SplineSpace:
    """Return the functions along a side."""
    if boundary.side in ("left", "right"):
        return space.across
    return space.rows[0 if boundary.side == "bottom" else -1]


def _corners(edge: NurbsCurve, nodes: FloatArray) -> list[int]:
    """Return the numbers of the nodes at which an undeformed side has a corner."""
    inner = edge.space.breakpoints[1:-1]
    found = []
    for place in inner:
        before, beyond = edge.derivatives([place - _ASIDE, place + _ASIDE], 1)[1]
        turn = before[0] * beyond[1] - before[1] * beyond[0]
        if abs(turn) > _CORNER * np.hypot(*before) * np.hypot(*beyond):
            found.append(int(np.argmin(np.abs(nodes - place))))
    return found


def _bezier_points(nodes: FloatArray, corners: list[int]) -> "list[csr_array]":
    """Return the matrices (segments, nodes) of the four Bezier points of the segments between nodes."""
    from scipy.sparse import csr_array

    count = nodes.size
    segments, breaks = np.arange(count - 1), np.array([0, *corners, count - 1])
    # the smooth part of the curve that a segment belongs to
    part = np.searchsorted(breaks, segments, side="right") - 1
    first, last = breaks[part], breaks[part + 1]

    def matrix(columns: IntArray, values: FloatArray) -> "csr_array":
        rows = np.broadcast_to(segments[:, None], columns.shape)
        return csr_array((values.ravel(), (rows.ravel(), columns.ravel())), (count - 1, count))

    ones, third = np.ones((count - 1, 1)), np.diff(nodes)[:, None] / 3
    begin, end = matrix(segments[:, None], ones), matrix(segments[:, None] + 1, ones)
    columns, slopes = _tangents(nodes, segments, first, last)
    beside_begin = begin + matrix(columns, third * slopes)
    columns, slopes = _tangents(nodes, segments + 1, first, last)
    return [begin, beside_begin, end - matrix(columns, third * slopes), end]


def _tangents(
    nodes: FloatArray, at: IntArray, first: IntArray, last: IntArray
) -> tuple[IntArray, FloatArray]:
    """Return numbers and weights (n, 3) of the nodes in the derivatives at some nodes (n,).

    They are those of the parabolas through three nodes from the first to the last one of a smooth part, and
    of the straight line where it has two only.
    """
    middle = np.clip(at, first + 1, np.maximum(last - 1, first + 1))
    columns = np.stack([middle - 1, middle, np.minimum(middle + 1, last)], axis=1)
    a, b, c = nodes[columns].T
    straight = last - first == 1
    c = np.where(straight, np.inf, c)
    x = nodes[at]
    with np.errstate(invalid="ignore"):
        slopes = np.stack(
            [
                (2 * x - b - c) / ((a - b) * (a - c)),
                (2 * x - a - c) / ((b - a) * (b - c)),
                (2 * x - a - b) / ((c - a) * (c - b)),
            ],
            axis=1,
        )
    line = np.stack([1 / (a - b), 1 / (b - a), np.zeros(a.size)], axis=1)
    return columns, np.where(straight[:, None], line, slopes)


def _by_functions(points: "list[csr_array]") -> tuple[IntArray, FloatArray]:
    """Return the functions (S, m) of segments, and the Bezier points (S, m, 4) of each.

    Segments with fewer functions than others repeat one, with the value zero.
    """
    used = [
        np.unique(np.concatenate([point.indices[point.indptr[s] : point.indptr[s + 1]] for point in points]))
        for s in range(points[0].shape[0])
    ]
    most = max(map(len, used))
    functions = np.array([np.pad(one, (0, most - len(one)), mode="edge") for one in used], dtype=np.int64)
    rows = np.repeat(np.arange(len(used)), most)
    values = np.stack(
        [np.asarray(point[rows, functions.ravel()]).reshape(functions.shape) for point in points], axis=-1
    )
    repeated = np.arange(most) >= np.array([len(one) for one in used])[:, None]
    values[repeated] = 0.0
    return functions, np.ascontiguousarray(values)
