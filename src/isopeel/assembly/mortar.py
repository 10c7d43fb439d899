"""The mortar projection of the displacement of a side onto the functions of a side that lies on it.

The first and the last function of the side have the displacement that the other side has there. The others
follow from

    int psi_i (u - v) dA = 0,    sum_i psi_i = 1,    int psi_i N_j dA = delta_ij int N_j dA,

with u and v of the side that follows and of the other one. The multipliers psi_i are polynomials on each
element of the following side, dual to its functions N_j (Wohlmuth, SIAM J. Numer. Anal. 38, 2000). On an
element at an end their degree is lower by one, as the end is not free. So u is a projection of v, which is
local, keeps what the following side can represent, and transfers a constant stress exactly.
"""

import numpy as np
from scipy.sparse import csr_array, vstack

from isopeel.assembly.closest_point_kernel import closest_places, segments_at
from isopeel.assembly.facing_curve import facing_curve
from isopeel.assembly.sizes import ROUND_OFF, extent_of
from isopeel.assembly.spaces import Spaces
from isopeel.assembly.tables import table_at
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.errors import InputError
from isopeel.problem import Boundary, Tie
from isopeel.problem.boundary import boundary_names
from isopeel.splines.space import SplineSpace

#: Shares below this are the round-off of the projection.
_NO_SHARE = 1e-13
#: Parameters of breakpoints that are nearer than this are one.
_SAME_POINT = 1e-10


def projection(spaces: Spaces, tie: Tie, number: int, functions: IntArray) -> csr_array:
    """Return the shares (n, size) of the coefficients of a side that are the projection of the other one."""
    own, (along, _) = tie.boundary, side_space(spaces, tie.boundary)
    if len(functions) < 3:
        allowed = "a side that follows other functions needs one between its ends; take a finer mesh"
        raise InputError(f"tie.{number}.between", spaces.problem.side_name(own), allowed)
    shape, space = spaces.problem.body_of(own.body).shape, spaces.of[own.body]
    parameters, weights = _quadrature(spaces, tie)
    table = table_at(shape, space, own.side, parameters, weights).of_values()
    of_points = spaces.places[own.body].start + np.repeat(table.functions, parameters.shape[1], axis=0)
    mine = _rows_of(of_points, table.values.reshape(len(of_points), -1), spaces.size)[:, functions]
    theirs = _on_the_other(spaces, tie, number, table.positions.reshape(-1, 2))
    at_ends = _on_the_other(spaces, tie, number, shape.boundary(own.side).evaluate([0.0, 1.0]))
    areas = table.weights.ravel()
    inside = _dual(along, mine, parameters, areas) @ (theirs - mine[:, [0, -1]] @ at_ends)
    shares = vstack([at_ends[:1], inside, at_ends[1:]]).tocsr()
    shares.data[np.abs(shares.data) < _NO_SHARE] = 0.0
    shares.eliminate_zeros()
    # a translation is met to the last digit
    shares.data /= np.repeat(shares.sum(axis=1), np.diff(shares.indptr))
    return shares


def _quadrature(spaces: Spaces, tie: Tie) -> tuple[FloatArray, FloatArray]:
    """Return Gauss points and weights (E, Q) of the side that follows, between the breakpoints of both."""
    (along, _), (other, _) = (side_space(spaces, one) for one in (tie.boundary, tie.to))
    edge = spaces.problem.body_of(tie.to.body).shape.boundary(tie.to.side)
    places, distances = _closest(spaces, tie.boundary, edge.evaluate(other.breakpoints))
    apart = np.abs(places[:, None] - along.breakpoints).min(axis=1)
    inside = places[(distances <= _near(spaces, tie)) & (apart > _SAME_POINT)]
    ends = np.unique(np.concatenate([along.breakpoints, inside]))
    nodes, weights = np.polynomial.legendre.leggauss(along.degree + other.degree + 1)
    half = np.diff(ends)[:, None] / 2
    return ends[:-1, None] + half * (nodes + 1), half * weights


def _dual(along: SplineSpace, values: csr_array, parameters: FloatArray, areas: FloatArray) -> csr_array:
    """Return the weights (n - 2, P) of the values at P points in the coefficients of a side without its ends.

    The functions of the side have values (P, n). On an element with the functions N_j that are no ends, the
    multipliers are psi_i = d_i sum_k (G^-1)_ik q_k, with polynomials q_k, G_kj = int q_k N_j and
    d_j = int N_j, so that their sum is one.
    """
    rows, columns, weights = [], [], []
    elements = np.repeat(along.element_of(parameters.mean(axis=1)), parameters.shape[1])
    for element, first in enumerate(along.first_functions):
        at = np.flatnonzero(elements == element)
        inner = np.arange(max(first, 1), min(first + along.degree + 1, along.size - 1))
        start, end = along.breakpoints[[element, element + 1]]
        local = (2 * parameters.ravel()[at] - start - end) / (end - start)
        polynomials = np.polynomial.legendre.legvander(local, len(inner) - 1)
        found = values[at][:, inner].toarray()
        gram = (polynomials * areas[at, None]).T @ found
        multipliers = np.linalg.solve(gram, polynomials.T) * (areas[at] @ found)[:, None]
        rows.append(np.repeat(inner - 1, len(at)))
        columns.append(np.tile(at, len(inner)))
        weights.append((multipliers * areas[at]).ravel())
    places = np.concatenate(rows), np.concatenate(columns)
    found = csr_array((np.concatenate(weights), places), shape=(along.size - 2, areas.size))
    return found.multiply(1 / (values.T @ areas)[1:-1, None]).tocsr()


def _on_the_other(spaces: Spaces, tie: Tie, number: int, points: FloatArray) -> csr_array:
    """Return the values (n, size) of the functions of the side that is followed, at points (n, 2) on it."""
    other, near = tie.to, _near(spaces, tie)
    places, distances = _closest(spaces, other, points)
    beyond = np.maximum(other.start - places, places - other.end)
    farthest = int(np.argmax(distances))
    names = " and ".join(boundary_names([tie.boundary, other]))
    if distances[farthest] > near:
        place = "({:.4g}, {:.4g}) L0".format(*points[farthest])
        allowed = (
            f"the first side must lie on the second one, and its point {place} is"
            f" {distances[farthest]:.4g} L0 away; move one of the bodies, or exchange the sides"
        )
        raise InputError(f"tie.{number}.between", names, allowed)
    if beyond.max() > ROUND_OFF:
        allowed = "the first side leaves the part of the second one; leave out the part, or make it longer"
        raise InputError(f"tie.{number}.between", names, allowed)
    shape, space = spaces.problem.body_of(other.body).shape, spaces.of[other.body]
    table = table_at(shape, space, other.side, places[:, None], np.zeros((len(places), 1))).of_values()
    return _rows_of(spaces.places[other.body].start + table.functions, table.values[:, 0], spaces.size)


def _closest(spaces: Spaces, boundary: Boundary, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return parameters and distances (n,) of the points of a whole side closest to points (n, 2)."""
    curve = facing_curve(spaces, boundary)
    at_rest = segments_at(
        curve.functions, curve.values, curve.weights, curve.shape, np.zeros((spaces.size, 2))
    )
    _, segments, places = closest_places(at_rest, np.ascontiguousarray(points))
    parameters = curve.ends[segments] + places * np.diff(curve.ends)[segments]
    found = spaces.problem.body_of(boundary.body).shape.boundary(boundary.side).evaluate(parameters)
    return parameters, np.linalg.norm(points - found, axis=1)


def _near(spaces: Spaces, tie: Tie) -> float:
    """Distance of points that are one point, to round-off."""
    return ROUND_OFF * extent_of(spaces.problem.body_of(tie.boundary.body))


def _rows_of(functions: IntArray, values: FloatArray, size: int) -> csr_array:
    """Return the matrix (P, size) with values (P, m) of functions (P, m)."""
    rows = np.repeat(np.arange(len(functions)), functions.shape[1])
    found = csr_array((values.ravel(), (rows, functions.ravel())), shape=(len(functions), size))
    found.sum_duplicates()
    return found


def side_space(spaces: Spaces, boundary: Boundary) -> tuple[SplineSpace, FloatArray]:
    """Return the space along a side, and the weights of its functions."""
    space = spaces.of[boundary.body]
    along = {"bottom": space.rows[0], "top": space.rows[-1]}.get(boundary.side, space.across)
    weights = np.ones(space.size) if space.weights is None else np.concatenate(space.weights)
    return along, weights[space.side_functions(boundary.side)]
