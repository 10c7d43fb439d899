"""The row-wise space: every row of control points has a spline space of its own."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.errors import InputError
from isopeel.splines.names import parse_space_name
from isopeel.splines.nurbs import NurbsSurface, Side
from isopeel.splines.space import SplineSpace

#: Finest mesh, in elements along xi and along eta. Tables and factor of a finer one exceed a workstation's
#: memory.
FINEST_MESH = (100_000, 1_000)
#: Largest ratio of the sizes of the first and the last element. With a larger one, breakpoints of the finest
#: mesh differ by round-off only.
STRONGEST_GRADING = 1e6
#: Share of its extent by which a shape may be outside of a space that still counts as exact for rotations:
#: round-off, amplified by interpolation. The stress of a strain of this size is negligible beside adhesion.
RIGID = 1e-9


#: Function of xi (n,) and eta (n,) with values (n, ...).
SurfaceFunction = Callable[[FloatArray, FloatArray], FloatArray]


class Basis(NamedTuple):
    """The functions that do not vanish at n points, m of them at each point."""

    functions: IntArray  # (n, m) numbers of the functions
    values: FloatArray  # (n, m)
    derivatives: FloatArray  # (n, 2, m) with respect to xi and eta


@dataclass(frozen=True, eq=False)
class RowSpace:
    """Functions sum_j M_j(eta) sum_i N_i^(j)(xi) u_ij on the unit square, one space N^(j) per row j.

    `across` holds the M_j, `rows` one space along xi for each of them; all rows have the same elements. With
    `weights` (one array per row) the functions are rational: w_ij M_j N_i^(j) / sum_kl w_kl M_l N_k^(l).
    Functions are numbered row by row. With one space for all rows this is the tensor-product NURBS space
    (Piegl and Tiller, The NURBS Book, Eq. 4.12), with another one in the first row an enriched contact
    element (Sauer, Int. J. Numer. Methods Eng. 87, 2011; Corbett and Sauer, Comput. Methods Appl. Mech.
    Eng. 275, 2014).
    """

    name: str
    across: SplineSpace
    rows: tuple[SplineSpace, ...]
    weights: tuple[FloatArray, ...] | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        """Check that the rows fit together."""
        if len(self.rows) != self.across.size:
            raise InputError("rows", len(self.rows), f"the space across has {self.across.size} functions")
        for row in self.rows[1:]:
            if not np.array_equal(row.breakpoints, self.rows[0].breakpoints):
                raise InputError("rows", self.name, "all rows must have the same elements")
        for weights in self.weights or ():
            if np.any(weights <= 0):
                raise InputError("weights", float(weights.min()), "weights must be positive")

    @property
    def degree(self) -> int:
        """Highest degree along xi."""
        return max(row.degree for row in self.rows)

    @property
    def elements(self) -> tuple[int, int]:
        """Number of elements along xi and eta."""
        return self.rows[0].elements, self.across.elements

    @property
    def size(self) -> int:
        """Number of functions; a displacement field has twice as many degrees of freedom."""
        return sum(row.size for row in self.rows)

    @cached_property
    def offsets(self) -> IntArray:
        """Number of the first function of each row, (rows + 1,)."""
        return np.concatenate([[0], np.cumsum([row.size for row in self.rows])]).astype(np.int64)

    @cached_property
    def greville(self) -> FloatArray:
        """Greville points of all functions, (size, 2): the place of each function on the square."""
        points = [
            np.stack([row.greville, np.full(row.size, eta)], axis=1)
            for row, eta in zip(self.rows, self.across.greville, strict=True)
        ]
        return np.concatenate(points)

    def weighted(self, shape: NurbsSurface) -> "RowSpace":
        """Return the space with the weights of a shape on the same square.

        Each row interpolates the shape's weight function. If the rows contain that function, the result is
        the refined NURBS space of the shape, and rigid motions are exact. Translations are always exact.
        """
        if np.ptp(shape.weights) == 0:
            return replace(self, weights=None)
        weights = self._interpolate(shape.weight_function)
        return replace(self, weights=tuple(np.split(weights, self.offsets[1:-1])))

    def misfit(self, shape: NurbsSurface) -> tuple[float, float]:
        """Return the errors with which the space interpolates a shape on the same square, along xi and eta.

        Both are zero, to round-off, if the space contains the shape. Then it also contains all rigid motions
        of the shape, which are linear in the position. The errors are the largest ones at Gauss points of the
        elements, relative to the extent of the control points. The homogeneous coordinates are interpolated:
        first the curves along eta through the shape's control points, then each row along xi.
        """
        points = shape.control_points - shape.control_points[0, 0]
        extent = float(np.abs(points).max())
        homogeneous = np.concatenate(
            [points * shape.weights[..., None] / extent, shape.weights[..., None]], 2
        )
        homogeneous /= shape.weights.min()
        along, across = shape.spaces
        columns = homogeneous.swapaxes(0, 1).reshape(across.size, -1)
        few = _principal(columns)
        upwards = across.collocation(self.across.greville)
        error_across = _error(self.across, self.across.interpolate(upwards @ few), across, few)
        curves = self.across.interpolate(upwards @ columns).reshape(-1, along.size, homogeneous.shape[2])
        errors_along = [0.0]
        for row in dict.fromkeys(self.rows):
            chosen = [j for j, other in enumerate(self.rows) if other == row]
            wanted = _principal(curves[chosen].transpose(1, 0, 2).reshape(along.size, -1))
            values = along.collocation(row.greville) @ wanted
            errors_along.append(_error(row, row.interpolate(values), along, wanted))
        return max(errors_along), error_across

    def interpolate(self, function: SurfaceFunction) -> FloatArray:
        """Return the coefficients (size, ...) of the field that equals a function at the Greville points.

        The function maps xi (n,) and eta (n,) to values (n, ...). It is reproduced if the space contains it.
        """
        if self.weights is None:
            return self._interpolate(function)
        weights = np.concatenate(self.weights)

        def numerator(xi: FloatArray, eta: FloatArray) -> FloatArray:
            values = function(xi, eta)
            product: FloatArray = values * _like(self._denominator(xi, eta), values)
            return product

        coefficients = self._interpolate(numerator)
        quotient: FloatArray = coefficients / _like(weights, coefficients)
        return quotient

    def _interpolate(self, function: SurfaceFunction) -> FloatArray:
        """Return the same for polynomial rows: first across, at the Greville points of a row, then along."""
        curves: dict[SplineSpace, FloatArray] = {}  # by space, since most rows share one
        for row in self.rows:
            if row not in curves:
                values = function(
                    np.repeat(row.greville, self.across.size), np.tile(self.across.greville, row.size)
                )
                values = values.reshape(row.size, self.across.size, *values.shape[1:])
                curves[row] = self.across.interpolate(np.moveaxis(values, 1, 0))
        return np.concatenate([row.interpolate(curves[row][j]) for j, row in enumerate(self.rows)])

    def _denominator(self, xi: FloatArray, eta: FloatArray) -> FloatArray:
        """Return sum_kl w_kl M_l(eta) N_k^(l)(xi) at points (n,)."""
        across = self.across.collocation(eta).toarray()
        rows = zip(self.rows, self.weights or (), strict=True)
        along = np.stack([row.collocation(xi) @ weights for row, weights in rows], axis=1)
        total: FloatArray = np.sum(across * along, axis=1)
        return total

    def side_functions(self, side: Side) -> IntArray:
        """Return the numbers of the functions that do not vanish on a side, in the order of its parameter."""
        match side:
            case "left":
                return self.offsets[:-1]
            case "right":
                return self.offsets[1:] - 1
            case "bottom":
                return np.arange(self.offsets[1])
            case "top":
                return np.arange(self.offsets[-2], self.offsets[-1])

    def basis(
        self, xi: FloatArray, eta: FloatArray, element_row: int, elements: IntArray | None = None
    ) -> Basis:
        """Evaluate the functions at points (n,) of one row of elements, 0 at eta = 0.

        With `elements` (n,) along xi, each point is evaluated in that element, as in `SplineSpace.basis`.
        """
        first_row = self.across.first_functions[element_row]
        across, _ = self.across.basis(eta, 1, elements=np.full(len(eta), element_row))
        functions, values, derivatives = [], [], []
        for k in range(self.across.degree + 1):
            j = first_row + k
            along, first = self.rows[j].basis(xi, 1, elements)
            number = first[:, None] + np.arange(self.rows[j].degree + 1)
            scale = 1.0 if self.weights is None else self.weights[j][number]
            functions.append(self.offsets[j] + number)
            values.append(scale * along[0] * across[0][:, k, None])
            derivatives.append(
                np.stack(
                    [scale * along[1] * across[0][:, k, None], scale * along[0] * across[1][:, k, None]],
                    axis=1,
                )
            )
        value, derivative = np.concatenate(values, axis=1), np.concatenate(derivatives, axis=2)
        if self.weights is not None:
            total = value.sum(axis=1)[:, None]
            value = value / total
            change = derivative.sum(axis=2)[:, :, None]
            derivative = (derivative - value[:, None, :] * change) / total[:, None]
        return Basis(np.concatenate(functions, axis=1), value, derivative)


def row_space(
    name: str,
    elements: tuple[int, int],
    across_degree: int = 1,
    grading: tuple[float, float] = (1.0, 1.0),
    shape: NurbsSurface | None = None,
) -> RowSpace:
    """Build the space of a name (see `splines.names`) on a mesh (elements along xi, along eta).

    `across_degree` is the degree along eta: here 1, as in the published study; in case files 2 by default.
    `grading` is, along xi and eta, the ratio of the sizes of the last and the first element; the ratio of
    neighbours is constant, and 1 is a uniform mesh. If the space cannot rotate a `shape` on the same square
    rigidly, it gets the shape's lines of reduced continuity, along the direction that needs them. The nearest
    breakpoint is moved to such a line if it is near; otherwise a breakpoint is added.
    Raises InputError for a name or a mesh that is not possible.
    """
    parsed = parse_space_name(name)
    for count, finest, direction in zip(elements, FINEST_MESH, ("length", "height"), strict=True):
        if not 1 <= count <= finest or count != int(count):
            shown = f"{elements[0]}x{elements[1]}"
            raise InputError("mesh", shown, f"there can be 1 to {finest} elements along the {direction}")
    if len(grading) != 2 or not all(1 / STRONGEST_GRADING <= ratio <= STRONGEST_GRADING for ratio in grading):
        allowed = f"two ratios are needed, each from {1 / STRONGEST_GRADING:g} to {STRONGEST_GRADING:g}"
        raise InputError("grading", grading, allowed)
    along, upwards = (_graded(int(count), ratio) for count, ratio in zip(elements, grading, strict=True))
    across = SplineSpace.on(across_degree, across_degree - 1, upwards)
    if parsed.contact_rows > across.size:
        raise InputError("space", name, f"@ROWS must be at most {across.size}, the rows of this mesh")
    bulk = SplineSpace.on(parsed.bulk.degree, parsed.bulk.continuity, along)
    contact = SplineSpace.on(parsed.contact.degree, parsed.contact.continuity, along)

    def rows(across: SplineSpace, contact: SplineSpace, bulk: SplineSpace) -> RowSpace:
        upper = across.size - parsed.contact_rows
        return RowSpace(str(parsed), across, (contact,) * parsed.contact_rows + (bulk,) * upper)

    space = rows(across, contact, bulk)
    # a shape without such lines changes nothing
    if shape is None or max(own.elements for own in shape.spaces) == 1:
        return space
    misfits = space.misfit(shape)
    if misfits[0] > RIGID:
        contact, bulk = (with_lines_of(one, shape.spaces[0]) for one in (contact, bulk))
    if misfits[1] > RIGID:
        across = with_lines_of(across, shape.spaces[1])
    return rows(across, contact, bulk)


def with_lines_of(space: SplineSpace, other: SplineSpace) -> SplineSpace:
    """Return a space that is nowhere smoother than another one on the same interval.

    Each knot of the other space becomes a breakpoint. The nearest breakpoint is moved to it if the distance
    is at most a third of the elements beside it, so that no element becomes too small; otherwise a breakpoint
    is added.
    """
    places, repeats = space.breakpoints.copy(), space.multiplicities.copy()
    taken = np.zeros(places.size, dtype=bool)
    taken[[0, -1]] = True
    for knot, multiplicity in zip(other.breakpoints[1:-1], other.multiplicities[1:-1], strict=True):
        needed = max(1, space.degree - (other.degree - int(multiplicity)))
        at = int(np.argmin(np.abs(places - knot)))
        beside = np.diff(places)[max(at - 1, 0) : at + 1].min()
        if not taken[at] and abs(places[at] - knot) <= beside / 3:
            places[at], repeats[at], taken[at] = knot, max(repeats[at], needed), True
            continue
        at = int(np.searchsorted(places, knot))
        places, repeats, taken = (
            np.insert(array, at, value) for array, value in ((places, knot), (repeats, needed), (taken, True))
        )
    return SplineSpace(space.degree, np.repeat(places, repeats))


def _principal(columns: FloatArray) -> FloatArray:
    """Return at most n columns (n,) that span the same; the given ones combine them by factors <= 1."""
    if columns.shape[1] <= columns.shape[0]:
        return columns
    basis, sizes, _ = np.linalg.svd(columns, full_matrices=False)
    scaled: FloatArray = basis * sizes
    return scaled


def _error(space: SplineSpace, coefficients: FloatArray, other: SplineSpace, wanted: FloatArray) -> float:
    """Return the largest difference of splines (size, n) of two spaces, at Gauss points of the first one."""
    nodes, _ = np.polynomial.legendre.leggauss(space.degree + 1)
    starts, sizes = space.breakpoints[:-1, None], np.diff(space.breakpoints)[:, None]
    points = (starts + sizes * (nodes + 1) / 2).ravel()
    difference = space.collocation(points) @ coefficients - other.collocation(points) @ wanted
    return float(np.abs(difference).max())


def _graded(elements: int, grading: float) -> FloatArray:
    """Return the breakpoints (elements + 1,) on [0, 1] of elements whose sizes are a geometric series."""
    steps = np.arange(elements + 1)
    if elements == 1 or grading == 1:
        return steps / elements
    rate = np.log(grading) / (elements - 1)
    breakpoints: FloatArray = np.expm1(rate * steps) / np.expm1(rate * elements)
    return breakpoints


def _like(factors: FloatArray, values: FloatArray) -> FloatArray:
    """Return factors (n,) in a shape that multiplies values (n, ...)."""
    return factors.reshape(-1, *[1] * (values.ndim - 1))
