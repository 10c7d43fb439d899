"""Splines as Bezier cells: Bernstein polynomials on intervals, their products, surfaces of a row-wise space.

On an interval (a, b), coefficient k of degree p multiplies B_k(t) = C(p, k) t^k (1 - t)^(p - k), where t = 0
at a and t = 1 at b.
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
    """Return Bezier coefficients (cells, degree + 1, ...) of a spline with coefficients (size, ...).

    The cells are those between the rising `ends`, each in one element. Coefficient k is the polar form with k
    arguments at the end of the cell and the others at its start (Ramshaw, Blossoms are polar forms, 1989).
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

    The field has coefficients (size, c). The cells are those between the `ends` along xi and eta, each in one
    element. The highest degree along xi is p, that along eta is q. Without weights, denominators are 1.
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
    """Return the coefficients of the product of two fields on the same cells, of degrees p + r and q + s.

    `one` has coefficients (n_x, n_y, p + 1, q + 1, ...); the other field is scalar, (n_x, n_y, r + 1, s + 1).
    Farouki and Rajan, Comput. Aided Geom. Des. 5, 1988, Eq. 44. A factor of ones only raises the degrees.
    """
    (p, q), (r, s) = ([size - 1 for size in array.shape[2:4]] for array in (one, other))
    along, across = _products(p, p + r), _products(q, q + s)
    result: FloatArray = np.einsum("kij,lmn,xyim...,xyjn->xykl...", along, across, one, other, optimize=True)
    return result


def _products(degree: int, total: int) -> FloatArray:
    """Return coefficient k (total + 1, ...) of the products B_i B_j, whose degrees add up to the total."""
    rest = total - degree
    table = np.zeros((total + 1, degree + 1, rest + 1))
    for i, j in np.ndindex(degree + 1, rest + 1):
        table[i + j, i, j] = comb(degree, i) * comb(rest, j) / comb(total, i + j)
    return table
