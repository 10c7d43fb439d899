"""Energy, stress and tangent in three dimensions, from a stored energy psi(I1, I2, J).

The invariants are those of C = F^T F, I1 = tr C and I2 = ((tr C)^2 - tr C^2)/2, and J = det F.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.physics.differentiation import Jet, Scalar
from isopeel.physics.points import argument_names

INVARIANTS = ("I1", "I2", "J")
_ONE = np.eye(3)
#: The permutation symbol.
_E = np.array([[[(i - j) * (j - k) * (k - i) / 2 for k in range(3)] for j in range(3)] for i in range(3)])


def at_invariants(
    stored_energy: Callable[..., Any], I1: Jet, I2: Jet, J: Jet, constants: Sequence[Scalar]
) -> Jet:
    """Return an energy and its derivatives. It has those of the invariants that its arguments name."""
    values = {"I1": I1, "I2": I2, "J": J}
    named = [values[name] for name in argument_names(stored_energy) if name in values]
    psi = stored_energy(*named, *constants)
    return psi if isinstance(psi, Jet) else Jet(psi)


@np.errstate(all="ignore")  # nan and inf where the energy does not exist
def solid_response(
    stored_energy: Callable[..., Any], constants: FloatArray, F: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return psi (...), P = dpsi/dF (..., 3, 3) and dP/dF (..., 3, 3, 3, 3) at F (..., 3, 3).

    They are nan where J <= 0, unless the energy is independent of J.
    """
    right, left = np.swapaxes(F, -1, -2) @ F, F @ np.swapaxes(F, -1, -2)
    I1 = np.trace(right, axis1=-2, axis2=-1)
    second_J = np.einsum("ikm,JLN,...mN->...iJkL", _E, _E, F)
    cofactors = np.einsum("...iJkL,...kL->...iJ", second_J, F) / 2
    I2, J = np.square(cofactors).sum(axis=(-2, -1)), (cofactors * F).sum(axis=(-2, -1)) / 3
    second_I1 = 2 * np.einsum("ik,JL->iJkL", _ONE, _ONE)
    second_I2 = 4 * _outer(F, F) - 2 * np.einsum("...iL,...kJ->...iJkL", F, F) + _spread(I1, 4) * second_I1
    second_I2 -= 2 * np.einsum("ik,...JL->...iJkL", _ONE, right)
    second_I2 -= 2 * np.einsum("...ik,JL->...iJkL", left, _ONE)
    first = 2 * F, 2 * (_spread(I1, 2) * F - F @ right), cofactors
    second = second_I1, second_I2, second_J
    jets = Jet(I1, {0: 1.0}), Jet(I2, {1: 1.0}), Jet(np.where(J > 0, J, np.nan), {2: 1.0})
    psi = at_invariants(stored_energy, *jets, [float(constant) for constant in constants])
    P, A = np.zeros(F.shape), np.zeros((*F.shape, 3, 3))
    for i, slope in psi.first.items():
        P += _spread(slope, 2) * first[i]
        A += _spread(slope, 4) * second[i]
    for (i, j), curvature in psi.second.items():
        both = _outer(first[i], first[j])
        A += _spread(curvature, 4) * (both if i == j else both + _outer(first[j], first[i]))
    energy: FloatArray = psi.value
    return energy, P, A


@np.errstate(all="ignore")
def out_of_plane_stress(
    stored_energy: Callable[..., Any], constants: FloatArray, F: FloatArray
) -> FloatArray:
    """Return Cauchy's sigma_33 = (1/J) dpsi/dF_33 (...) at F_33 = 1, for F (..., 2, 2) of the plane."""
    q, det = np.square(F).sum(axis=(-2, -1)), np.linalg.det(F)
    stretch = Jet(1.0, {0: 1.0})
    square = stretch * stretch
    jets = square + q, square * q + det * det, stretch * det
    psi = at_invariants(stored_energy, *jets, [float(constant) for constant in constants])
    stress: FloatArray = psi.first[0] / det
    return stress


def lame_constants(stored_energy: Callable[..., Any], constants: FloatArray) -> tuple[float, float]:
    """Return the shear modulus mu and lambda at F = 1, dP_12/dF_12 and dP_11/dF_22."""
    _, _, tangent = solid_response(stored_energy, constants, _ONE)
    return float(tangent[0, 1, 0, 1]), float(tangent[0, 0, 1, 1])


def _outer(one: FloatArray, other: FloatArray) -> FloatArray:
    product: FloatArray = np.einsum("...iJ,...kL->...iJkL", one, other)
    return product


def _spread(values: Scalar, axes: int) -> FloatArray:
    """Numbers (...) with so many axes of length 1 more."""
    return np.reshape(values, (*np.shape(values), *(1,) * axes))
