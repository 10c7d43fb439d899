"""Stability of an equilibrium under its constraints, and the critical motion."""

from typing import NamedTuple

import numpy as np

from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.matrix.band import BandMatrix
from isopeel.matrix.bordered import Border, Bordered
from isopeel.matrix.factor import Factor, NotPositiveDefiniteError, SingularError
from isopeel.matrix.factorize import factorize
from isopeel.matrix.ldl import BandLDL
from isopeel.matrix.mixed_precision import GOLDEN_RATIO

#: Inverse iterations for the critical motion: next to a bifurcation its eigenvalue is smaller than all others
#: by orders, and each iteration divides what others have left by as much.
_ITERATIONS = 6


class Stability(NamedTuple):
    """Number of negative eigenvalues of the constrained tangent, and its factor."""

    negative: int | None  # None without a potential
    factor: Factor


def stability(system: System, y: FloatArray, parameter: float) -> Stability | None:
    """Count the negative eigenvalues of K at an equilibrium y (count,) of forces with a potential.

    Returns None if the tangent is singular.
    """
    u, load = system.state(y, parameter)
    _, matrix = system.linearize(u, "symmetric", load)
    try:
        return inertia(system, matrix, u, parameter)
    except SingularError:
        return None


def inertia(system: System, matrix: BandMatrix, u: FloatArray, parameter: float) -> Stability:
    """Factorize a tangent at coefficients u (size, 2), and count its negative eigenvalues.

    By Sylvester's law of inertia. With an unknown load, the displacement along one direction c is prescribed:
    on the motions that do not change it, K has one negative eigenvalue less if c . K^-1 c < 0 (Haynsworth's
    additivity of the inertia, Linear Algebra Appl. 1, 1968). Raises SingularError.
    """
    negative, factor = _inertia(matrix)
    if not system.global_unknowns:
        return Stability(negative, factor)
    _, column, row = system.control.equation(u, parameter)
    bordered = Bordered.of(factor, Border(column, row))
    if negative is not None and float(row @ bordered.eliminated) < 0:
        negative -= 1  # the prescribed displacement holds this direction
    return Stability(negative, bordered)


def _inertia(matrix: BandMatrix) -> tuple[int | None, Factor]:
    """Return the number of negative eigenvalues and a factor, the faster Cholesky factor where it is zero."""
    try:
        return 0 if matrix.storage == "symmetric" else None, factorize(matrix)
    except NotPositiveDefiniteError:
        factor = BandLDL.of(matrix)
        return factor.negative, factor


def critical_motion(system: System, factor: Factor) -> FloatArray:
    """Return the eigenvector (count,) of the eigenvalue of least magnitude; largest displacement one."""
    n = system.constraints.count
    # fractional parts of multiples of the golden ratio: a start with a share of all eigenvectors
    motion: FloatArray = np.mod(np.arange(system.count) * GOLDEN_RATIO, 1.0) - 0.5
    for _ in range(_ITERATIONS):
        motion[n:] = 0.0  # the motion does not change the prescribed displacement of a load
        motion = factor.solve(motion)
        motion /= np.abs(motion[:n]).max()
    motion[n:] = 0.0
    return motion
