"""Compiled loops over elements (total Lagrangian): forces, energies and tangents.

The bulk is assembled LANES elements at a time: every array ends with the lane, and the innermost loops run
over it, so that they fill the processor's vector registers whatever the degree. Index names: a, b functions
of an element; i, k components; J, L reference directions; q quadrature points; lane the element of a batch.
"""

from typing import Any

import numpy as np
from numba import njit

from isopeel.arrays import FloatArray, IntArray
from isopeel.physics.adhesion.irreversible import with_history
from isopeel.physics.adhesion.sliding import with_slip
from isopeel.physics.batch import BatchFunction

#: Elements of a batch: enough that the test for overlapping arrays, made before each innermost loop, costs
#: little.
LANES = 64

# Reordered sums let loops run in vector registers; nan must stay nan, because it is how an inverted
# element is noticed.
_compiled = njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "nsz"})
_inlined = njit(inline="always")


@_compiled
def bulk(
    material: BatchFunction,
    parameters: FloatArray,
    functions: IntArray,
    gradients: FloatArray,
    weights: FloatArray,
    unknowns: IntArray,
    u: FloatArray,
    forces: FloatArray,
    band: FloatArray,
    diagonal: int,
    with_tangent: bool,
) -> tuple[float, float]:
    """Add internal forces int P_iJ dN_a/dX_J dV and their tangent; return the stored energy and least det F.

    Shapes as in `BatchTable`; unknowns (B, 2, m, LANES); u, forces (size, 2); band (unknowns + 1, width),
    whose last row takes what no unknown wants, untouched without `with_tangent`.
    """
    batches, m, _ = functions.shape
    Q = weights.shape[1]
    points = Q * LANES
    local = np.empty((2, m, LANES))
    total = np.empty(LANES)
    F = np.empty((2, 2, points))
    density = np.empty(points)
    P = np.empty((2, 2, points))
    A = np.empty((2, 2, 2, 2, points))
    flux = np.empty((Q, 3, 2, LANES))
    K = np.empty((3, m, LANES))
    starts = np.empty((2, m, LANES), np.int64)
    place = np.empty(LANES, np.int64)
    flat = band.ravel()
    energy = 0.0
    lowest = np.inf
    for e in range(batches):
        G = gradients[e]
        for a in range(m):
            for i in range(2):
                for lane in range(LANES):
                    local[i, a, lane] = u[functions[e, a, lane], i]
        for q in range(Q):
            here = slice(q * LANES, (q + 1) * LANES)
            for i in range(2):
                for J in range(2):
                    total[:] = 1.0 if i == J else 0.0
                    for a in range(m):
                        _add_product(total, local[i, a], G[q, J, a])
                    F[i, J, here] = total
        for point in range(points):
            lowest = min(lowest, F[0, 0, point] * F[1, 1, point] - F[0, 1, point] * F[1, 0, point])
        material(F, parameters, points, density, P, A)
        for q in range(Q):
            here = slice(q * LANES, (q + 1) * LANES)
            energy += np.sum(weights[e, q] * density[here])
            for i in range(2):
                for J in range(2):
                    P[i, J, here] *= weights[e, q]
        for a in range(m):
            for i in range(2):
                total[:] = 0.0
                for q in range(Q):
                    here = slice(q * LANES, (q + 1) * LANES)
                    _add_products(total, P[i, 0, here], G[q, 0, a], P[i, 1, here], G[q, 1, a])
                for lane in range(LANES):
                    forces[functions[e, a, lane], i] += total[lane]
        if with_tangent:
            starts[:] = unknowns[e] * (band.shape[1] - 1)
            for b in range(m):
                _column(A, G, weights[e], b, flux, K)
                for pair in range(3):
                    i = pair // 2
                    k = (pair + 1) // 2
                    # the other half of the tangent follows from its symmetry
                    for a in range(0 if i != k else b, m):
                        _scatter(
                            flat,
                            diagonal,
                            unknowns[e, i, a],
                            unknowns[e, k, b],
                            starts[i, a],
                            starts[k, b],
                            K[pair, a],
                            place,
                            i == k and a == b,
                        )
    return energy, lowest


@_inlined
def _add_product(total: Any, x: Any, y: Any) -> None:
    for lane in range(LANES):
        total[lane] += x[lane] * y[lane]


@_inlined
def _add_products(total: Any, x0: Any, y0: Any, x1: Any, y1: Any) -> None:
    for lane in range(LANES):
        total[lane] += x0[lane] * y0[lane] + x1[lane] * y1[lane]


@_compiled
def _column(A: Any, G: Any, weights: Any, b: int, flux: Any, K: Any) -> None:
    """K_ai,bk = sum_q w dN_a/dX_J A_iJkL dN_b/dX_L of one b, for the pairs (i, k) = 00, 01, 11."""
    Q, _, m, _ = G.shape
    for q in range(Q):
        here = slice(q * LANES, (q + 1) * LANES)
        for pair in range(3):
            i = pair // 2
            k = (pair + 1) // 2
            for J in range(2):
                flow = flux[q, pair, J]
                flow[:] = 0.0
                _add_products(flow, A[i, J, k, 0, here], G[q, 0, b], A[i, J, k, 1, here], G[q, 1, b])
                flow *= weights[q]
    K[:] = 0.0
    for q in range(Q):
        for a in range(m):
            g0 = G[q, 0, a]
            g1 = G[q, 1, a]
            _add_products(K[1, a], g0, flux[q, 1, 0], g1, flux[q, 1, 1])
            if a >= b:
                _add_products(K[0, a], g0, flux[q, 0, 0], g1, flux[q, 0, 1])
                _add_products(K[2, a], g0, flux[q, 2, 0], g1, flux[q, 2, 1])


@_compiled
def _scatter(
    flat: Any,
    diagonal: int,
    row: Any,
    column: Any,
    row_start: Any,
    column_start: Any,
    value: Any,
    place: Any,
    same: bool,
) -> None:
    """Add symmetric entries (LANES,), and their mirror images where the whole band is stored, `diagonal` > 0.

    Entry (i, j) of the matrix lies at flat[start_j + diagonal + i]. Two coefficients that follow one
    unknown meet their mirror image on the diagonal, unless they are the `same`.
    """
    nowhere = flat.size - 1
    for lane in range(LANES):
        start = min(row_start[lane], column_start[lane])
        place[lane] = start + diagonal + max(row[lane], column[lane]) if start >= 0 else nowhere
    if not same:
        for lane in range(LANES):
            value[lane] *= 2.0 if row[lane] == column[lane] else 1.0
    for lane in range(LANES):
        flat[place[lane]] += value[lane]
    if diagonal > 0:
        for lane in range(LANES):
            if row[lane] >= 0 and column[lane] >= 0 and row[lane] != column[lane]:
                start = max(row_start[lane], column_start[lane])
                flat[start + diagonal + min(row[lane], column[lane])] += value[lane]


@_compiled
def adhesion(
    law: BatchFunction,
    law_parameters: FloatArray,
    substrate: BatchFunction,
    substrate_parameters: FloatArray,
    functions: IntArray,
    values: FloatArray,
    gradients: FloatArray,
    weights: FloatArray,
    positions: FloatArray,
    normals: FloatArray,
    unknowns: IntArray,
    factors: bool,
    projected: bool,
    irreversible: bool,
    openings: FloatArray,
    sliding_length: float,
    tangents: FloatArray,
    equilibrium_gap: float,
    u: FloatArray,
    forces: FloatArray,
    band: FloatArray,
    diagonal: int,
    with_tangent: bool,
) -> tuple[float, float]:
    """Add the forces -int N_a T n phi dA of a substrate and their tangent; return two energies.

    They are the adhesive energy and the dissipated one, which an `irreversible` law has after the largest
    `openings` (E, Q) so far. With `factors` the law is told the curvature. A joint with a `sliding_length`,
    zero for none, also holds along the `tangents` (E, Q, 2).

    phi = 1 on the reference area, or -n . F^-T N_o when `projected`. The normal turns along a substrate of
    curvature k: dn/dx = k/(1 + k r) t t (Sadhana 46:3, 2021, Eqs. 19, 26, 27; with v = F^-T N_o, w = F^-1 n,
    d phi/dF_kL = v_k w_L). Shapes as in `SideTable`.
    """
    elements, m = functions.shape
    Q = weights.shape[1]
    x = np.empty((2, Q))
    gap = np.empty(Q)
    n = np.empty((2, Q))
    curvature = np.empty(Q)
    seen = np.zeros(Q)
    closed = np.full(Q, equilibrium_gap)
    bottom = np.zeros((3, Q))
    slip = np.empty(Q)
    potential = np.empty(Q)
    T = np.empty(Q)
    dT = np.empty(Q)
    lost = np.zeros(Q)
    shear = np.zeros((3, Q))
    F = np.empty((2, 2))
    H = np.empty((2, 2))
    v = np.empty(2)
    w = np.empty(2)
    t = np.empty(2)
    K = np.empty((2, m, 2, m))
    energy = 0.0
    dissipated = 0.0
    for e in range(elements):
        for q in range(Q):
            for i in range(2):
                x[i, q] = positions[e, q, i]
                for a in range(m):
                    x[i, q] += values[e, q, a] * u[functions[e, a], i]
        substrate(x, substrate_parameters, Q, gap, n, curvature)
        if factors:
            seen[:] = curvature
        if irreversible:
            with_history(
                law, gap, seen, openings[e], equilibrium_gap, law_parameters, Q, potential, T, dT, lost
            )
        else:
            law(gap, seen, law_parameters, Q, potential, T, dT)
        if sliding_length > 0.0:
            for q in range(Q):
                slip[q] = 0.0
                for i in range(2):
                    slip[q] += tangents[e, q, i] * (x[i, q] - positions[e, q, i])
            law(closed, seen, law_parameters, Q, bottom[0], bottom[1], bottom[2])
            with_slip(
                gap,
                slip,
                sliding_length,
                equilibrium_gap,
                bottom[0],
                Q,
                potential,
                T,
                dT,
                shear[0],
                shear[1],
                shear[2],
            )
        K[:] = 0.0
        for q in range(Q):
            phi = 1.0
            if projected:
                _inverse_deformation(u, functions[e], gradients[e, q], F, H)
                for i in range(2):
                    v[i] = H[0, i] * normals[e, q, 0] + H[1, i] * normals[e, q, 1]
                    w[i] = H[i, 0] * n[0, q] + H[i, 1] * n[1, q]
                phi = -(n[0, q] * v[0] + n[1, q] * v[1])
            area = weights[e, q]
            energy += area * phi * potential[q]
            dissipated += area * phi * lost[q]
            for a in range(m):
                for i in range(2):
                    pull = phi * T[q] * n[i, q] - shear[0, q] * tangents[e, q, i]
                    forces[functions[e, a], i] -= area * pull * values[e, q, a]
            if not with_tangent:
                continue
            t[0] = -n[1, q]
            t[1] = n[0, q]
            turn = curvature[q] / (1.0 + curvature[q] * gap[q])
            turning = turn * (t[0] * v[0] + t[1] * v[1]) if projected else 0.0
            for a in range(m):
                share = -area * values[e, q, a]
                for i in range(2):
                    for b in range(m):
                        along = (
                            w[0] * gradients[e, q, 0, b] + w[1] * gradients[e, q, 1, b] if projected else 0.0
                        )
                        for k in range(2):
                            moved = dT[q] * n[i, q] * n[k, q] + T[q] * turn * t[i] * t[k]
                            if sliding_length > 0.0:
                                hold = tangents[e, q]
                                moved -= shear[1, q] * hold[i] * hold[k]
                                moved -= shear[2, q] * (n[i, q] * hold[k] + hold[i] * n[k, q])
                            change = moved * phi * values[e, q, b]
                            if projected:
                                change += T[q] * n[i, q] * (v[k] * along - turning * t[k] * values[e, q, b])
                            K[i, a, k, b] += share * change
        if with_tangent:
            for a in range(m):
                for i in range(2):
                    for b in range(m):
                        for k in range(2):
                            row = unknowns[e, a, i]
                            column = unknowns[e, b, k]
                            if row >= 0 and column >= 0 and (diagonal > 0 or row >= column):
                                band[column, diagonal + row - column] += K[i, a, k, b]
    return energy, dissipated


@_compiled
def _inverse_deformation(u: Any, functions: Any, gradients: Any, F: Any, H: Any) -> None:
    """Deformation gradient F at one point, and H = F^-1."""
    for i in range(2):
        for J in range(2):
            F[i, J] = 1.0 if i == J else 0.0
            for a in range(functions.size):
                F[i, J] += u[functions[a], i] * gradients[J, a]
    determinant = F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0]
    H[0, 0] = F[1, 1] / determinant
    H[0, 1] = -F[0, 1] / determinant
    H[1, 0] = -F[1, 0] / determinant
    H[1, 1] = F[0, 0] / determinant
