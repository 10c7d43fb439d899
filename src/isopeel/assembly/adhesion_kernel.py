"""Compiled loops over the side that adheres (total Lagrangian): forces, energies and tangents.

Index names: a, b functions of an element; i, k components; J, L reference directions; q quadrature points.
"""

import numpy as np

from isopeel.assembly.interface_kernel import InterfaceData, project, read_interface, respond
from isopeel.assembly.loops import Energies
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.matrix.band import entry_place


def add_adhesion(
    integers: IntArray,
    floats: FloatArray,
    maximum_openings: FloatArray,
    _scalars: FloatArray,
    u: FloatArray,
    forces: FloatArray,
    band: FloatArray,
    diagonal: int,
    with_tangent: bool,
) -> Energies:
    """Add the forces -int N_a T n phi dA of a substrate and their tangent; the energies of adhesion.

    The integers and floats are those of an `InterfaceData`. An `irreversible` law depends on the
    `maximum_openings` (E Q,) so far.

    phi = 1 on the reference area, or -n . F^-T N_o when `projected`. The normal turns along a substrate of
    curvature k: dn/dx = k/(1 + k r) t t (Sadhana 46:3, 2021, Eqs. 19, 26, 27; with v = F^-T N_o, w = F^-1 n,
    d phi/dF_kL = v_k w_L).
    """
    interface: InterfaceData = read_interface(integers, floats)
    response = respond(interface, maximum_openings, u)
    functions, values, gradients = interface.functions, interface.values, interface.gradients
    weights, normals, unknowns = interface.weights, interface.normals, interface.unknowns
    projected, tangents = interface.projected, interface.tangents
    sliding_length = interface.sliding_length
    gap, n, curvature, potential = response.gap, response.normal, response.curvature, response.potential
    T, dT, lost, shear = response.traction, response.derivative, response.dissipated, response.shear
    elements, m = functions.shape
    Q = weights.shape[1]
    flat, stride = band.ravel(), band.shape[1] - 1
    local = np.empty((2, m))  # forces of one element
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
                phi = project(u, functions[e], gradients[e, q], normals[e, q], n[0, p], n[1, p], F, H, v, w)
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
                                flat[entry_place(stride, diagonal, row, column)] += K[i, a, k, b]
    return 0.0, energy, dissipated, np.inf
