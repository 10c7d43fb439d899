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
    """S segments of a side: the position at s in [0, 1] is X(s) + sum_b M_b(s) u_b, both rational.

    Numerators and denominators are polynomials in the Bernstein basis. They run along the parameter of the
    side; the outward normal is to the right of the tangent times the orientation.
    """

    functions: IntArray  # (S, m) numbers of the functions that do not vanish on a segment
    values: FloatArray  # (S, m, p + 1) numerators of the functions, of degree p
    weights: FloatArray  # (S, p + 1) their denominator
    shape: FloatArray  # (S, 3, q + 1) numerators of x and y of the side as it is made, and their denominator
    orientation: float  # 1 or -1


def facing_curve(spaces: Spaces, boundary: Boundary) -> FacingCurve:
    """Return the whole side that a boundary is a part of, as a curve."""
    shape, side = spaces.problem.body_of(boundary.body).shape, boundary.side
    space, edge = spaces.of[boundary.body], shape.boundary(side)
    ends = np.unique(np.concatenate([element_ends(space, side, (0.0, 1.0)), edge.space.breakpoints]))
    ends = np.append(ends[:-1][np.diff(ends) > _SAME_POINT], 1.0)
    degree = space.across.degree if side in ("left", "right") else space.degree
    places = _nodes(ends, degree)
    table = table_at(shape, space, side, places, np.zeros(places.shape)).of_values()
    # the space has the weights of the shape
    weights = np.ones(places.shape) if space.weights is None else _weights(edge.homogeneous(places))
    numerators = np.einsum("sqm,sq->smq", table.values, weights)
    coefficients = np.linalg.inv(_bernstein(degree)).T
    of_shape = np.moveaxis(edge.homogeneous(_nodes(ends, edge.space.degree)), 2, 1)
    return FacingCurve(
        functions=spaces.places[boundary.body].start + table.functions,
        values=np.ascontiguousarray(numerators @ coefficients),
        weights=np.ascontiguousarray(weights @ coefficients),
        shape=np.ascontiguousarray(of_shape @ np.linalg.inv(_bernstein(edge.space.degree)).T),
        # the boundary of the body runs anticlockwise
        orientation=1.0 if side in ("bottom", "right") else -1.0,
    )


def _weights(homogeneous: FloatArray) -> FloatArray:
    weights: FloatArray = homogeneous[..., 2]
    return weights


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
