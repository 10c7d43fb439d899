"""Compiled loops over elements (total Lagrangian): forces, energies and tangents.

Every kernel visits the quadrature points of one element at a time: it evaluates the deformation at all
points, calls the law's batch function on them, and adds up the element's forces and tangent. Index names: a, b functions of
an element; i, k components; J, L reference directions; q points.
"""

from typing import Any

import numpy as np
from numba import njit

from isopeel.arrays import FloatArray, IntArray
from isopeel.physics.batch import BatchFunction

# Reordered sums let the loops over functions run in vector registers; nan must stay nan, because it is how
# an inverted element is noticed.
_compiled = njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc", "nsz"})


@njit(cache=True, inline="always")
def _add(band: Any, diagonal: int, row: int, column: int, value: float) -> None:
    """Add to an entry of a band matrix, stored by columns; `diagonal` 0 means the lower half only."""
    if row >= 0 and column >= 0 and (diagonal > 0 or row >= column):
        band[column, diagonal + row - column] += value


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
) -> float:
    """Add internal forces int P_iJ dN_a/dX_J dV and their tangent; return the stored energy.

    Shapes as in `ElementTable`; u, forces (size, 2); band (unknowns, width), untouched without `with_tangent`.
    """
    elements, m = functions.shape
    Q = weights.shape[1]
    F = np.empty((2, 2, Q))
    density = np.empty(Q)
    P = np.empty((2, 2, Q))
    A = np.empty((2, 2, 2, 2, Q))
    local = np.empty((2, m))
    force = np.empty((2, m))
    flux = np.empty((2, 2, m))
    K00 = np.empty((m, m))
    K01 = np.empty((m, m))
    K11 = np.empty((m, m))
    energy = 0.0
    for e in range(elements):
        for a in range(m):
            for i in range(2):
                local[i, a] = u[functions[e, a], i]
        for q in range(Q):
            for i in range(2):
                for J in range(2):
                    total = 0.0
                    for a in range(m):
                        total += local[i, a] * gradients[e, q, J, a]
                    F[i, J, q] = total
            F[0, 0, q] += 1.0
            F[1, 1, q] += 1.0
        material(F, parameters, Q, density, P, A)
        force[:] = 0.0
        for q in range(Q):
            w = weights[e, q]
            energy += w * density[q]
            G = gradients[e, q]
            for i in range(2):
                p0 = w * P[i, 0, q]
                p1 = w * P[i, 1, q]
                for a in range(m):
                    force[i, a] += p0 * G[0, a] + p1 * G[1, a]
        for a in range(m):
            for i in range(2):
                forces[functions[e, a], i] += force[i, a]
        if not with_tangent:
            continue
        K00[:] = 0.0
        K01[:] = 0.0
        K11[:] = 0.0
        for q in range(Q):
            w = weights[e, q]
            G = gradients[e, q]
            _add_products(K00, G, w, A[0, 0, 0, 0, q], A[0, 0, 0, 1, q], A[0, 1, 0, 0, q], A[0, 1, 0, 1, q], flux, m)
            _add_products(K01, G, w, A[0, 0, 1, 0, q], A[0, 0, 1, 1, q], A[0, 1, 1, 0, q], A[0, 1, 1, 1, q], flux, m)
            _add_products(K11, G, w, A[1, 0, 1, 0, q], A[1, 0, 1, 1, q], A[1, 1, 1, 0, q], A[1, 1, 1, 1, q], flux, m)
        for a in range(m):
            row0 = unknowns[e, a, 0]
            row1 = unknowns[e, a, 1]
            for b in range(m):
                column0 = unknowns[e, b, 0]
                column1 = unknowns[e, b, 1]
                _add(band, diagonal, row0, column0, K00[a, b])
                _add(band, diagonal, row0, column1, K01[a, b])
                _add(band, diagonal, row1, column0, K01[b, a])
                _add(band, diagonal, row1, column1, K11[a, b])
    return energy


@njit(cache=True, inline="always")
def _add_products(
    K: Any, G: Any, w: float, A00: float, A01: float, A10: float, A11: float, flux: Any, m: int
) -> None:
    """K_ab += w G_Ja A_JL G_Lb."""
    for b in range(m):
        flux[0, 0, b] = w * (A00 * G[0, b] + A01 * G[1, b])
        flux[0, 1, b] = w * (A10 * G[0, b] + A11 * G[1, b])
    for a in range(m):
        g0 = G[0, a]
        g1 = G[1, a]
        for b in range(m):
            K[a, b] += g0 * flux[0, 0, b] + g1 * flux[0, 1, b]


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
    projected: bool,
    u: FloatArray,
    forces: FloatArray,
    band: FloatArray,
    diagonal: int,
    with_tangent: bool,
) -> float:
    """Add the forces -int N_a T n phi dA of a substrate and their tangent; return the adhesive energy.

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
    potential = np.empty(Q)
    T = np.empty(Q)
    dT = np.empty(Q)
    F = np.empty((2, 2))
    H = np.empty((2, 2))
    v = np.empty(2)
    w = np.empty(2)
    t = np.empty(2)
    K = np.empty((2, m, 2, m))
    energy = 0.0
    for e in range(elements):
        for q in range(Q):
            for i in range(2):
                x[i, q] = positions[e, q, i]
                for a in range(m):
                    x[i, q] += values[e, q, a] * u[functions[e, a], i]
        substrate(x, substrate_parameters, Q, gap, n, curvature)
        law(gap, curvature, law_parameters, Q, potential, T, dT)
        K[:] = 0.0
        for q in range(Q):
            phi = 1.0
            if projected:
                for i in range(2):
                    for J in range(2):
                        F[i, J] = 1.0 if i == J else 0.0
                        for a in range(m):
                            F[i, J] += u[functions[e, a], i] * gradients[e, q, J, a]
                determinant = F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0]
                H[0, 0] = F[1, 1] / determinant
                H[0, 1] = -F[0, 1] / determinant
                H[1, 0] = -F[1, 0] / determinant
                H[1, 1] = F[0, 0] / determinant
                for i in range(2):
                    v[i] = H[0, i] * normals[e, q, 0] + H[1, i] * normals[e, q, 1]
                    w[i] = H[i, 0] * n[0, q] + H[i, 1] * n[1, q]
                phi = -(n[0, q] * v[0] + n[1, q] * v[1])
            area = weights[e, q]
            energy += area * phi * potential[q]
            for a in range(m):
                for i in range(2):
                    forces[functions[e, a], i] -= area * phi * T[q] * n[i, q] * values[e, q, a]
            if not with_tangent:
                continue
            t[0] = -n[1, q]
            t[1] = n[0, q]
            turn = curvature[q] / (1.0 + curvature[q] * gap[q])
            slip = turn * (t[0] * v[0] + t[1] * v[1]) if projected else 0.0
            for a in range(m):
                share = -area * values[e, q, a]
                for i in range(2):
                    for b in range(m):
                        along = w[0] * gradients[e, q, 0, b] + w[1] * gradients[e, q, 1, b] if projected else 0.0
                        for k in range(2):
                            moved = dT[q] * n[i, q] * n[k, q] + T[q] * turn * t[i] * t[k]
                            change = moved * phi * values[e, q, b]
                            if projected:
                                change += T[q] * n[i, q] * (v[k] * along - slip * t[k] * values[e, q, b])
                            K[i, a, k, b] += share * change
        if with_tangent:
            for a in range(m):
                for i in range(2):
                    for b in range(m):
                        for k in range(2):
                            _add(band, diagonal, unknowns[e, a, i], unknowns[e, b, k], K[i, a, k, b])
    return energy
