"""Element tables: shape functions and quadrature weights at all points, made once."""

from dataclasses import dataclass, replace

import numpy as np

from isopeel.assembly.spaces import HELD, Spaces
from isopeel.common.arrays import BoolArray, FloatArray, IntArray
from isopeel.common.errors import InputError
from isopeel.problem import Body, Boundary
from isopeel.problem.boundary import ROUND_OFF
from isopeel.splines.nurbs import NurbsSurface, Side
from isopeel.splines.rows import Basis, RowSpace

#: Most Gauss points on an element: more are useless, because the adhesive force is smooth.
MOST_CONTACT_POINTS = 100
#: Number of digits to which the values of equal lines of points agree: the round-off of their evaluation.
_DIGITS = 13
#: Share of the largest Jacobian below which a Jacobian counts as zero: at a corner with tangential sides.
FLAT = 1e-9
#: Distance from a corner of a shape at which its tangent is evaluated, as a share of that to the middle.
_INWARDS = 1e-9


@dataclass(frozen=True, eq=False)
class BodyTable:
    """The functions of all elements as products, and the maps from their derivatives to the gradient.

    There are X elements along xi with P Gauss points each, and Y across with R each. A function of row j is a
    function along xi times M_j(eta). Rows with one space are of one kind; in a rational body they must have
    the same weights too.

    Equal lines of points along xi share their maps and their areas, for example on a rectangle.

    The gradient with respect to the reference position is a sum of channels: the derivatives by xi and by
    eta of sum_j M_j sum_i w_ij N_i^(j) u_ij and, where weights make the functions rational, its value, by
    the quotient rule.
    """

    kinds: IntArray  # (rows,)
    sizes: IntArray  # (kinds,) functions that do not vanish on an element
    along: FloatArray  # (kinds, 2, P, largest size, X) values and derivatives along xi, times the weights
    first: IntArray  # (rows, X) number of the first function of a row on an element; the others follow
    across: FloatArray  # (Y, 2, R, C) values and derivatives of the C rows of an element
    first_rows: IntArray  # (Y,)
    map_kinds: IntArray  # (Y, R) of lines of points along xi
    maps: FloatArray  # (map kinds, P, channels, 2, X): d/dX_J = sum_h maps[h, J] channel_h
    weight_kinds: IntArray  # (Y, R)
    weights: FloatArray  # (weight kinds, P, X) reference area of each point
    rectangles: BoolArray  # (Y, R) whether a line's elements are equal rectangles, with diagonal maps
    xi: FloatArray  # (X, P)
    eta: FloatArray  # (Y, R)

    @property
    def area(self) -> float:
        """Return the reference area of the body."""
        return float(self.weights.sum(axis=(1, 2))[self.weight_kinds].sum())

    def functions(self) -> tuple[IntArray, ...]:
        """Return the indices (X, m) of the functions of the elements, for each row of elements."""
        rows = [
            first[:, None] + np.arange(size)
            for first, size in zip(self.first, self.sizes[self.kinds], strict=True)
        ]
        count = self.across.shape[3]
        return tuple(np.concatenate(rows[start : start + count], axis=1) for start in self.first_rows)

    def unknowns(self, unknowns: IntArray) -> IntArray:
        """Return the unknowns (rows, 2, largest size, X) of the functions of each row, filled with HELD."""
        largest = self.along.shape[3]
        numbers = np.full((*self.first.shape, largest, 2), HELD)
        for j, size in enumerate(self.sizes[self.kinds]):
            numbers[j, :, :size] = unknowns[self.first[j][:, None] + np.arange(size)]
        return np.ascontiguousarray(numbers.transpose(0, 3, 2, 1))


@dataclass(frozen=True, eq=False)
class SideTable:
    """The part of a side's elements that adheres: E elements of Q quadrature points each."""

    functions: IntArray  # (E, m) numbers of all functions of the elements at the side
    values: FloatArray  # (E, Q, m)
    gradients: FloatArray  # (E, Q, 2, m)
    weights: FloatArray  # (E, Q) reference length of each point
    positions: FloatArray  # (E, Q, 2) reference position of each point
    normals: FloatArray  # (E, Q, 2) outward unit normal of the reference side

    def of_values(self) -> "SideTable":
        """Return the same table without functions that vanish on the side, if no gradient is needed."""
        (kept,) = np.nonzero((self.values != 0).any(axis=(0, 1)))
        return replace(
            self,
            functions=np.ascontiguousarray(self.functions[:, kept]),
            values=np.ascontiguousarray(self.values[..., kept]),
            gradients=np.ascontiguousarray(self.gradients[..., kept]),
        )


def body_table(shape: NurbsSurface, space: RowSpace) -> BodyTable:
    """Return the table of all elements, with one more Gauss point than the highest degree per direction."""
    xi, xi_weights = gauss_points(space.rows[0].breakpoints, space.degree + 1)
    eta, eta_weights = gauss_points(space.across.breakpoints, space.across.degree + 1)
    kinds, along = _along(space, xi)
    rows = np.arange(space.across.elements)
    across = np.stack(
        [space.across.basis(e, 1, np.full(e.size, y))[0] for e, y in zip(eta, rows, strict=True)]
    )
    first_rows = space.across.first_functions
    maps, weights = [], []
    for e, e_weights, functions, start in zip(eta, eta_weights, across, first_rows, strict=True):
        # of one row of elements: (R, P, X)
        row = kinds[start : start + across.shape[3]]
        x, y = np.broadcast_arrays(xi.T, e[:, None, None])
        jacobian = shape.jacobian(x.ravel(), y.ravel())
        determinant = _positive(jacobian, x.ravel(), y.ravel()).reshape(x.shape)
        weights.append(e_weights[:, None, None] * xi_weights.T * determinant)
        inverse = np.linalg.inv(jacobian).astype(np.float64, copy=False)
        inverse = np.moveaxis(inverse.reshape(*x.shape, 2, 2), 2, -1)
        maps.append(inverse if space.weights is None else _rational(inverse, along[row], functions))
    map_kinds, different_maps = _kinds(np.array(maps))
    weight_kinds, different_weights = _kinds(np.array(weights))
    pairs = zip(map_kinds.flat, weight_kinds.flat, strict=True)
    rectangles = np.array([_of_rectangles(different_maps[m], different_weights[w]) for m, w in pairs])
    return BodyTable(
        kinds,
        np.array([space.rows[list(kinds).index(kind)].degree + 1 for kind in range(len(along))]),
        along,
        np.stack([o + r.first_functions for o, r in zip(space.offsets[:-1], space.rows, strict=True)]),
        across,
        first_rows,
        map_kinds,
        different_maps,
        weight_kinds,
        different_weights,
        rectangles.reshape(map_kinds.shape),
        xi,
        eta,
    )


def _kinds(values: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return the kinds (Y, R) of lines with values (Y, R, ...), and the values of one line of each kind."""
    lines = values.reshape(-1, *values.shape[2:])
    # minus zero is zero
    rounded = np.round(lines / np.abs(lines).max(), _DIGITS) + 0.0
    numbers: dict[bytes, int] = {}
    kinds = np.array([numbers.setdefault(line.tobytes(), len(numbers)) for line in rounded])
    _, first = np.unique(kinds, return_index=True)
    return kinds.reshape(values.shape[:2]), lines[first]


def _of_rectangles(maps: FloatArray, weights: FloatArray) -> bool:
    """Return whether maps (P, channels, 2, X) are diagonal, and equal on all elements, like areas (P, X)."""
    if maps.shape[1] == 3:
        return False
    limit = 10.0**-_DIGITS
    oblique, uneven = maps[:, [0, 1], [1, 0]], maps - maps[..., :1]
    # the size of an element is the difference of two breakpoints, with the round-off of these
    of_sizes = max(limit, 4 * weights.shape[-1] * np.finfo(np.float64).eps)
    return bool(
        max(np.abs(oblique).max(), np.abs(uneven).max()) <= limit * np.abs(maps).max()
        and np.abs(weights - weights[..., :1]).max() <= of_sizes * weights.max()
    )


def _along(space: RowSpace, xi: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return kinds of the rows, and values and derivatives (kinds, 2, P, largest size, X) of functions."""
    elements = np.repeat(np.arange(xi.shape[0]), xi.shape[1])
    if space.weights is None:
        distinct = list(dict.fromkeys(space.rows))
        kinds = np.array([distinct.index(row) for row in space.rows])
        weights = [np.ones(row.size) for row in distinct]
    else:
        distinct, kinds, weights = list(space.rows), np.arange(len(space.rows)), list(space.weights)
    along = np.zeros((len(distinct), 2, xi.shape[1], space.degree + 1, xi.shape[0]))
    for table, row, weight in zip(along, distinct, weights, strict=True):
        functions, first = row.basis(xi.ravel(), 1, elements)
        scaled = functions * weight[first[:, None] + np.arange(row.degree + 1)]
        table[:, :, : row.degree + 1] = scaled.reshape(2, *xi.shape, -1).transpose(0, 2, 3, 1)
    return kinds, along


def _rational(inverse: FloatArray, along: FloatArray, across: FloatArray) -> FloatArray:
    """Return maps (R, P, 3, 2, X) of u = A/W: du/dX = (dA - A dW/W)/W dxi/dX, from dxi/dX (R, P, 2, 2, X).

    W and dW are sums over the rows of an element, of along (C, 2, P, size, X) times across (2, R, C).
    """
    lines = along.sum(axis=3)
    W = np.einsum("rc,cpx->rpx", across[0], lines[:, 0])
    dW = np.stack(
        [np.einsum("rc,cpx->rpx", across[0], lines[:, 1]), np.einsum("rc,cpx->rpx", across[1], lines[:, 0])],
        axis=2,
    )
    of_derivatives = inverse / W[:, :, None, None]
    of_value = -np.einsum("rpix,rpiJx->rpJx", dW, of_derivatives) / W[:, :, None]
    return np.concatenate([of_derivatives, of_value[:, :, None]], axis=2)


def body_of(spaces: Spaces, body: Body) -> BodyTable:
    """Table of one of several bodies, see `body_table`."""
    table = body_table(body.shape, spaces.of[body.name])
    return replace(table, first=spaces.places[body.name].start + table.first)


def side_of(spaces: Spaces, boundary: Boundary, points: int | None = None) -> SideTable:
    """Table of a boundary of one of several bodies, see `side_table`."""
    body = spaces.problem.body_of(boundary.body)
    table = side_table(body.shape, spaces.of[body.name], boundary.side, boundary.part, points)
    return replace(table, functions=spaces.places[body.name].start + table.functions)


def side_table(
    shape: NurbsSurface, space: RowSpace, side: Side, part: tuple[float, float], points: int | None = None
) -> SideTable:
    """Table of a part of a side, from one of its parameters to another.

    Elements that the part covers in part are integrated over that part, with full accuracy. There are
    `points` Gauss points on each, by default one more than the highest degree along the side.
    """
    if points is not None and not 1 <= points <= MOST_CONTACT_POINTS:
        raise InputError("contact_points", points, f"there can be 1 to {MOST_CONTACT_POINTS} on an element")
    parameter, weights = side_points(space, side, part, points)
    return table_at(shape, space, side, parameter, weights)


def side_points(
    space: RowSpace, side: Side, part: tuple[float, float], points: int | None = None
) -> tuple[FloatArray, FloatArray]:
    """Return parameters and weights (E, Q) of the Gauss points of `side_table`, in units of the parameter."""
    return gauss_points(element_ends(space, side, part), points or usual_points(space, side))


def usual_points(space: RowSpace, side: Side) -> int:
    """Number of Gauss points on an element of a side by default."""
    return (space.across.degree if side in ("left", "right") else space.degree) + 1


def element_ends(space: RowSpace, side: Side, part: tuple[float, float]) -> FloatArray:
    """Return the parameters (E + 1,) of the ends of the elements of a part of a side."""
    start, end = part
    breakpoints = (space.across if side in ("left", "right") else space.rows[0]).breakpoints
    inside = breakpoints[(breakpoints > start + ROUND_OFF) & (breakpoints < end - ROUND_OFF)]
    return np.concatenate([[start], inside, [end]])


def table_at(
    shape: NurbsSurface, space: RowSpace, side: Side, parameter: FloatArray, weights: FloatArray
) -> SideTable:
    """Return the table of points (E, Q) of a side, each row on one element, with weights over the parameter.

    Gradients are nan at a corner where two sides meet tangentially. Elements with fewer functions than others
    repeat one, with the value zero. Raises InputError if the patch folds.
    """
    elements, quadrature = parameter.shape
    upright = side in ("left", "right")
    constant = np.full(parameter.size, 0.0 if side in ("left", "bottom") else 1.0)
    # a point between two elements belongs to the element of its row
    inside = parameter.mean(axis=1, keepdims=True)
    holders = (space.across if upright else space.rows[0]).element_of(inside[:, 0])
    # at a corner of the shape, its tangent is evaluated inside this element
    corners = np.isin(parameter, shape.spaces[int(upright)].breakpoints[1:-1])
    seen = (parameter + corners * _INWARDS * (inside - parameter)).ravel()
    if upright:
        xi, eta = constant, parameter.ravel()
        basis = _on_upright_side(space, xi, parameter, holders)
        jacobian = shape.jacobian(xi, seen)
    else:
        xi, eta = parameter.ravel(), constant
        row = 0 if side == "bottom" else space.elements[1] - 1
        basis = space.basis(xi, eta, row, np.repeat(holders, quadrature))
        jacobian = shape.jacobian(seen, eta)
    tangent = jacobian[:, :, int(upright)] * (1 if side in ("bottom", "right") else -1)
    length = np.linalg.norm(tangent, axis=1)
    # the boundary runs anticlockwise, so the outward normal is to its right
    normals = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1) / length[:, None]
    m = basis.functions.shape[1]
    return SideTable(
        functions=basis.functions.reshape(elements, quadrature, m)[:, 0].copy(),
        values=basis.values.reshape(elements, quadrature, m),
        gradients=_reference_gradients(jacobian, basis, xi, eta).reshape(elements, quadrature, 2, m),
        weights=weights * length.reshape(elements, quadrature),
        positions=shape.evaluate(xi, eta).reshape(elements, quadrature, 2),
        normals=normals.reshape(elements, quadrature, 2),
    )


def _on_upright_side(space: RowSpace, xi: FloatArray, parameter: FloatArray, holders: IntArray) -> Basis:
    """Return functions at parameters (E, Q) of the left or right side; `holders` (E,) are the elements."""
    order = np.argsort(holders, kind="stable")
    parts = []
    for row in np.unique(holders):
        eta = parameter[holders == row].ravel()
        parts.append(space.basis(xi[: eta.size], eta, int(row)))
    most = max(part.functions.shape[1] for part in parts)
    parts = [_padded(part, most) for part in parts]
    # restore the order of the points
    places = np.empty(parameter.shape, dtype=np.int64)
    places[order] = np.arange(parameter.size).reshape(parameter.shape)
    return Basis(*(np.concatenate(arrays)[places.ravel()] for arrays in zip(*parts, strict=True)))


def _padded(basis: Basis, count: int) -> Basis:
    """Return the same with more functions at each point: the last ones repeat the first with the value 0."""
    more = (0, count - basis.functions.shape[1])
    return Basis(
        np.concatenate([basis.functions, np.repeat(basis.functions[:, :1], more[1], axis=1)], axis=1),
        np.pad(basis.values, ((0, 0), more)),
        np.pad(basis.derivatives, ((0, 0), (0, 0), more)),
    )


def gauss_points(breakpoints: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    """Return Gauss-Legendre points and weights (elements, count) on the intervals between breakpoints."""
    points, weights = np.polynomial.legendre.leggauss(count)
    half = np.diff(breakpoints)[:, None] / 2
    return breakpoints[:-1, None] + half * (points + 1), half * weights


def _reference_gradients(jacobian: FloatArray, basis: Basis, xi: FloatArray, eta: FloatArray) -> FloatArray:
    """Return gradients (n, 2, m) with respect to the reference position, from dX/d(xi, eta) (n, 2, 2)."""
    determinant = np.linalg.det(jacobian)
    flat = np.abs(determinant) <= FLAT * np.abs(determinant).max()
    regular = np.where(flat[:, None, None], np.eye(2), jacobian)
    _positive(regular, xi, eta)
    inverse = np.linalg.inv(regular)
    inverse[flat] = np.nan
    gradients: FloatArray = np.einsum("nJi,nim->nJm", inverse.transpose(0, 2, 1), basis.derivatives)
    return gradients


def _positive(jacobian: FloatArray, xi: FloatArray, eta: FloatArray) -> FloatArray:
    """Return the determinants (n,) of dX/d(xi, eta), (n, 2, 2); InputError if one is not positive."""
    determinant: FloatArray = np.linalg.det(jacobian)
    if np.any(determinant <= 0):
        at = int(np.argmin(determinant))
        place = (round(float(xi[at]), 6), round(float(eta[at]), 6))
        raise InputError("body.shape", place, "the patch must not fold at any point (xi, eta)")
    return determinant
