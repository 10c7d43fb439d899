"""Compiled loops over a side that faces a side of another body: forces, energies and tangents.

Index names: c, d functions of a point: those of its own element, and those of its partner's segment; i, k
components; p points. With the partner y(s) of the point x, the relative displacement is
d(x - y) = sum_c P_c du_c at a fixed place s, and dy' = sum_c R_c du_c.
"""

from typing import NamedTuple

import numpy as np

from isopeel.assembly.closest_point_kernel import CORNER, NONE, bernstein, closest_point, segments_at
from isopeel.assembly.interface_kernel import Response, respond_normally, respond_with_multipliers
from isopeel.assembly.loops import Energies
from isopeel.assembly.packing import Floats1, Floats2, Floats3, Integers2, Integers3, reader
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import compiled_reordered, inner, inner_reordered
from isopeel.matrix.band import entry_place
from isopeel.physics.batch import law_at


class FacingData(NamedTuple):
    """The data of the loops over E elements, of Q points each, that face a curve of S segments."""

    law: int  # address
    parameters: Floats1
    equilibrium_gap: float
    irreversible: bool
    augmented: bool  # whether the law has multipliers
    share: float  # of a point in the energy: one half where both sides are integrated
    mutual: bool  # whether the other body feels the force too
    far: float  # a gap at which nothing acts
    functions: Integers2  # this and the following as in `SideTable`
    values: Floats3
    weights: Floats2
    positions: Floats3
    normals: Floats3
    slopes: Floats3  # (E, Q, m) derivatives of the functions by the reference length, anticlockwise
    unknowns: Integers3  # (E, m, 2)
    segment_functions: Integers2  # this and the following as in `FacingCurve`
    segment_values: Floats3
    segment_weights: Floats2
    shape: Floats3
    orientation: float
    segment_unknowns: Integers3  # (S, m, 2)


read_facing = reader(FacingData)


class Partners(NamedTuple):
    """Points (n) of a side and their partners, in the order of the elements."""

    kind: IntArray  # NONE, SMOOTH or CORNER, see `closest_point_kernel`
    segment: IntArray
    place: FloatArray  # s, on the segment
    position: FloatArray  # x (2, n)
    gap: FloatArray
    normal: FloatArray  # outward, of the other body at the partner (2, n)
    tangent: FloatArray  # dy/ds (2, n)
    bend: FloatArray  # n . d2y/ds2


@compiled_reordered
def find_partners(facing: FacingData, u: FloatArray) -> Partners:
    """Return the partners of all points, at coefficients u (size, 2).

    A point has none where its projection leaves the end of the other side, and where both outward normals
    have a common direction: there a body lies between them.
    """
    curve = segments_at(
        facing.segment_functions, facing.segment_values, facing.segment_weights, facing.shape, u
    )
    functions, values, slopes, rest = facing.functions, facing.values, facing.slopes, facing.normals
    elements, m = functions.shape
    Q = facing.positions.shape[1]
    points = elements * Q
    found = Partners(
        np.empty(points, dtype=np.int64),
        np.empty(points, dtype=np.int64),
        np.empty(points),
        np.empty((2, points)),
        np.full(points, facing.far),
        np.empty((2, points)),
        np.empty((2, points)),
        np.zeros(points),
    )
    basis = np.empty((3, facing.segment_weights.shape[1]))
    point, outward, x, along = np.empty((3, 2)), np.empty(2), np.empty(2), np.empty(2)
    segment = 0
    for p in range(points):
        e, q = p // Q, p % Q
        along[0], along[1] = -rest[e, q, 1], rest[e, q, 0]
        for i in range(2):
            x[i] = facing.positions[e, q, i]
            for a in range(m):
                moved = u[functions[e, a], i]
                x[i] += values[e, q, a] * moved
                along[i] += slopes[e, q, a] * moved
            found.position[i, p] = x[i]
        kind, segment, s = closest_point(curve, x[0], x[1], segment, basis, point, outward)
        outward *= facing.orientation
        # the own outward normal is to the right of the own tangent
        if along[1] * outward[0] - along[0] * outward[1] > 0.0:
            kind = NONE
        r_x, r_y = x[0] - point[0, 0], x[1] - point[0, 1]
        gap = r_x * outward[0] + r_y * outward[1]
        if kind == CORNER:
            distance = np.hypot(r_x, r_y)
            gap = distance if gap >= 0.0 else -distance
            if distance > 0.0:
                outward[0], outward[1] = r_x / gap, r_y / gap
        found.kind[p], found.segment[p], found.place[p] = kind, segment, s
        for i in range(2):
            found.normal[i, p] = outward[i]
            found.tangent[i, p] = point[1, i]
            found.bend[p] += outward[i] * point[2, i]
        if kind != NONE:
            found.gap[p] = gap
    return found


@compiled_reordered
def respond_to(facing: FacingData, found: Partners, history: FloatArray) -> Response:
    """Evaluate the law between points and their partners, after a history (E Q,)."""
    law = law_at(facing.law)
    points = found.gap.size
    # two bodies whose law depended on the curvature of one of them would have no energy
    curvature = np.zeros(points)
    potential, T, dT, lost = np.empty(points), np.empty(points), np.empty(points), np.zeros(points)
    closed = np.empty((3, points if facing.irreversible else 0))
    if facing.irreversible:
        at = np.full(points, facing.equilibrium_gap)
        law(at, curvature, facing.parameters, points, closed[0], closed[1], closed[2])
    answer = potential, T, dT, lost
    parameters, equilibrium_gap = facing.parameters, facing.equilibrium_gap
    if facing.augmented:
        respond_with_multipliers(law, parameters, equilibrium_gap, history, found.gap, curvature, answer)
    else:
        respond_normally(
            law,
            parameters,
            equilibrium_gap,
            facing.irreversible,
            history,
            found.gap,
            curvature,
            closed,
            answer,
        )
    shear = np.zeros((3, points))
    return Response(found.position, found.gap, found.normal, curvature, potential, T, dT, lost, shear)


@inner_reordered
def _relative(
    numerators: FloatArray, denominator: FloatArray, basis: FloatArray, P: FloatArray, Q: FloatArray
) -> None:
    """Write -M_b and M_b' of the functions (m,) of a segment."""
    W, dW = 0.0, 0.0
    for k in range(denominator.size):
        W += denominator[k] * basis[0, k]
        dW += denominator[k] * basis[1, k]
    for b in range(P.size):
        value, slope = 0.0, 0.0
        for k in range(denominator.size):
            value += numerators[b, k] * basis[0, k]
            slope += numerators[b, k] * basis[1, k]
        value /= W
        P[b] = -value
        Q[b] = (slope - value * dW) / W


@inner_reordered
def _variations(
    n: FloatArray, a: FloatArray, gap: float, bend: float, P: FloatArray, R: FloatArray, d: FloatArray
) -> None:
    """Write the variations of a point's gap and partner, by the component i of function c at 2 c + i.

    The rows of d (4, 2 M) are dg, n . dy', ds and n . dy' + b ds, see `add_facing`.
    """
    slow = 1.0 / (a[0] ** 2 + a[1] ** 2 - gap * bend)
    for c in range(P.size):
        for i in range(2):
            d[0, 2 * c + i] = P[c] * n[i]
            d[1, 2 * c + i] = n[i] * R[c]
            d[2, 2 * c + i] = (a[i] * P[c] + gap * n[i] * R[c]) * slow
            d[3, 2 * c + i] = d[1, 2 * c + i] + bend * d[2, 2 * c + i]


@inner_reordered
def _second_variation(d: FloatArray, gap: float, bend: float, speed: float, second: FloatArray) -> None:
    """Write D dg to second (2 M, 2 M), by the variations d (4, 2 M); speed is y' . y'."""
    for r in range(second.shape[0]):
        slope, place, turn = d[1, r], d[2, r], d[3, r]
        for c in range(second.shape[1]):
            second[r, c] = gap / speed * turn * d[3, c] - slope * d[2, c] - place * (d[1, c] + bend * d[2, c])


@inner_reordered
def _second_variation_at_corner(n: FloatArray, gap: float, P: FloatArray, second: FloatArray) -> None:
    """Write D dg to second (2 M, 2 M) where the partner is a corner of the other side."""
    for c in range(P.size):
        for d in range(P.size):
            for i in range(2):
                for k in range(2):
                    across = (1.0 if i == k else 0.0) - n[i] * n[k]
                    second[2 * c + i, 2 * d + k] = P[c] * P[d] * across / gap


@inner_reordered
def _turned_forces(d: FloatArray, a: FloatArray, speed: float, P: FloatArray, second: FloatArray) -> None:
    """Write the derivatives P_c dn of the forces along a normal that turns, to second (2 M, 2 M)."""
    for c in range(P.size):
        for i in range(2):
            for e in range(second.shape[1]):
                second[2 * c + i, e] = -P[c] * a[i] * d[3, e] / speed


@inner
def _add_entries(local: FloatArray, numbers: IntArray, rows: int, band: FloatArray, diagonal: int) -> None:
    """Add the first rows of a local tangent (2 M, 2 M) of unknowns (2 M,) to a band, as far as it reaches."""
    flat, stride = band.ravel(), band.shape[1] - 1
    half_bandwidth = diagonal // 2 if diagonal > 0 else stride
    for r in range(rows):
        row = numbers[r]
        if row < 0:
            continue
        for c in range(numbers.size):
            column = numbers[c]
            if column < 0 or (diagonal == 0 and row < column) or abs(row - column) > half_bandwidth:
                continue
            flat[entry_place(stride, diagonal, row, column)] += local[r, c]


def add_facing(
    integers: IntArray,
    floats: FloatArray,
    history: FloatArray,
    _scalars: FloatArray,
    u: FloatArray,
    forces: FloatArray,
    band: FloatArray,
    diagonal: int,
    with_tangent: bool,
) -> Energies:
    """Add forces, tangent and energies of the law between each point and its partner, as reference areas.

    Of the integers and floats of a `FacingData`. With Phi(g) per area and T = -Phi':

        dg = n . (dx - dy),    (y'.y' - g b) ds = y' . (dx - dy) + g n . dy',    b = n . y''
        D dg = -n . dy' Ds - n . Dy' ds - b ds Ds + g/(y'.y') (n . dy' + b ds)(n . Dy' + b Ds)

    At a corner of the other side the partner does not move along it: D dg = (Dx - Dy) . (1 - n n) . (dx - dy)
    /g. If the force is not mutual, the other body feels nothing: forces are those of the whole area, and not
    derivatives of the energy, which is the mean of those of both passes.
    """
    facing: FacingData = read_facing(integers, floats)
    found = find_partners(facing, u)
    answer = respond_to(facing, found, history)
    T, dT = answer.traction, answer.derivative
    functions, values, weights = facing.functions, facing.values, facing.weights
    others, numerators = facing.segment_functions, facing.segment_values
    m, other_m = functions.shape[1], others.shape[1]
    Q = weights.shape[1]
    # functions that feel the force
    both = m + other_m if facing.mutual else m
    P, R = np.empty(m + other_m), np.zeros(m + other_m)
    of, numbers = np.empty(m + other_m, dtype=np.int64), np.empty(2 * (m + other_m), dtype=np.int64)
    d, second = np.empty((4, 2 * (m + other_m))), np.empty((2 * (m + other_m), 2 * (m + other_m)))
    basis, n, a = np.empty((3, numerators.shape[2])), np.empty(2), np.empty(2)
    energy = 0.0
    dissipated = 0.0
    for p in range(found.gap.size):
        e, q = p // Q, p % Q
        area = facing.share * weights[e, q]
        energy += area * answer.potential[p]
        dissipated += area * answer.dissipated[p]
        if not facing.mutual:
            # the other body has the force of its own pass
            area = weights[e, q]
        if found.kind[p] == NONE:
            continue
        segment = found.segment[p]
        bernstein(found.place[p], basis)
        _relative(numerators[segment], facing.segment_weights[segment], basis, P[m:], R[m:])
        for c in range(m):
            P[c], of[c] = values[e, q, c], functions[e, c]
        for b in range(other_m):
            of[m + b] = others[segment, b]
        for i in range(2):
            n[i], a[i] = found.normal[i, p], found.tangent[i, p]
        for c in range(both):
            for i in range(2):
                forces[of[c], i] -= area * T[p] * n[i] * P[c]
        if not with_tangent:
            continue
        for i in range(2):
            for c in range(m):
                numbers[2 * c + i] = facing.unknowns[e, c, i]
            for b in range(other_m):
                numbers[2 * (m + b) + i] = facing.segment_unknowns[segment, b, i]
        gap, bend, speed = found.gap[p], found.bend[p], a[0] ** 2 + a[1] ** 2
        _variations(n, a, gap, bend, P, R, d)
        if found.kind[p] == CORNER:
            _second_variation_at_corner(n, gap, P, second)
        elif facing.mutual:
            _second_variation(d, gap, bend, speed, second)
        else:
            _turned_forces(d, a, speed, P, second)
        for r in range(2 * both):
            for c in range(2 * (m + other_m)):
                second[r, c] = -area * (dT[p] * d[0, r] * d[0, c] + T[p] * second[r, c])
        _add_entries(second, numbers, 2 * both, band, diagonal)
    return 0.0, energy, dissipated, np.inf
