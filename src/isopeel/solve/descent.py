"""The descent of the energy to the next stable equilibrium, by a damped Newton method with a line search."""

from typing import NamedTuple

import numpy as np

from isopeel.assembly.sizes import extent
from isopeel.assembly.system import Equilibrium, System
from isopeel.common.arrays import FloatArray
from isopeel.common.interrupts import check
from isopeel.matrix.band import BandMatrix
from isopeel.matrix.bordered import Border, Bordered
from isopeel.matrix.factor import Factor, NotPositiveDefiniteError, SingularError
from isopeel.matrix.factorize import factorize

_MOST_ITERATIONS = 500
#: Share of the mean diagonal entry, which comes from stretching. The stiffness in bending is smaller by the
#: square of the slenderness, 1e-10 for a tape of 100 heights and some elements; a larger shift than that
#: makes the descent slow.
_SMALLEST_SHIFT = 1e-12
_LARGEST_SHIFT = 1e6
_SHORTEST = 2.0**-30  # of a step
_SUFFICIENT = 1e-4  # of the decrease that the slope promises
_ROUND_OFF = 1e-12  # of the displacement
_FLAT = 1e-13  # of the energy: a decrease below it is round-off
#: A body that moves by more than this multiple of its size, under a prescribed force, is taken to move away
#: for ever. A body that folds over moves by two of its sizes at most.
AWAY = 10.0


class Descent(NamedTuple):
    """The unknowns (count,) at which a descent ended, and why it ended there."""

    unknown_values: FloatArray
    line_search_failed: bool = False  # no step was short enough
    away: bool = False  # moved by many sizes of the body: the energy has no lower bound
    is_unfinished: bool = False  # not at rest after all iterations


def descend(system: System, start: FloatArray, parameter: float, most: int = _MOST_ITERATIONS) -> Descent:
    """Descend in energy from a start y (count,), at one value of the parameter, to near a minimum.

    Newton's method with a shifted tangent, K + shift x 1 where K is not positive definite, and steps halved
    until the energy decreases (Nocedal and Wright, Numerical Optimization, Algorithms 3.2 and 3.3). No
    element may be inverted at the start. Returns the best y after at `most` this number of iterations. It may
    not have converged; Newton's method is tried from there.
    """
    y = start
    shift = 0.0
    far = AWAY * extent(system.problem)
    begun, _ = system.state(start, parameter)
    energy = potential_energy(system, y, parameter)
    for _ in range(most):
        check()
        u, load = system.state(y, parameter)
        if np.abs(u - begun).max() > far:
            return Descent(y, away=True)
        equilibrium, matrix = system.linearize(u, "symmetric", load)
        try:
            held = 0.0
            if system.global_unknowns:
                # the prescribed displacement holds one direction, along which K may be soft or indefinite
                column = system.control.equation(u, parameter)[1]
                size = float(np.abs(matrix.entries[:, 0]).mean()) / float(column @ column)
                held = size if matrix.add_outer(column, size) else 0.0
            factor, shift = _positive_definite(matrix, shift)
            direction = -_solve(system, factor, equilibrium, u, parameter, held)
        except (NotPositiveDefiniteError, SingularError):
            # the forces are not finite: Newton's method reports this
            return Descent(y)
        slope = float(equilibrium.residual @ direction[: system.constraints.count])
        # an unknown load does work until its displacement is met: the energy need only be finite
        size = abs(parameter) + float(np.abs(u).max())
        astray = False
        if system.global_unknowns:
            astray = abs(system.control.equation(u, parameter)[0]) > _ROUND_OFF * size
        step = 1.0
        trial = potential_energy(system, y + direction, parameter)
        while not (np.isfinite(trial) if astray else trial <= energy + _SUFFICIENT * step * min(slope, 0.0)):
            step /= 2
            if step < _SHORTEST:
                return Descent(y, line_search_failed=True)
            trial = potential_energy(system, y + step * direction, parameter)
        if not (astray or trial < energy):
            break
        y = y + step * direction
        if shift == 0.0 and not astray and energy - trial < _FLAT * abs(energy):
            break
        energy = trial
        # try a smaller shift the next time
        shift = shift / 10 if shift > _SMALLEST_SHIFT else 0.0
    else:
        return Descent(y, is_unfinished=True)
    return Descent(y)


def potential_energy(system: System, y: FloatArray, parameter: float) -> float:
    """Return the energy of body, joint and a known load; infinite where an element is inverted."""
    u, load = system.state(y, parameter)
    at = system.equilibrium(u, load)
    energy, _ = system.potential(at, u, load, parameter)
    return energy if at.lowest_determinant > 0 and np.isfinite(energy) else np.inf


def _positive_definite(matrix: BandMatrix, shift: float) -> tuple[Factor, float]:
    """Return a factor of the matrix plus a shift that makes it positive definite, and that shift.

    The given shift is increased as often as necessary. Raises NotPositiveDefiniteError.
    """
    diagonal = matrix.entries[:, 0].copy()
    mean = float(np.abs(diagonal).mean())
    while True:
        matrix.entries[:, 0] = diagonal + shift * mean
        try:
            return factorize(matrix), shift
        except NotPositiveDefiniteError:
            shift = max(4 * shift, _SMALLEST_SHIFT)
            if shift > _LARGEST_SHIFT:
                raise


def _solve(
    system: System, factor: Factor, equilibrium: Equilibrium, u: FloatArray, parameter: float, held: float
) -> FloatArray:
    """Return the correction, by a factor of K + `held` times the outer product of the load column."""
    if not system.global_unknowns:
        return factor.solve(equilibrium.residual)
    missed, column, row = system.control.equation(u, parameter)
    right_side = np.append(equilibrium.residual + held * missed * column, missed)
    return Bordered.of(factor, Border(column, row)).solve(right_side)
