"""Element tables: shape functions and quadrature weights at all points, made once."""

from collections import defaultdict
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from isopeel.arrays import FloatArray, IntArray
from isopeel.assembly.constraints import HELD, Constraints
from isopeel.assembly.kernels import LANES
from isopeel.errors import InputError
from isopeel.splines.nurbs import NurbsSurface, Side
from isopeel.splines.rows import Basis, RowSpace

Number = TypeVar("Number", np.float64, np.int64)

#: More Gauss points on an element than this resolve nothing: the adhesive force is smooth.
MOST_CONTACT_POINTS = 100


@dataclass(frozen=True, eq=False)
class ElementTable:
    """Elements with the same number m of functions: E elements of Q quadrature points each."""

    functions: IntArray  # (E, m) numbers of the functions
    gradients: FloatArray  # (E, Q, 2, m) derivatives with respect to the reference position
    weights: FloatArray  # (E, Q) reference area of each point
    positions: FloatArray  # (E, Q, 2) reference position of each point


@dataclass(frozen=True, eq=False)
class BatchTable:
    """The same elements in B batches of LANES, the last index being the lane; the last batch is filled up.

    The fill repeats the last element with weights of zero; `unknowns` of the fill are HELD.
    """

    functions: IntArray  # (B, m, LANES)
    gradients: FloatArray  # (B, Q, 2, m, LANES)
    weights: FloatArray  # (B, Q, LANES)
    unknowns: IntArray  # (B, 2, m, LANES)

    @classmethod
    def of(cls, table: ElementTable, constraints: Constraints) -> "BatchTable":
        """Rearrange the elements of a table."""
        unknowns = constraints.unknowns[table.functions].transpose(0, 2, 1)
        return cls(
            _batches(table.functions),
            _batches(table.gradients),
            _batches(table.weights, fill=0.0),
            _batches(unknowns, fill=HELD),
        )


@dataclass(frozen=True, eq=False)
class SideTable:
    """The part of a side's elements that adheres: E elements of Q quadrature points each."""

    functions: IntArray  # (E, m) numbers of all functions of the elements at the side
    values: FloatArray  # (E, Q, m)
    gradients: FloatArray  # (E, Q, 2, m)
    weights: FloatArray  # (E, Q) reference length of each point
    positions: FloatArray  # (E, Q, 2) reference position of each point
    normals: FloatArray  # (E, Q, 2) outward unit normal of the reference side


def element_tables(shape: NurbsSurface, space: RowSpace) -> tuple[ElementTable, ...]:
    """Tables of all elements, with one more Gauss point than the highest degree in each direction."""
    xi, xi_weights = _gauss_points(space.rows[0].breakpoints, space.degree + 1)
    eta, eta_weights = _gauss_points(space.across.breakpoints, space.across.degree + 1)
    groups: dict[int, list[ElementTable]] = defaultdict(list)
    for row in range(space.elements[1]):
        # points of one element: eta runs fastest
        elements, quadrature = xi.shape[0], xi.shape[1] * eta.shape[1]
        x = np.repeat(xi.ravel(), eta.shape[1])
        y = np.tile(eta[row], xi.size)
        basis = space.basis(x, y, row)
        gradients, determinant = _reference_gradients(shape, basis, x, y)
        m = basis.functions.shape[1]
        weights = (xi_weights[:, :, None] * eta_weights[row]).reshape(elements, quadrature)
        groups[m].append(
            ElementTable(
                functions=basis.functions.reshape(elements, quadrature, m)[:, 0],
                gradients=gradients.reshape(elements, quadrature, 2, m),
                weights=weights * determinant.reshape(elements, quadrature),
                positions=shape.evaluate(x, y).reshape(elements, quadrature, 2),
            )
        )
    names = ("functions", "gradients", "weights", "positions")
    return tuple(
        ElementTable(*(np.concatenate([getattr(table, name) for table in group]) for name in names))
        for group in groups.values()
    )


def side_table(
    shape: NurbsSurface, space: RowSpace, side: Side, part: tuple[float, float], points: int | None = None
) -> SideTable:
    """Table of a part of a side, from one of its parameters to another.

    Elements that the part covers in part are integrated over that part, with full accuracy. There are
    `points` Gauss points on each, by default one more than the highest degree along the side.
    """
    start, end = part
    if points is not None and not 1 <= points <= MOST_CONTACT_POINTS:
        raise InputError("contact_points", points, f"there can be 1 to {MOST_CONTACT_POINTS} on an element")
    along = space.across if side in ("left", "right") else space.rows[0]
    breakpoints = along.breakpoints
    inside = breakpoints[(breakpoints > start) & (breakpoints < end)]
    degree = space.across.degree if side in ("left", "right") else space.degree
    parameter, weights = _gauss_points(np.concatenate([[start], inside, [end]]), points or degree + 1)
    elements, quadrature = parameter.shape
    constant = np.full(parameter.size, 0.0 if side in ("left", "bottom") else 1.0)
    if side in ("bottom", "top"):
        xi, eta = parameter.ravel(), constant
        basis = space.basis(xi, eta, 0 if side == "bottom" else space.elements[1] - 1)
        tangent = shape.jacobian(xi, eta)[:, :, 0] * (1 if side == "bottom" else -1)
    else:
        xi, eta = constant, parameter.ravel()
        rows = space.across.element_of(parameter[:, 0])
        basis = _stack(
            [space.basis(xi[:quadrature], e, r) for e, r in zip(parameter, rows, strict=True)], side
        )
        tangent = shape.jacobian(xi, eta)[:, :, 1] * (1 if side == "right" else -1)
    gradients, _ = _reference_gradients(shape, basis, xi, eta)
    length = np.linalg.norm(tangent, axis=1)
    # the boundary runs anticlockwise, so that the outward normal lies to its right
    normals = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1) / length[:, None]
    m = basis.functions.shape[1]
    return SideTable(
        functions=basis.functions.reshape(elements, quadrature, m)[:, 0].copy(),
        values=basis.values.reshape(elements, quadrature, m),
        gradients=gradients.reshape(elements, quadrature, 2, m),
        weights=weights * length.reshape(elements, quadrature),
        positions=shape.evaluate(xi, eta).reshape(elements, quadrature, 2),
        normals=normals.reshape(elements, quadrature, 2),
    )


def _batches(array: NDArray[Number], fill: float | None = None) -> NDArray[Number]:
    """Split the first axis (E,) into batches, (B, ..., LANES); fill up by a value or by the last entry."""
    elements = len(array)
    batches = -(-elements // LANES)
    filled = np.concatenate([array, np.repeat(array[-1:], batches * LANES - elements, axis=0)])
    if fill is not None:
        filled[elements:] = fill
    split = filled.reshape(batches, LANES, *array.shape[1:])
    return np.ascontiguousarray(np.moveaxis(split, 1, -1))


def _stack(parts: list[Basis], side: Side) -> Basis:
    if len({part.functions.shape[1] for part in parts}) > 1:
        raise InputError("adhesion.side", side, "on this side all rows must have one space")
    return Basis(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))


def _gauss_points(breakpoints: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    """Gauss-Legendre points and weights (elements, count) on the intervals between breakpoints."""
    points, weights = np.polynomial.legendre.leggauss(count)
    half = np.diff(breakpoints)[:, None] / 2
    return breakpoints[:-1, None] + half * (points + 1), half * weights


def _reference_gradients(
    shape: NurbsSurface, basis: Basis, xi: FloatArray, eta: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Gradients (n, 2, m) with respect to the reference position, and det dX/d(xi, eta) (n,)."""
    jacobian = shape.jacobian(xi, eta)
    determinant = np.linalg.det(jacobian)
    if np.any(determinant <= 0):
        at = int(np.argmin(determinant))
        place = (round(float(xi[at]), 6), round(float(eta[at]), 6))
        raise InputError("body.shape", place, "the patch must not fold at any point (xi, eta)")
    gradients = np.einsum("nJi,nim->nJm", np.linalg.inv(jacobian).transpose(0, 2, 1), basis.derivatives)
    return gradients, determinant
