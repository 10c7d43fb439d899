"""Compiled loops over a side that is joined to fixed points of another body: forces, energies and tangents.

Index names: c, d functions of a pair: those of the point's own element, and those of its partner's; i, k
components; p pairs. The distance r = x - y of a pair changes by dr = sum_c V_c du_c, and the sum s of both
tangents by ds = sum_c S_c du_c.
"""

from typing import NamedTuple

import numpy as np

from isopeel.assembly.loops import Energies
from isopeel.assembly.packing import Floats1, Floats2, Floats3, Integers2, Integers3, Integers4, reader
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import compiled_reordered
from isopeel.matrix.band import entry_place
from isopeel.physics.batch import joint_at


class PairData(NamedTuple):
    """The data of the loops over E elements, of Q points each, and the partners of the points."""

    law: int  # address
    parameters: Floats1
    variables: int  # of the history
    functions: Integers2  # (E, m) of the elements of the points
    other_functions: Integers3  # (E, Q, n) of the elements of the partners
    values: Floats3  # (E, Q, m + n) V
    slopes: Floats3  # (E, Q, m + n) S, by the reference lengths along the side of the points
    weights: Floats2  # (E, Q) reference length of each point; zero without a partner
    distances: Floats3  # (E, Q, 2) r of the undeformed bodies
    tangents: Floats3  # (E, Q, 2) s of the undeformed bodies
    initial: Floats3  # (E, Q, 2) r . n and r . t where the faces were joined
    unknowns: Integers3  # (E, m, 2)
    other_unknowns: Integers4  # (E, Q, n, 2)


read_pairs = reader(PairData)


class Jumps(NamedTuple):
    """The pairs (n) in their present position, in the order of the elements."""

    along: FloatArray  # unit tangent t (2, n)
    stretch: FloatArray  # length of s
    distance: FloatArray  # r . n and r . t (2, n)
    jump: FloatArray  # d_n and d_t (2, n)


class JointResponse(NamedTuple):
    """What the law returns at the pairs, see `isopeel.physics.batch.JointValues`."""

    energies: FloatArray
    slopes: FloatArray
    stiffness: FloatArray
    history: FloatArray


@compiled_reordered
def find_jumps(pairs: PairData, u: FloatArray) -> Jumps:
    """Return the jumps of all pairs, at coefficients u (size, 2).

    The mean direction t of both tangents and the normal n to its left turn with the faces.
    """
    elements, m = pairs.functions.shape
    Q, n = pairs.other_functions.shape[1:]
    points = elements * Q
    found = Jumps(np.empty((2, points)), np.empty(points), np.empty((2, points)), np.empty((2, points)))
    r, s = np.empty(2), np.empty(2)
    for e in range(elements):
        for q in range(Q):
            p = e * Q + q
            for i in range(2):
                r[i], s[i] = pairs.distances[e, q, i], pairs.tangents[e, q, i]
                for c in range(m + n):
                    f = pairs.functions[e, c] if c < m else pairs.other_functions[e, q, c - m]
                    r[i] += pairs.values[e, q, c] * u[f, i]
                    s[i] += pairs.slopes[e, q, c] * u[f, i]
            size = np.hypot(s[0], s[1])
            t_x, t_y = s[0] / size, s[1] / size
            found.along[0, p], found.along[1, p], found.stretch[p] = t_x, t_y, size
            found.distance[0, p] = r[1] * t_x - r[0] * t_y
            found.distance[1, p] = r[0] * t_x + r[1] * t_y
            for i in range(2):
                found.jump[i, p] = found.distance[i, p] - pairs.initial[e, q, i]
    return found


@compiled_reordered
def respond_to_jumps(pairs: PairData, jump: FloatArray, history: FloatArray) -> JointResponse:
    """Evaluate the law at jumps (2, n) after a history (variables n,)."""
    law, points, variables = joint_at(pairs.law), jump.shape[1], pairs.variables
    # compiled laws take arrays that could be written to
    before = history.copy().reshape((variables, points))
    found = JointResponse(
        np.empty((2, points)), np.empty((2, points)), np.empty((3, points)), np.empty((variables, points))
    )
    law(jump, before, pairs.parameters, points, found.energies, found.slopes, found.stiffness, found.history)
    return found


def add_pairs(
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
    """Add forces, tangent and energies of a joint law between each point and its partner.

    Of the integers and floats of a `PairData`. With t = s/|s|, n to its left, alpha = n . ds/|s| and
    beta = t . ds/|s|, and the same with D for another variation:

        d d_n = n . dr - (r . t) alpha,    d d_t = t . dr + (r . n) alpha
        D d d_n = -Alpha t . dr - alpha t . Dr - (r . n) alpha Alpha + (r . t) (Alpha beta + alpha Beta)
        D d d_t = Alpha n . dr + alpha n . Dr - (r . t) alpha Alpha - (r . n) (Alpha beta + alpha Beta)
    """
    pairs: PairData = read_pairs(integers, floats)
    found = find_jumps(pairs, u)
    answer = respond_to_jumps(pairs, found.jump, history)
    elements, m = pairs.functions.shape
    Q, n = pairs.other_functions.shape[1:]
    both = m + n
    flat, stride = band.ravel(), band.shape[1] - 1
    of, numbers = np.empty(both, dtype=np.int64), np.empty((both, 2), dtype=np.int64)
    d_n, d_t = np.empty((both, 2)), np.empty((both, 2))
    dr_n, dr_t = np.empty((both, 2)), np.empty((both, 2))
    alpha, beta = np.empty((both, 2)), np.empty((both, 2))
    normal, along = np.empty(2), np.empty(2)
    stored, dissipated = 0.0, 0.0
    for e in range(elements):
        for c in range(m):
            of[c] = pairs.functions[e, c]
            numbers[c, 0], numbers[c, 1] = pairs.unknowns[e, c, 0], pairs.unknowns[e, c, 1]
        for q in range(Q):
            p = e * Q + q
            area = pairs.weights[e, q]
            if area == 0.0:
                continue
            stored += area * answer.energies[0, p]
            dissipated += area * answer.energies[1, p]
            for c in range(n):
                of[m + c] = pairs.other_functions[e, q, c]
                for i in range(2):
                    numbers[m + c, i] = pairs.other_unknowns[e, q, c, i]
            along[0], along[1] = found.along[0, p], found.along[1, p]
            normal[0], normal[1] = -along[1], along[0]
            r_n, r_t = found.distance[0, p], found.distance[1, p]
            E_n, E_t = area * answer.slopes[0, p], area * answer.slopes[1, p]
            for c in range(both):
                V, S = pairs.values[e, q, c], pairs.slopes[e, q, c] / found.stretch[p]
                for i in range(2):
                    dr_n[c, i], dr_t[c, i] = normal[i] * V, along[i] * V
                    alpha[c, i], beta[c, i] = normal[i] * S, along[i] * S
                    d_n[c, i] = dr_n[c, i] - r_t * alpha[c, i]
                    d_t[c, i] = dr_t[c, i] + r_n * alpha[c, i]
                    forces[of[c], i] += E_n * d_n[c, i] + E_t * d_t[c, i]
            if not with_tangent:
                continue
            E_nn, E_nt, E_tt = (
                area * answer.stiffness[0, p],
                area * answer.stiffness[1, p],
                area * answer.stiffness[2, p],
            )
            # of alpha Alpha, and of Alpha beta + alpha Beta
            turn, shear = -(E_n * r_n + E_t * r_t), E_n * r_t - E_t * r_n
            for c in range(both):
                for i in range(2):
                    row = numbers[c, i]
                    if row < 0:
                        continue
                    # what multiplies D d_n, D d_t, Dr . n, Dr . t, Alpha and Beta
                    by_n = E_nn * d_n[c, i] + E_nt * d_t[c, i]
                    by_t = E_nt * d_n[c, i] + E_tt * d_t[c, i]
                    by_dr_n, by_dr_t = E_t * alpha[c, i], -E_n * alpha[c, i]
                    by_alpha = E_t * dr_n[c, i] - E_n * dr_t[c, i] + turn * alpha[c, i] + shear * beta[c, i]
                    by_beta = shear * alpha[c, i]
                    for d in range(both):
                        for k in range(2):
                            column = numbers[d, k]
                            if column < 0 or (diagonal == 0 and row < column):
                                continue
                            flat[entry_place(stride, diagonal, row, column)] += (
                                by_n * d_n[d, k]
                                + by_t * d_t[d, k]
                                + by_dr_n * dr_n[d, k]
                                + by_dr_t * dr_t[d, k]
                                + by_alpha * alpha[d, k]
                                + by_beta * beta[d, k]
                            )
    return 0.0, stored, dissipated, np.inf
