"""The jump to the next stable equilibrium: a damped search along which the energy falls."""

from typing import NamedTuple

import numpy as np

from isopeel.assembly.start import extent
from isopeel.assembly.system import Equilibrium, System
from isopeel.common.arrays import FloatArray
from isopeel.common.interrupts import check
from isopeel.matrix.band import BandMatrix
from isopeel.matrix.bordered import Border, Bordered
from isopeel.matrix.factor import Factor, NotPositiveDefiniteError, SingularError
from isopeel.matrix.factorize import factorize

_MOST_ITERATIONS = 500
#: Of the mean entry on the diagonal, which is of stretching. That of bending is less by the square of the
#: slenderness, at 1e-10 for a tape of 100 heights and some elements: a shift that is more lets it creep.
_SMALLEST_SHIFT = 1e-12
_LARGEST_SHIFT = 1e6
_SHORTEST = 2.0**-30  # of a step
_SUFFICIENT = 1e-4  # of the decrease that the slope promises
_ROUND_OFF = 1e-12  # of the displacement
_FLAT = 1e-13  # of the energy: a decrease below it is round-off
#: Sizes of the body: what has moved by more, under a force that is raised, flies away. A body that folds over
#: moves by two of its sizes at most.
_AWAY = 10.0


class Descent(NamedTuple):
    """Where a search ended, y (count,), and whether it did so because no step was short enough."""

    unknown_values: FloatArray
    line_search_failed: bool = False
    away: bool = False  # by many sizes of the body: the energy has no lower bound
    is_unfinished: bool = False  # not at rest after all iterations


def descend(system: System, start: FloatArray, parameter: float, most: int = _MOST_ITERATIONS) -> Descent:
    """Follow falling energy from a start y (count,), at one value of the parameter, to near a minimum.

    Newton's method with a shifted tangent, K + shift x 1 where K is not positive definite, and steps halved
    until the energy falls (Nocedal and Wright, Numerical Optimization, Algorithms 3.2 and 3.3). The start
    must keep every element from being turned inside out. Returns the best y after at `most` so many
    iterations, which may not have converged: Newton's method from there tells.
    """
    y = start
    shift = 0.0
    far = _AWAY * extent(system.problem)
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
            if system.load_is_unknown:
                # the control holds one direction, along which the tangent alone may be soft or falling
                column = system.control(u, parameter)[1]
                size = float(np.abs(matrix.entries[:, 0]).mean()) / float(column @ column)
                held = size if matrix.add_outer(column, size) else 0.0
            factor, shift = _positive_definite(matrix, shift)
            direction = -_solve(system, factor, equilibrium, u, parameter, held)
        except (NotPositiveDefiniteError, SingularError):
            # forces that are not finite, which Newton's method will tell of
            return Descent(y)
        slope = float(equilibrium.residual @ direction[: system.constraints.count])
        # the control of a load does work: before it is satisfied, energy need not fall, but be finite
        size = abs(parameter) + float(np.abs(u).max())
        astray = system.load_is_unknown and abs(system.control(u, parameter)[0]) > _ROUND_OFF * size
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
        # try to do with less the next time
        shift = shift / 10 if shift > _SMALLEST_SHIFT else 0.0
    else:
        return Descent(y, is_unfinished=True)
    return Descent(y)


def potential_energy(system: System, y: FloatArray, parameter: float) -> float:
    """Energy of body, joint and a known load; infinite where an element is turned inside out."""
    u, load = system.state(y, parameter)
    at = system.equilibrium(u, load)
    energy, _ = system.potential(at, u, load, parameter)
    return energy if at.lowest_determinant > 0 and np.isfinite(energy) else np.inf


def _positive_definite(matrix: BandMatrix, shift: float) -> tuple[Factor, float]:
    """Factorize the matrix with the least shift, from a first guess on, that makes it positive definite."""
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
    """The correction by a factor of the tangent, with `held` times the control's outer product in it."""
    if not system.load_is_unknown:
        return factor.solve(equilibrium.residual)
    missed, column, row = system.control(u, parameter)
    right_side = np.append(equilibrium.residual + held * missed * column, missed)
    return Bordered.of(factor, Border(column, row)).solve(right_side)
