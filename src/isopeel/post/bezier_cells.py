"""Cells of a body: rational Bezier cells, in which shape and displacement are exact, or straight cells."""

from dataclasses import dataclass
from typing import Self

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.post.fields import as_rows, nodes, on_grid
from isopeel.splines.bezier import bernstein, product, surface_cells
from isopeel.splines.nurbs import NurbsSurface, Side
from isopeel.splines.rows import RowSpace

#: Relative difference below which weight functions are the same: refinement costs a few round-offs.
_ROUND_OFF = 1e-13

#: Distance below which places on [0, 1] are the same.
_SAME_PLACE = 1e-12

Ends = tuple[FloatArray, FloatArray]


@dataclass(frozen=True, eq=False)
class BezierMesh:
    """Bezier cells between `ends` along xi and eta: n_x x n_y cells of degrees p and q, with common weights.

    A shape A_X/w and a displacement A_u/v are exact in one rational cell. Where both denominators are equal,
    as for all rows that contain w, and for all shapes without weights, the degrees are the higher ones of
    both. Where they differ, for example for linear rows on an arc, the cell has the weight w v, the
    numerators A_X v and A_u w, and the sums of both degrees.

    Stresses are not rational functions of that kind. Their control values make the cell exact at its
    (p + 1) x (q + 1) Gauss points, `places`; elsewhere, for example at its edges, it interpolates.
    """

    ends: Ends
    points: FloatArray  # control points (n_x, n_y, p + 1, q + 1, 2)
    weights: FloatArray  # (n_x, n_y, p + 1, q + 1)
    _space: RowSpace
    _factor: FloatArray  # that the numerators of displacements take
    _part: tuple[slice, ...] = (slice(None),) * 4

    @classmethod
    def of(cls, shape: NurbsSurface, space: RowSpace, ends: Ends) -> Self:
        """Return the cells of a shape and the space of a displacement; each lies in one element of both."""
        own = space.weighted(shape)
        A, w = surface_cells(*as_rows(shape), ends)
        v = surface_cells(own, np.zeros((own.size, 2)), ends)[1]
        degrees = np.maximum(w.shape[2:], v.shape[2:])
        shape_factor, factor = (np.ones((*w.shape[:2], *degrees - weight.shape[2:] + 1)) for weight in (w, v))
        if np.abs(product(w, shape_factor) - product(v, factor)).max() > _ROUND_OFF * w.max():
            shape_factor, factor = v, w
        weights = product(w, shape_factor)
        return cls(ends, product(A, shape_factor) / weights[..., None], weights, own, factor)

    def edge(self, side: Side) -> "BezierMesh":
        """Return the curves on a side, as cells of degree 0 across it."""
        at = slice(0, 1) if side in ("left", "bottom") else slice(-1, None)
        along = slice(None)
        part = (at, along, at, along) if side in ("left", "right") else (along, at, along, at)
        return BezierMesh(self.ends, self.points[part], self.weights[part], self._space, self._factor, part)

    @property
    def degrees(self) -> tuple[int, int]:
        """Degrees p and q of the cells."""
        p, q = self.weights.shape[2:]
        return p - 1, q - 1

    @property
    def rational(self) -> bool:
        """Whether weights differ."""
        return bool(np.ptp(self.weights) > _ROUND_OFF * self.weights.max())

    @property
    def places(self) -> Ends:
        """Gauss points of the cells, (n_x, p + 1) along xi and (n_y, q + 1) along eta."""
        along, across = (
            ends[:-1, None] + np.diff(ends)[:, None] * _gauss_points(degree)
            for ends, degree in zip(self.ends, self.degrees, strict=True)
        )
        return along, across

    def displacement(self, coefficients: FloatArray) -> FloatArray:
        """Return the exact control values (n_x, n_y, p + 1, q + 1, 2) of a displacement (size, 2)."""
        numerators, _ = surface_cells(self._space, coefficients, self.ends)
        values: FloatArray = product(numerators, self._factor)[self._part] / self.weights[..., None]
        return values

    def interpolated(self, values: FloatArray) -> FloatArray:
        """Return the control values of the field with values (n_x, n_y, p + 1, q + 1, ...) at `places`.

        A cell with nan at one place is nan as a whole.
        """
        functions = [bernstein(degree, _gauss_points(degree)) for degree in self.degrees]
        along, across = (np.linalg.inv(matrix) for matrix in functions)
        w = np.einsum("kp,lq,xypq->xykl", *functions, self.weights, optimize=True)
        trailing = (...,) + (None,) * (values.ndim - 4)
        A = np.einsum("pk,ql,xykl...->xypq...", along, across, values * w[trailing], optimize=True)
        result: FloatArray = A / self.weights[trailing]
        return result


@dataclass(frozen=True, eq=False)
class StraightMesh:
    """The same cells, each cut into equal straight cells, at whose corners shape and fields are exact.

    A cell has k x l such points; cells do not share the points on their edges.
    """

    ends: Ends
    places: Ends  # (n_x, k) along xi and (n_y, l) along eta
    points: FloatArray  # (n_x, n_y, k, l, 2)
    _shape: NurbsSurface
    _space: RowSpace

    @classmethod
    def of(cls, shape: NurbsSurface, space: RowSpace, ends: Ends, pieces: int) -> Self:
        """Return the cells, cut into `pieces` in each direction."""
        along, across = (nodes(breakpoints, pieces) for breakpoints in ends)
        return cls._at(shape, space.weighted(shape), ends, (along, across))

    def edge(self, side: Side) -> Self:
        """Return the lines on a side, with one point across it."""
        xi, eta = self.places
        end = np.array([[0.0 if side in ("left", "bottom") else 1.0]])
        places = (end, eta) if side in ("left", "right") else (xi, end)
        return self._at(self._shape, self._space, self.ends, places)

    def displacement(self, coefficients: FloatArray) -> FloatArray:
        """Return a displacement (n_x, n_y, k, l, 2) with coefficients (size, 2) at the points."""
        return on_grid(self._space, coefficients, *self.places)[0]

    def interpolated(self, values: FloatArray) -> FloatArray:
        """Return values at the places, which are those of the points."""
        return values

    @classmethod
    def _at(cls, shape: NurbsSurface, space: RowSpace, ends: Ends, places: Ends) -> Self:
        return cls(ends, places, on_grid(*as_rows(shape), *places)[0], shape, space)


def cell_ends(breakpoints: FloatArray, others: FloatArray) -> FloatArray:
    """Return the breakpoints and those others between the first and the last of them, sorted."""
    inside = (others > breakpoints[0]) & (others < breakpoints[-1])
    new = np.abs(others[:, None] - breakpoints).min(axis=1) > _SAME_PLACE
    return np.sort(np.concatenate([breakpoints, others[inside & new]]))


def _gauss_points(degree: int) -> FloatArray:
    """Return degree + 1 Gauss points in (0, 1)."""
    points: FloatArray = (np.polynomial.legendre.leggauss(degree + 1)[0] + 1) / 2
    return points
