"""Splines as Bezier cells: Bernstein polynomials on intervals, their products, surfaces of a row-wise space.

A coefficient of degree p on an interval (a, b) belongs to B_k(t) = C(p, k) t^k (1 - t)^(p - k), t from 0 at a
to 1 at b.
"""

from math import comb

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.splines.rows import RowSpace
from isopeel.splines.space import SplineSpace


def bernstein(degree: int, places: FloatArray) -> FloatArray:
    """Return the Bernstein polynomials (n, degree + 1) at places (n,) in [0, 1]."""
    k = np.arange(degree + 1)
    binomials = np.array([comb(degree, number) for number in k], dtype=np.float64)
    t = places[:, None]
    values: FloatArray = binomials * t**k * (1 - t) ** (degree - k)
    return values


def curve_cells(space: SplineSpace, coefficients: FloatArray, ends: FloatArray) -> FloatArray:
    """Coefficients (cells, degree + 1, ...) between rising `ends` of a spline with coefficients (size, ...).

    Each cell lies in one element. The coefficient k is the polar form with k arguments at the end of the
    cell and the rest at its start (Ramshaw, Blossoms are polar forms, 1989).
    """
    start, end = ends[:-1], ends[1:]
    elements = space.element_of((start + end) / 2)
    orders = np.arange(space.degree)
    at_end = orders < np.arange(space.degree + 1)[:, None, None]
    weights = space.polar_weights(np.where(at_end, end[:, None], start[:, None]), elements)
    active = space.first_functions[elements][:, None] + np.arange(space.degree + 1)
    cells: FloatArray = np.einsum("kei,ei...->ek...", weights, coefficients[active])
    return cells


def surface_cells(
    space: RowSpace, coefficients: FloatArray, ends: tuple[FloatArray, FloatArray]
) -> tuple[FloatArray, FloatArray]:
    """Return numerators (n_x, n_y, p + 1, q + 1, c) and denominators (n_x, n_y, p + 1, q + 1) of a field.

    The field has coefficients (size, c); cells are those between the `ends` along xi and eta, each in one
    element; p is the highest degree along xi, q that along eta. Denominators are 1 without weights.
    """
    weights = space.weights or tuple(np.ones(row.size) for row in space.rows)
    curves = []
    for row, part, w in zip(space.rows, np.split(coefficients, space.offsets[1:-1]), weights, strict=True):
        cells = curve_cells(row, np.column_stack([w[:, None] * part, w]), ends[0])
        raised = np.ones((len(cells), space.degree - row.degree + 1))
        curves.append(np.einsum("kij,eic,ej->ekc", _products(row.degree, space.degree), cells, raised))
    homogeneous = curve_cells(space.across, np.stack(curves), ends[1]).transpose(2, 0, 3, 1, 4)
    return homogeneous[..., :-1], homogeneous[..., -1]


def product(one: FloatArray, other: FloatArray) -> FloatArray:
    """Coefficients of the products of fields on the same cells: (n_x, n_y, p + 1, q + 1, ...) of `one`.

    The other, (n_x, n_y, r + 1, s + 1), is a number at each place; the result has degrees p + r and q + s.
    Farouki and Rajan, Comput. Aided Geom. Des. 5, 1988, Eq. 44. A factor of ones only raises the degrees.
    """
    (p, q), (r, s) = ([size - 1 for size in array.shape[2:4]] for array in (one, other))
    along, across = _products(p, p + r), _products(q, q + s)
    result: FloatArray = np.einsum("kij,lmn,xyim...,xyjn->xykl...", along, across, one, other, optimize=True)
    return result


def _products(degree: int, total: int) -> FloatArray:
    """Coefficient k (total + 1, ...) of the products of B_i of a degree, and B_j of the rest to the total."""
    rest = total - degree
    table = np.zeros((total + 1, degree + 1, rest + 1))
    for i, j in np.ndindex(degree + 1, rest + 1):
        table[i + j, i, j] = comb(degree, i) * comb(rest, j) / comb(total, i + j)
    return table
