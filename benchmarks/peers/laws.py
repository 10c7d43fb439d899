"""The data and laws of the strip, written independently of isopeel.

Lengths in nm, stresses in units of Young's modulus E0 = 2 GPa, moments in E0 nm^3 for a width of 1 nm.
"""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int64]

LENGTH, HEIGHT, ADHERING_LENGTH = 200.0, 10.0, 150.0
POISSON_RATIO = 0.2
LAME_LAMBDA = POISSON_RATIO / ((1 + POISSON_RATIO) * (1 - 2 * POISSON_RATIO))
SHEAR_MODULUS = 1 / (2 * (1 + POISSON_RATIO))
HAMAKER, INTERACTION_DISTANCE = 0.05, 0.4
EQUILIBRIUM_GAP = INTERACTION_DISTANCE / 15 ** (1 / 6)
TRACTION_SCALE = HAMAKER / (2 * np.pi * INTERACTION_DISTANCE**3)
#: T' at the equilibrium gap, where T is zero.
EQUILIBRIUM_STIFFNESS = -2 * 15 ** (2 / 3) * TRACTION_SCALE / INTERACTION_DISTANCE


def invert(F: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return F^-1 (2, 2, ...) and the factor lambda ln J - mu (...) of a deformation gradient (2, 2, ...)."""
    J = F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0]
    if not J.min() > 0:
        raise ArithmeticError("an element is inverted")
    inverse = np.array([[F[1, 1], -F[0, 1]], [-F[1, 0], F[0, 0]]]) / J
    return inverse, LAME_LAMBDA * np.log(J) - SHEAR_MODULUS


def stress(F: FloatArray, inverse: FloatArray, factor: FloatArray) -> FloatArray:
    """Return P (2, 2, ...) = mu F + (lambda ln J - mu) F^-T, the neo-Hooke law."""
    P: FloatArray = SHEAR_MODULUS * F + factor * inverse.swapaxes(0, 1)
    return P


def moduli(i: int, k: int, inverse: FloatArray, factor: FloatArray) -> FloatArray:
    """Return dP_iJ/dF_kL (2, 2, ...), J and L along the axes.

    It is mu d_ik d_JL - factor G_Jk G_Li + lambda G_Ji G_Lk with G = F^-1.
    """
    straight, crossed = (
        inverse[:, None, first] * inverse[None, :, second] for first, second in ((i, k), (k, i))
    )
    block: FloatArray = LAME_LAMBDA * straight - factor * crossed
    if i == k:
        block[0, 0] += SHEAR_MODULUS
        block[1, 1] += SHEAR_MODULUS
    return block


def adhesion(gap: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return T and T' of the van der Waals law of a flat surface, continued linearly below equilibrium."""
    gap_used = np.maximum(gap, EQUILIBRIUM_GAP)
    ratio = INTERACTION_DISTANCE / gap_used
    cube = ratio**3
    stiffness = TRACTION_SCALE / INTERACTION_DISTANCE * ratio * cube * (1 - cube**2 / 5)
    return attraction(gap_used) + stiffness * (gap - gap_used), stiffness


def attraction(gap: Any) -> Any:
    """Return T beyond the equilibrium gap, for numbers or for the symbols of a library."""
    cube = (INTERACTION_DISTANCE / gap) ** 3
    return TRACTION_SCALE * cube * (cube**2 / 45 - 1 / 3)
