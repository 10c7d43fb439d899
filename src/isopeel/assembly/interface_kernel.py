"""Compiled evaluation of the interface at points of the adhering side: the only place that composes its law.

The assembly (`adhesion_kernel`) and every reading of a state (`interface`) call it, so that both have the
same curvature, damage, sliding and projected area.
"""

from typing import NamedTuple

import numpy as np

from isopeel.assembly.packing import Floats1, Floats2, Floats3, Floats4, Integers2, Integers3, reader
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import compiled_reordered, inner_reordered
from isopeel.physics.adhesion.irreversible import damaged
from isopeel.physics.adhesion.sliding import slipped
from isopeel.physics.batch import BatchFunction, law_at, substrate_at


class InterfaceData(NamedTuple):
    """The data of the loops over an interface of E elements with Q points each."""

    law: int  # address
    parameters: Floats1
    equilibrium_gap: float
    substrate: int  # address
    substrate_parameters: Floats1
    functions: Integers2  # this and the following as in `SideTable`
    values: Floats3
    gradients: Floats4
    weights: Floats2
    positions: Floats3
    normals: Floats3
    tangents: Floats3  # of the substrate at the points' first positions, (E, Q, 2)
    unknowns: Integers3  # (E, m, 2)
    factors: bool  # whether the law depends on the curvature
    projected: bool
    irreversible: bool
    augmented: bool  # whether the law has multipliers
    sliding_length: float  # zero for none


read_interface = reader(InterfaceData)


class Response(NamedTuple):
    """The state of the interface at points (n), in the order of the elements."""

    position: FloatArray  # x (2, n)
    gap: FloatArray
    normal: FloatArray  # n_o (2, n)
    curvature: FloatArray  # of the substrate, even if the law does not depend on it
    potential: FloatArray  # this and the following per area that the traction acts on
    traction: FloatArray  # T along n_o, repulsion positive
    derivative: FloatArray  # of T by the gap
    dissipated: FloatArray
    shear: FloatArray  # V_s, V_ss and V_rs (3, n) of a joint that slides, else zero


@inner_reordered
def respond_normally(
    law: BatchFunction,
    parameters: FloatArray,
    equilibrium_gap: float,
    irreversible: int,
    maximum_openings: FloatArray,
    gap: FloatArray,
    seen: FloatArray,
    closed: FloatArray,
    answer: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
) -> None:
    """Write potential, traction, its derivative and the dissipated energy at gaps (n), after a history (n).

    An `irreversible` law needs its values `closed` (3, n) at the equilibrium gap; `seen` (n) is the curvature
    that it depends on.
    """
    potential, T, dT, lost = answer
    points = gap.size
    law(gap, seen, parameters, points, potential, T, dT)
    if irreversible:
        at = np.empty(points)
        reached = np.empty((3, points))
        for p in range(points):
            at[p] = equilibrium_gap + max(maximum_openings[p], 0.0)
        law(at, seen, parameters, points, reached[0], reached[1], reached[2])
        for p in range(points):
            here = potential[p], T[p], dT[p]
            potential[p], T[p], dT[p], lost[p] = damaged(
                gap[p],
                equilibrium_gap,
                maximum_openings[p],
                here,
                (closed[0, p], closed[1, p]),
                (reached[0, p], reached[1, p]),
            )


@inner_reordered
def respond_with_multipliers(
    law: BatchFunction,
    parameters: FloatArray,
    equilibrium_gap: float,
    replaced: FloatArray,
    gap: FloatArray,
    seen: FloatArray,
    answer: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
) -> None:
    """Write the same for a law with multipliers, which replace overlaps (n), see `adhesion.augmented`."""
    potential, T, dT, _ = answer
    points = gap.size
    at = np.empty(points)
    closed = np.empty((3, points))
    for p in range(points):
        at[p] = equilibrium_gap - replaced[p]
    law(at, seen, parameters, points, closed[0], closed[1], closed[2])
    for p in range(points):
        at[p] = gap[p] - replaced[p]
    law(at, seen, parameters, points, potential, T, dT)
    for p in range(points):
        potential[p] -= closed[0, p]


@compiled_reordered
def respond(interface: InterfaceData, maximum_openings: FloatArray, u: FloatArray) -> Response:
    """Evaluate the interface of a body with coefficients u (size, 2).

    An `irreversible` law depends on the `maximum_openings` (E Q,) so far; a joint with a `sliding_length`
    also holds along the tangents.
    """
    law, substrate = law_at(interface.law), substrate_at(interface.substrate)
    parameters, equilibrium_gap = interface.parameters, interface.equilibrium_gap
    functions, values, positions = interface.functions, interface.values, interface.positions
    tangents, sliding_length = interface.tangents, interface.sliding_length
    elements, m = functions.shape
    Q = positions.shape[1]
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
    local = np.empty((2, m))
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
    substrate(x, interface.substrate_parameters, points, gap, n, curvature)
    if interface.factors:
        for p in range(points):
            seen[p] = curvature[p]
    # both need the law at the equilibrium gap
    compared = interface.irreversible or sliding_length > 0.0
    closed = np.empty((3, points if compared else 0))
    if compared:
        at = np.full(points, equilibrium_gap)
        law(at, seen, parameters, points, closed[0], closed[1], closed[2])
    if interface.augmented:
        respond_with_multipliers(
            law, parameters, equilibrium_gap, maximum_openings, gap, seen, (potential, T, dT, lost)
        )
    else:
        respond_normally(
            law,
            parameters,
            equilibrium_gap,
            interface.irreversible,
            maximum_openings,
            gap,
            seen,
            closed,
            (potential, T, dT, lost),
        )
    if sliding_length > 0.0:
        for p in range(points):
            e, q = p // Q, p % Q
            slip = 0.0
            for i in range(2):
                slip += tangents[e, q, i] * (x[i, p] - positions[e, q, i])
            here = potential[p], T[p], dT[p]
            worn = (closed[0, p], 0.0, 0.0) if gap[p] < equilibrium_gap else here
            potential[p], T[p], dT[p], shear[0, p], shear[1, p], shear[2, p] = slipped(
                slip, sliding_length, here, worn
            )
    return Response(x, gap, n, curvature, potential, T, dT, lost, shear)


@inner_reordered
def project(
    u: FloatArray,
    functions: IntArray,
    gradients: FloatArray,
    rest_normal: FloatArray,
    n_x: float,
    n_y: float,
    F: FloatArray,
    H: FloatArray,
    v: FloatArray,
    w: FloatArray,
) -> float:
    """Return the projected area -n . F^-T N_o of a unit reference area at one point.

    The functions (m,) of the element have the gradients (2, m); n = (n_x, n_y) is the normal of the
    substrate. Writes v = F^-T N_o, w = F^-1 n, F and H = F^-1.
    """
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
    for i in range(2):
        v[i] = H[0, i] * rest_normal[0] + H[1, i] * rest_normal[1]
        w[i] = H[i, 0] * n_x + H[i, 1] * n_y
    area: float = -(n_x * v[0] + n_y * v[1])
    return area


@compiled_reordered
def projected_areas(
    functions: IntArray, gradients: FloatArray, rest_normals: FloatArray, normal: FloatArray, u: FloatArray
) -> FloatArray:
    """Return projected areas (n,) of unit reference areas at points of a `SideTable`, for normals (2, n)."""
    Q = gradients.shape[1]
    areas = np.empty(normal.shape[1])
    F, H, v, w = np.empty((2, 2)), np.empty((2, 2)), np.empty(2), np.empty(2)
    for p in range(areas.size):
        e, q = p // Q, p % Q
        areas[p] = project(
            u, functions[e], gradients[e, q], rest_normals[e, q], normal[0, p], normal[1, p], F, H, v, w
        )
    return areas
