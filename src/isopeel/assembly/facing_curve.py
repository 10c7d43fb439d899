"""The side of a deformable body as a curve of Bezier segments, on which closest points are found."""

from dataclasses import dataclass
from math import comb

import numpy as np

from isopeel.assembly.spaces import Spaces
from isopeel.assembly.tables import element_ends, table_at
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.problem import Boundary

#: Breakpoints of displacement and shape that are nearer than this, in the parameter, are the same one.
_SAME_POINT = 1e-12


@dataclass(frozen=True, eq=False)
class FacingCurve:
    """S segments of a side: the position at s in [0, 1] is X(s) + sum_b M_b(s) u_b, with one denominator.

    Numerators and denominator are polynomials in the Bernstein basis. They run along the parameter of the
    side; the outward normal is to the right of the tangent times the orientation.
    """

    ends: FloatArray  # (S + 1,) parameters of the side between which the segments are
    functions: IntArray  # (S, m) numbers of the functions that do not vanish on a segment
    values: FloatArray  # (S, m, p + 1) numerators of the functions, of degree p
    weights: FloatArray  # (S, p + 1) the denominator; ones where the side is polynomial
    shape: FloatArray  # (S, 2, p + 1) numerators of x and y of the side as it is made
    orientation: float  # 1 or -1


def facing_curve(spaces: Spaces, boundary: Boundary) -> FacingCurve:
    """Return the whole side that a boundary is a part of, as a curve."""
    shape, side = spaces.problem.body_of(boundary.body).shape, boundary.side
    space, edge = spaces.of[boundary.body], shape.boundary(side)
    ends = np.unique(np.concatenate([element_ends(space, side, (0.0, 1.0)), edge.space.breakpoints]))
    ends = np.append(ends[:-1][np.diff(ends) > _SAME_POINT], 1.0)
    made = _coefficients(np.moveaxis(edge.homogeneous(_nodes(ends, edge.space.degree)), 2, 1))
    if np.ptp(edge.weights) == 0.0:
        made = made / edge.weights[0]
        made[:, 2] = 1.0
    degree = space.across.degree if side in ("left", "right") else space.degree
    places = _nodes(ends, degree)
    table = table_at(shape, space, side, places, np.zeros(places.shape)).of_values()
    values = np.moveaxis(table.values, 2, 1)
    if space.weights is None:
        numerators = _coefficients(values)
        if np.ptp(edge.weights) > 0.0:
            numerators = _product(numerators, made[:, 2:])
    else:
        # a rational space has the weights of the shape
        numerators = _coefficients(values * edge.homogeneous(places)[:, None, :, 2])
    more = numerators.shape[2] - made.shape[2]
    numerators, made = _elevated(numerators, -more), _elevated(made, more)
    return FacingCurve(
        ends=ends,
        functions=spaces.places[boundary.body].start + table.functions,
        values=numerators,
        weights=np.ascontiguousarray(made[:, 2]),
        shape=np.ascontiguousarray(made[:, :2]),
        # the boundary of the body runs anticlockwise
        orientation=1.0 if side in ("bottom", "right") else -1.0,
    )


def _elevated(polynomials: FloatArray, times: int) -> FloatArray:
    """Return polynomials (..., p + 1) with a degree that is higher, or the same for times <= 0."""
    return _product(polynomials, np.ones(max(times, 0) + 1))


def _product(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the products (..., p + q + 1) of polynomials (..., p + 1) and (..., q + 1)."""
    p, q = one.shape[-1] - 1, other.shape[-1] - 1
    shape = np.broadcast_shapes(one.shape[:-1], other.shape[:-1])
    product = np.zeros((*shape, p + q + 1))
    for i in range(p + 1):
        for j in range(q + 1):
            product[..., i + j] += comb(p, i) * comb(q, j) / comb(p + q, i + j) * one[..., i] * other[..., j]
    return product


def _coefficients(values: FloatArray) -> FloatArray:
    """Return Bernstein coefficients (..., p + 1) by values at the interpolation points."""
    return np.ascontiguousarray(values @ np.linalg.inv(_bernstein(values.shape[-1] - 1)).T)


def _nodes(ends: FloatArray, degree: int) -> FloatArray:
    """Return degree + 1 interpolation points (S, degree + 1) inside each segment."""
    return ends[:-1, None] + np.diff(ends)[:, None] * _chebyshev(degree)


def _chebyshev(degree: int) -> FloatArray:
    nodes: FloatArray = (1 - np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))) / 2
    return nodes


def _bernstein(degree: int) -> FloatArray:
    """Return the Bernstein polynomials (nodes, degree + 1) at the interpolation points of [0, 1]."""
    s = _chebyshev(degree)
    return np.stack([comb(degree, k) * s**k * (1 - s) ** (degree - k) for k in range(degree + 1)], axis=1)
