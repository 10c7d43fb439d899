"""Stability of an equilibrium under what is held, and the motion that it is lost by."""

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
    """Negative eigenvalues of the tangent under what is held, and its factor."""

    negative: int
    factor: Factor


def stability(system: System, y: FloatArray, parameter: float) -> Stability | None:
    """Count the motions that lower the energy, at an equilibrium y (count,) of forces with a potential.

    By Sylvester's law of inertia. A load whose size is unknown holds one direction c: of K on what keeps its
    displacement there is one negative eigenvalue less where c . K^-1 c < 0 (Haynsworth's additivity of the
    inertia, Linear Algebra Appl. 1, 1968). None where the factor does not tell.
    """
    u, load = system.state(y, parameter)
    _, matrix = system.linearize(u, "symmetric", load)
    try:
        negative, factor = _inertia(matrix)
        if not system.load_is_unknown:
            return Stability(negative, factor)
        _, column, row = system.control(u, parameter)
        bordered = Bordered.of(factor, Border(column, row))
    except SingularError:
        return None
    return Stability(negative - (float(row @ bordered.eliminated) < 0), bordered)


def _inertia(matrix: BandMatrix) -> tuple[int, Factor]:
    """Negative eigenvalues and a factor: Cholesky's, which is the faster one, where there are none."""
    try:
        return 0, factorize(matrix)
    except NotPositiveDefiniteError:
        factor = BandLDL.of(matrix)
        return factor.negative, factor


def critical_motion(system: System, factor: Factor) -> FloatArray:
    """The motion (count,) of the least eigenvalue by magnitude, largest entry of the displacement one."""
    n = system.constraints.count
    # multiples of the golden ratio, less what is whole of them: it has a share of all motions
    motion: FloatArray = np.mod(np.arange(system.count) * GOLDEN_RATIO, 1.0) - 0.5
    for _ in range(_ITERATIONS):
        motion[n:] = 0.0  # the control of a load is kept
        motion = factor.solve(motion)
        motion /= np.abs(motion[:n]).max()
    motion[n:] = 0.0
    return motion
