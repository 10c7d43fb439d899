"""Compiled loops over the side that adheres (total Lagrangian): forces, energies and tangents.

Index names: a, b functions of an element; i, k components; J, L reference directions; q quadrature points.
"""

from typing import Any, NamedTuple

import numpy as np
from numba import boolean, float64, int64

from isopeel.assembly.loops import PAIR, read_only
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import compiled_reordered
from isopeel.physics.adhesion.irreversible import with_history
from isopeel.physics.adhesion.sliding import with_slip
from isopeel.physics.batch import law_at, of_address, substrate_at


class AdhesionArguments(NamedTuple):
    """The loops over a side, by the address of their compiled code, and what they are told at each call."""

    loops: int
    law: int  # address
    law_parameters: FloatArray
    substrate: int  # address
    substrate_parameters: FloatArray
    functions: IntArray  # this and the following as in `SideTable`
    values: FloatArray
    gradients: FloatArray
    weights: FloatArray
    positions: FloatArray
    normals: FloatArray
    unknowns: IntArray  # (E, m, 2)
    factors: bool
    projected: bool
    irreversible: bool
    sliding_length: float
    tangents: FloatArray  # (E, Q, 2)
    equilibrium_gap: float


def add_adhesion(
    law_address: int,
    law_parameters: FloatArray,
    substrate_address: int,
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
    sliding_length: float,
    tangents: FloatArray,
    equilibrium_gap: float,
    openings: FloatArray,
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
    law, substrate = law_at(law_address), substrate_at(substrate_address)
    elements, m = functions.shape
    Q = weights.shape[1]
    # of all points at once, for the loops of law and substrate
    points = elements * Q
    x = np.empty((2, points))
    gap = np.empty(points)
    n = np.empty((2, points))
    curvature = np.empty(points)
    seen = np.zeros(points)
    potential = np.empty(points)
    T = np.empty(points)
    dT = np.empty(points)
    lost = np.zeros(points)
    shear = np.zeros((3, points))
    local = np.empty((2, m))  # of one element: its displacements, and then its forces
    for e in range(elements):
        for a in range(m):
            for i in range(2):
                local[i, a] = u[functions[e, a], i]
        for q in range(Q):
            for i in range(2):
                place = positions[e, q, i]
                for a in range(m):
                    place += values[e, q, a] * local[i, a]
                x[i, e * Q + q] = place
    substrate(x, substrate_parameters, points, gap, n, curvature)
    if factors:
        for p in range(points):
            seen[p] = curvature[p]
    if irreversible:
        with_history(
            law,
            gap,
            seen,
            openings.ravel(),
            equilibrium_gap,
            law_parameters,
            points,
            potential,
            T,
            dT,
            lost,
        )
    else:
        law(gap, seen, law_parameters, points, potential, T, dT)
    if sliding_length > 0.0:
        closed = np.full(points, equilibrium_gap)
        bottom = np.empty((3, points))
        slip = np.zeros(points)
        for e in range(elements):
            for q in range(Q):
                for i in range(2):
                    slip[e * Q + q] += tangents[e, q, i] * (x[i, e * Q + q] - positions[e, q, i])
        law(closed, seen, law_parameters, points, bottom[0], bottom[1], bottom[2])
        with_slip(
            gap,
            slip,
            sliding_length,
            equilibrium_gap,
            bottom[0],
            points,
            potential,
            T,
            dT,
            shear[0],
            shear[1],
            shear[2],
        )
    F = np.empty((2, 2))
    H = np.empty((2, 2))
    v = np.empty(2)
    w = np.empty(2)
    t = np.empty(2)
    K = np.empty((2, m, 2, m))
    energy = 0.0
    dissipated = 0.0
    for e in range(elements):
        local.fill(0.0)
        if with_tangent:
            K.fill(0.0)
        for q in range(Q):
            p = e * Q + q
            phi = 1.0
            if projected:
                _inverse_deformation(u, functions[e], gradients[e, q], F, H)
                for i in range(2):
                    v[i] = H[0, i] * normals[e, q, 0] + H[1, i] * normals[e, q, 1]
                    w[i] = H[i, 0] * n[0, p] + H[i, 1] * n[1, p]
                phi = -(n[0, p] * v[0] + n[1, p] * v[1])
            area = weights[e, q]
            energy += area * phi * potential[p]
            dissipated += area * phi * lost[p]
            for i in range(2):
                pull = area * (phi * T[p] * n[i, p] - shear[0, p] * tangents[e, q, i])
                for a in range(m):
                    local[i, a] -= pull * values[e, q, a]
            if not with_tangent:
                continue
            t[0] = -n[1, p]
            t[1] = n[0, p]
            turn = curvature[p] / (1.0 + curvature[p] * gap[p])
            turning = turn * (t[0] * v[0] + t[1] * v[1]) if projected else 0.0
            for a in range(m):
                share = -area * values[e, q, a]
                for i in range(2):
                    for b in range(m):
                        along = (
                            w[0] * gradients[e, q, 0, b] + w[1] * gradients[e, q, 1, b] if projected else 0.0
                        )
                        for k in range(2):
                            moved = dT[p] * n[i, p] * n[k, p] + T[p] * turn * t[i] * t[k]
                            if sliding_length > 0.0:
                                hold = tangents[e, q]
                                moved -= shear[1, p] * hold[i] * hold[k]
                                moved -= shear[2, p] * (n[i, p] * hold[k] + hold[i] * n[k, p])
                            change = moved * phi * values[e, q, b]
                            if projected:
                                change += T[p] * n[i, p] * (v[k] * along - turning * t[k] * values[e, q, b])
                            K[i, a, k, b] += share * change
        for a in range(m):
            for i in range(2):
                forces[functions[e, a], i] += local[i, a]
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


#: Of `add_adhesion`.
SIDE_SIGNATURE = PAIR(
    int64,
    float64[::1],
    int64,
    float64[::1],
    read_only(int64, 2),
    read_only(float64, 3),
    read_only(float64, 4),
    read_only(float64, 2),
    read_only(float64, 3),
    read_only(float64, 3),
    read_only(int64, 3),
    boolean,
    boolean,
    boolean,
    float64,
    read_only(float64, 3),
    float64,
    read_only(float64, 2),
    read_only(float64, 2),
    float64[:, ::1],
    float64[:, ::1],
    int64,
    boolean,
)

#: Those loops, of their address, within compiled code.
adhesion_at = of_address(SIDE_SIGNATURE)


@compiled_reordered
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
