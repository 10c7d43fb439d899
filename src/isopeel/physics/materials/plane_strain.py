"""The plane-strain kernel of a material, from its stored energy in three dimensions.

F_33 = 1 makes the energy a function of q = F_iJ F_iJ, over the plane, and of J, as I1 = q + 1 and
I2 = q + J^2. With the cofactors C = dJ/dF the stress is P = a F + p C, and the tangent

    dP_iJ/dF_kL = a d_ik d_JL + p dC_iJ/dF_kL + F_iJ H_kL + C_iJ D_kL

    a = 2 dpsi/dq,    H = da/dF = 2 da/dq F + da/dJ C,
    p = dpsi/dJ,      D = dp/dF = da/dJ F + dp/dJ C.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.compilation import inner
from isopeel.physics.batch import MATERIAL_SIGNATURE, BatchFunction
from isopeel.physics.differentiation import FUNCTIONS, Jet, Term
from isopeel.physics.logarithm import log
from isopeel.physics.materials.invariants import INVARIANTS, at_invariants
from isopeel.physics.points import compile_text, constant_names

_HEAD = """\
def batch(F, parameters, count, energy, P, A, tangent):
    a, p = np.empty(count), np.empty(count)
    a_q, a_J, p_J = np.empty(count), np.empty(count), np.empty(count)
"""
_LOOP = """\
    for n in range(count):
        det = F[0, 0, n] * F[1, 1, n] - F[0, 1, n] * F[1, 0, n]
        q = F[0, 0, n] ** 2 + F[0, 1, n] ** 2 + F[1, 0, n] ** 2 + F[1, 1, n] ** 2
        I1, I2 = q + 1.0, q + det * det
        # an inverted point has no energy: the solver detects the nan, and searches for the point
        J = det if det > 0.0 else np.nan
"""
_TAIL = """\
    stress_and_tangent(F, count, a, p, a_q, a_J, p_J, P, A, tangent)
"""


@cache
def plane_strain_kernel(stored_energy: Callable[..., Any]) -> BatchFunction:
    """Return the batch function of `MATERIAL_SIGNATURE` of an energy, see `Isotropic`."""
    names = {name: getattr(np, name) for name in FUNCTIONS}
    names |= {"np": np, "log": log, "stress_and_tangent": _stress_and_tangent}
    return compile_text(MATERIAL_SIGNATURE, _text(stored_energy), names, stored_energy)


def _text(stored_energy: Callable[..., Any]) -> str:
    """The source of the batch function, in which the lines of the energy and its derivatives are one loop."""
    lines: dict[str, str] = {}
    constants = [Term(f"c{k}", lines) for k in range(len(constant_names(stored_energy, INVARIANTS)))]
    det, I1, I2, J = (Term(name, lines) for name in ("det", "I1", "I2", "J"))
    # derivatives by q are those of index 0, by J of index 1
    psi = at_invariants(
        stored_energy,
        Jet(I1, {0: 1.0}),
        Jet(I2, {0: 1.0, 1: 2.0 * det}, {(1, 1): 2.0}),
        Jet(J, {1: 1.0}),
        constants,
    )
    results = {
        "energy": psi.value,
        "a": 2.0 * psi.first.get(0, 0.0),
        "p": psi.first.get(1, 0.0),
        # twice da/dq
        "a_q": 4.0 * psi.second.get((0, 0), 0.0),
        "a_J": 2.0 * psi.second.get((0, 1), 0.0),
        "p_J": psi.second.get((1, 1), 0.0),
    }
    # constants are read before the loop: what it writes might overlap with the parameters
    text = _HEAD + "".join(f"    {name} = parameters[{k}]\n" for k, name in enumerate(constants)) + _LOOP
    text += "".join(f"        {name} = {expression}\n" for expression, name in lines.items())
    return text + "".join(f"        {name}[n] = {value!r}\n" for name, value in results.items()) + _TAIL


@inner
def _stress_and_tangent(
    F: FloatArray,
    count: int,
    a: FloatArray,
    p: FloatArray,
    a_q: FloatArray,
    a_J: FloatArray,
    p_J: FloatArray,
    P: FloatArray,
    A: FloatArray,
    tangent: bool,
) -> None:
    # loops over few arrays each, or they would not be compiled to SIMD instructions; see `neo_hooke`
    for i in range(2):
        for K in range(2):
            sign = 1.0 if i == K else -1.0
            for n in range(count):
                P[i, K, n] = a[n] * F[i, K, n] + sign * p[n] * F[1 - i, 1 - K, n]
    if not tangent:
        return
    H = np.empty(count)
    D = np.empty(count)
    for one in range(4):
        i, K = one // 2, one % 2
        sign = 1.0 if i == K else -1.0
        for n in range(count):
            H[n] = a_q[n] * F[i, K, n] + sign * a_J[n] * F[1 - i, 1 - K, n]
        for n in range(count):
            D[n] = a_J[n] * F[i, K, n] + sign * p_J[n] * F[1 - i, 1 - K, n]
        for other in range(one + 1):
            k, L = other // 2, other % 2
            sign = 1.0 if k == L else -1.0
            start, factor = (a, 1.0) if one == other else (p, sign if one + other == 3 else 0.0)
            for n in range(count):
                A[i, K, k, L, n] = factor * start[n] + F[k, L, n] * H[n] + sign * F[1 - k, 1 - L, n] * D[n]
            if one > other:
                for n in range(count):
                    A[k, L, i, K, n] = A[i, K, k, L, n]
