"""Compiled loops over the body (total Lagrangian): forces, stored energy and tangent, by sum factorization.

The functions are products: of one along xi, of the row j, and of one across, M_j(eta). So fields are made
along each row first, and across then; forces and tangents the other way round. Every array ends with the
lane, an element along xi, and the innermost loops run over it, so that they fill the processor's vector
registers whatever the degree.

The gradient at a point is made of channels: d/dxi, d/deta and, of a rational space, the value itself. Each
is a derivative of some order along xi times one of some order across (`BodyTable`). Index names: a, b
functions along xi; c the rows of an element; i, k components; J, L reference directions; p quadrature points
along xi, r across.
"""

from typing import Any, NamedTuple

import numpy as np
from numba import boolean, float64, int64, njit

from isopeel.arrays import FloatArray, IntArray
from isopeel.assembly.loops import PAIR, read_only
from isopeel.compilation import compiled_reordered
from isopeel.physics.batch import material_at, of_address

#: Elements that are treated together, at most: enough that the test for overlapping arrays, made before each
#: innermost loop, costs little, and few enough that what is kept of them fits the processor's cache.
_LANES = 256

# Numba takes seconds to compile an assignment to a part of an array, but not its fill.
_inlined = njit(inline="always")


class BodyArguments(NamedTuple):
    """The loops over a body, by the address of their compiled code, and what they are told at each call."""

    loops: int
    material: int  # address
    parameters: FloatArray
    kinds: IntArray  # this and the following as in `BodyTable`
    sizes: IntArray
    along: FloatArray
    first: IntArray
    across: FloatArray
    first_rows: IntArray
    map_kinds: IntArray
    maps: FloatArray
    weight_kinds: IntArray
    weights: FloatArray
    unknowns: IntArray  # (rows, 2, largest size, X)


def add_body(
    material_address: int,
    parameters: FloatArray,
    kinds: IntArray,
    sizes: IntArray,
    along: FloatArray,
    first: IntArray,
    across: FloatArray,
    first_rows: IntArray,
    map_kinds: IntArray,
    maps: FloatArray,
    weight_kinds: IntArray,
    weights: FloatArray,
    unknowns: IntArray,
    u: FloatArray,
    forces: FloatArray,
    band: FloatArray,
    diagonal: int,
    with_tangent: bool,
) -> tuple[float, float]:
    """Add internal forces int P_iJ dN_a/dX_J dV and their tangent; return the stored energy and least det F.

    Tables as in `BodyTable`; unknowns (rows, 2, largest size, X); u, forces (size, 2); band (unknowns + 1,
    width), whose last row takes what no unknown wants, untouched without `with_tangent`.
    """
    material = material_at(material_address)
    rows, X = first.shape
    Y, _, R, C = across.shape
    P, largest = along.shape[2], along.shape[3]
    channels = maps.shape[2]
    # blocks of about the same size
    block = -(-X // -(-X // _LANES))
    points = P * block
    local = np.empty((2, largest, block))
    # of the rows of one row of elements
    lines = np.empty((C, 2, 2, P, block))
    loads = np.empty((C, 2, 2, P, block))
    channel = np.empty((channels, block))
    F = np.empty((2, 2, block))
    density = np.empty(block)
    stress = np.empty((2, 2, block))
    A = np.empty((P, 2, 2, 2, 2, block))
    half = np.empty((2, 2, block))
    moduli = np.empty((2 * channels, 2 * channels, points))
    pairs = np.zeros((C, C, 2, 2, 2, 2, P, block) if with_tangent else (1, 1, 2, 2, 2, 2, 1, 1))
    flux = np.empty((2, P, block))
    value = np.empty(block)
    place = np.empty(block, np.int64)
    flat = band.ravel()
    energy = 0.0
    least = np.empty(block)
    least.fill(np.inf)
    for start in range(0, X, block):
        n = min(block, X - start)
        lanes = slice(start, start + n)
        ready = 0
        for y in range(Y):
            row = first_rows[y]
            one, two = row % C, (row + 1) % C
            for j in range(ready, row + C):
                kind = kinds[j]
                loads[j % C].fill(0.0)
                for a in range(sizes[kind]):
                    for i in range(2):
                        for lane in range(n):
                            local[i, a, lane] = u[first[j, start + lane] + a, i]
                for order in range(2):
                    for i in range(2):
                        for p in range(P):
                            line = lines[j % C, order, i, p, :n]
                            _set_products(
                                line,
                                0.0,
                                local[i, 0],
                                along[kind, order, p, 0, lanes],
                                local[i, 1],
                                along[kind, order, p, 1, lanes],
                                n,
                            )
                            for a in range(2, sizes[kind] - 1, 2):
                                _add_products(
                                    line,
                                    local[i, a],
                                    along[kind, order, p, a, lanes],
                                    local[i, a + 1],
                                    along[kind, order, p, a + 1, lanes],
                                    n,
                                )
                            if sizes[kind] > 2 and sizes[kind] % 2 == 1:
                                last = sizes[kind] - 1
                                _add_product(line, local[i, last], along[kind, order, p, last, lanes], n)
            ready = row + C
            for r in range(R):
                to_X, areas = maps[map_kinds[y, r]], weights[weight_kinds[y, r]]
                for p in range(P):
                    for i in range(2):
                        for h in range(channels):
                            factors = across[y, 1 if h == 1 else 0, r]
                            order = 1 if h == 0 else 0
                            _set_scaled(
                                channel[h],
                                factors[0],
                                lines[one, order, i, p],
                                factors[1],
                                lines[two, order, i, p],
                                n,
                            )
                            for c in range(2, C):
                                _add_scaled(channel[h], factors[c], lines[(row + c) % C, order, i, p], n)
                        for J in range(2):
                            gradient = F[i, J]
                            _set_products(
                                gradient,
                                1.0 if i == J else 0.0,
                                to_X[p, 0, J, lanes],
                                channel[0],
                                to_X[p, 1, J, lanes],
                                channel[1],
                                n,
                            )
                            if channels == 3:
                                _add_product(gradient, to_X[p, 2, J, lanes], channel[2], n)
                    # one for each place in the arrays: a single one would not run in vector registers
                    for lane in range(n):
                        determinant = F[0, 0, lane] * F[1, 1, lane] - F[0, 1, lane] * F[1, 0, lane]
                        least[lane] = determinant if determinant < least[lane] else least[lane]
                    material(F, parameters, n, density, stress, A[p], with_tangent)
                    area = areas[p, lanes]
                    energy += _sum_of_products(area, density, n)
                    for i in range(2):
                        for h in range(channels):
                            flow = channel[h]
                            _set_weighted_products(
                                flow,
                                area,
                                to_X[p, h, 0, lanes],
                                stress[i, 0],
                                to_X[p, h, 1, lanes],
                                stress[i, 1],
                                n,
                            )
                            factors = across[y, 1 if h == 1 else 0, r]
                            order = 1 if h == 0 else 0
                            _add_scaled_to_both(
                                loads[one, order, i, p],
                                factors[0],
                                loads[two, order, i, p],
                                factors[1],
                                flow,
                                n,
                            )
                            for c in range(2, C):
                                _add_scaled(loads[(row + c) % C, order, i, p], factors[c], flow, n)
                if with_tangent:
                    _pull_back(A, to_X, areas, start, n, half, moduli)
                    _add_to_pairs(pairs, moduli, across[y], r, row, channels, n)
            # rows that no other row of elements adds to
            for j in range(row, first_rows[y + 1] if y + 1 < Y else rows):
                kind = kinds[j]
                for a in range(sizes[kind]):
                    for i in range(2):
                        value.fill(0.0)
                        for p in range(P):
                            _add_products(
                                value,
                                along[kind, 0, p, a, lanes],
                                loads[j % C, 0, i, p],
                                along[kind, 1, p, a, lanes],
                                loads[j % C, 1, i, p],
                                n,
                            )
                        for lane in range(n):
                            forces[first[j, start + lane] + a, i] += value[lane]
                if with_tangent:
                    for d in range(min(C, rows - j)):
                        _spread(
                            pairs[j % C, d],
                            along[kinds[j], :, :, : sizes[kinds[j]]],
                            along[kinds[j + d], :, :, : sizes[kinds[j + d]]],
                            unknowns[j],
                            unknowns[j + d],
                            start,
                            n,
                            d == 0,
                            flux,
                            value,
                            place,
                            flat,
                            diagonal,
                            band.shape[1] - 1,
                        )
                    pairs[j % C].fill(0.0)
    lowest = np.inf
    for lane in range(block):
        lowest = min(lowest, least[lane])
    return energy, lowest


#: Of `add_body`.
BODY_SIGNATURE = PAIR(
    int64,
    float64[::1],
    read_only(int64, 1),
    read_only(int64, 1),
    read_only(float64, 5),
    read_only(int64, 2),
    read_only(float64, 4),
    read_only(int64, 1),
    read_only(int64, 2),
    read_only(float64, 5),
    read_only(int64, 2),
    read_only(float64, 3),
    read_only(int64, 4),
    read_only(float64, 2),
    float64[:, ::1],
    float64[:, ::1],
    int64,
    boolean,
)

#: Those loops, of their address, within compiled code.
body_at = of_address(BODY_SIGNATURE)


@_inlined
def _set_scaled(total: Any, factor0: float, x0: Any, factor1: float, x1: Any, n: int) -> None:
    for lane in range(n):
        total[lane] = factor0 * x0[lane] + factor1 * x1[lane]


@_inlined
def _set_products(total: Any, start: float, x0: Any, y0: Any, x1: Any, y1: Any, n: int) -> None:
    for lane in range(n):
        total[lane] = start + x0[lane] * y0[lane] + x1[lane] * y1[lane]


@_inlined
def _set_weighted_products(total: Any, weight: Any, x0: Any, y0: Any, x1: Any, y1: Any, n: int) -> None:
    for lane in range(n):
        total[lane] = weight[lane] * (x0[lane] * y0[lane] + x1[lane] * y1[lane])


@_inlined
def _add_scaled_to_both(one: Any, factor0: float, other: Any, factor1: float, x: Any, n: int) -> None:
    for lane in range(n):
        one[lane] += factor0 * x[lane]
        other[lane] += factor1 * x[lane]


@_inlined
def _sum_of_products(x: Any, y: Any, n: int) -> float:
    total = 0.0
    for lane in range(n):
        total += x[lane] * y[lane]
    return total


@_inlined
def _add_product(total: Any, x: Any, y: Any, n: int) -> None:
    for lane in range(n):
        total[lane] += x[lane] * y[lane]


@_inlined
def _add_products(total: Any, x0: Any, y0: Any, x1: Any, y1: Any, n: int) -> None:
    for lane in range(n):
        total[lane] += x0[lane] * y0[lane] + x1[lane] * y1[lane]


@_inlined
def _add_four_products(
    total: Any, x0: Any, y0: Any, x1: Any, y1: Any, x2: Any, y2: Any, x3: Any, y3: Any, n: int
) -> None:
    for lane in range(n):
        total[lane] += x0[lane] * y0[lane] + x1[lane] * y1[lane] + x2[lane] * y2[lane] + x3[lane] * y3[lane]


@_inlined
def _add_scaled(total: Any, factor: float, x: Any, n: int) -> None:
    for lane in range(n):
        total[lane] += factor * x[lane]


@compiled_reordered
def _pull_back(A: Any, maps: Any, weights: Any, start: int, n: int, half: Any, moduli: Any) -> None:
    """Moduli between channels: w sum_JL maps_hJ A_iJkL maps_gL at [2 h + i, 2 g + k], where that is >= 0."""
    P, channels = maps.shape[0], maps.shape[1]
    lanes = slice(start, start + n)
    for p in range(P):
        here = slice(p * n, (p + 1) * n)
        for g in range(channels):
            for k in range(2):
                for i in range(2):
                    for J in range(2):
                        _set_weighted_products(
                            half[i, J],
                            weights[p, lanes],
                            A[p, i, J, k, 0],
                            maps[p, g, 0, lanes],
                            A[p, i, J, k, 1],
                            maps[p, g, 1, lanes],
                            n,
                        )
                for h in range(channels):
                    for i in range(2):
                        # the other half follows from the symmetry
                        if 2 * h + i >= 2 * g + k:
                            _set_products(
                                moduli[2 * h + i, 2 * g + k, here],
                                0.0,
                                half[i, 0],
                                maps[p, h, 0, lanes],
                                half[i, 1],
                                maps[p, h, 1, lanes],
                                n,
                            )


@compiled_reordered
def _add_to_pairs(pairs: Any, moduli: Any, across: Any, r: int, row: int, channels: int, n: int) -> None:
    """Add a row of points to the pairs of the rows row + c and row + c + d, pairs[., d, orders, i, k]."""
    C = across.shape[2]
    P = pairs.shape[6]
    for c in range(C):
        for d in range(C - c):
            for h in range(channels):
                for g in range(channels):
                    factor = across[1 if h == 1 else 0, r, c] * across[1 if g == 1 else 0, r, c + d]
                    for i in range(2):
                        for k in range(2):
                            if d == 0 and i > k:
                                continue
                            one, other = max(2 * h + i, 2 * g + k), min(2 * h + i, 2 * g + k)
                            pair = pairs[(row + c) % C, d, 1 if h == 0 else 0, 1 if g == 0 else 0, i, k]
                            for p in range(P):
                                _add_scaled(pair[p], factor, moduli[one, other, p * n : (p + 1) * n], n)


@compiled_reordered
def _spread(
    pair: Any,
    one: Any,
    other: Any,
    rows: Any,
    columns: Any,
    start: int,
    n: int,
    same_row: bool,
    flux: Any,
    value: Any,
    place: Any,
    flat: Any,
    diagonal: int,
    stride: int,
) -> None:
    """Add the tangent between two rows: sum_p D^o N_a pair[o, q, i, k, p] D^q N_b, of orders o and q.

    `one` and `other` (2, P, size, X) are the functions of the rows, `rows` and `columns` (2, size, X) their
    unknowns; of one row with itself, half of the entries follow from the symmetry.
    """
    P = one.shape[1]
    lanes = slice(start, start + n)
    for i in range(2):
        for k in range(2):
            if same_row and i > k:
                continue
            for b in range(other.shape[2]):
                for p in range(P):
                    for order in range(2):
                        _set_products(
                            flux[order, p],
                            0.0,
                            pair[order, 0, i, k, p],
                            other[0, p, b, lanes],
                            pair[order, 1, i, k, p],
                            other[1, p, b, lanes],
                            n,
                        )
                for a in range(b if same_row and i == k else 0, one.shape[2]):
                    _sum_over_points(value, one[:, :, a, lanes], flux, n)
                    _scatter(
                        flat,
                        diagonal,
                        stride,
                        rows[i, a, lanes],
                        columns[k, b, lanes],
                        value,
                        place,
                        n,
                        same_row and i == k and a == b,
                    )


@compiled_reordered
def _sum_over_points(value: Any, functions: Any, x: Any, n: int) -> None:
    """Set value (n,) to sum_p N(p) x_0(p) + dN/dxi(p) x_1(p), of functions and x (2, P, n)."""
    N, dN, x0, x1 = functions[0], functions[1], x[0], x[1]
    P = N.shape[0]
    value.fill(0.0)
    # by two points, which halves the traffic of the sum
    for p in range(0, P - 1, 2):
        _add_four_products(value, N[p], x0[p], dN[p], x1[p], N[p + 1], x0[p + 1], dN[p + 1], x1[p + 1], n)
    if P % 2 == 1:
        _add_products(value, N[P - 1], x0[P - 1], dN[P - 1], x1[P - 1], n)


@_inlined
def _scatter(
    flat: Any,
    diagonal: int,
    stride: int,
    row: Any,
    column: Any,
    value: Any,
    place: Any,
    n: int,
    same: bool,
) -> None:
    """Add symmetric entries (n,), and their mirror images where the whole band is stored, `diagonal` > 0.

    Entry (i, j) of the matrix lies at flat[stride x j + diagonal + i]. Two coefficients that follow one
    unknown meet their mirror image on the diagonal, unless they are the `same`.
    """
    nowhere = flat.size - 1
    for lane in range(n):
        least = min(row[lane], column[lane])
        place[lane] = stride * least + diagonal + max(row[lane], column[lane]) if least >= 0 else nowhere
    if not same:
        for lane in range(n):
            value[lane] *= 2.0 if row[lane] == column[lane] else 1.0
    for lane in range(n):
        flat[place[lane]] += value[lane]
    if diagonal > 0:
        for lane in range(n):
            if row[lane] >= 0 and column[lane] >= 0 and row[lane] != column[lane]:
                greatest = max(row[lane], column[lane])
                flat[stride * greatest + diagonal + min(row[lane], column[lane])] += value[lane]
