"""Plain Newton along the path, started from the parabola through the last three states."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from scipy.sparse import csr_matrix

from scikit_fem_strip.problem import FloatArray
from scikit_fem_strip.strip import Strip

#: From a displacement (2, nodes) to the residual (unknowns,) and the exact tangent, as the solver stores it.
Assembly: TypeAlias = Callable[[FloatArray], tuple[FloatArray, csr_matrix]]
#: From a tangent and a right-hand side to the solution (unknowns,).
Solver: TypeAlias = Callable[[csr_matrix, FloatArray], FloatArray]

#: Newton stops after the update du with |R . du| / (number of unknowns) below this, in E0 nm^3.
ENERGY_TOLERANCE = 2e-17
MOST_ITERATIONS = 25


@dataclass(frozen=True)
class LoadStep:
    """A converged equilibrium: the turn of the face, the moment that holds it, the linear solves it took."""

    theta: float
    moment: float
    iterations: int


def trace(strip: Strip, assembly: Assembly, solver: Solver, angles: Iterable[float]) -> Iterator[LoadStep]:
    """Yield the equilibrium at each angle (radians), from the unstressed strip on.

    Raises ArithmeticError where Newton finds none."""
    history: deque[tuple[float, FloatArray]] = deque(maxlen=3)
    for theta in angles:
        state = _extrapolate(history, theta, strip.unknowns + 1)
        iterations = _solve(strip, assembly, solver, state, theta)
        history.append((theta, state))
        yield LoadStep(theta, strip.moment(strip.displacement(state, theta), theta), iterations)


def _solve(strip: Strip, assembly: Assembly, solver: Solver, state: FloatArray, theta: float) -> int:
    """Bring a state to equilibrium, in place; return the number of iterations."""
    for iteration in range(1, MOST_ITERATIONS + 1):
        residual, tangent = assembly(strip.displacement(state, theta))
        update = solver(tangent, -residual)
        state[:-1] += update
        if abs(residual @ update) < ENERGY_TOLERANCE * strip.unknowns:
            return iteration
    raise ArithmeticError(
        f"no equilibrium at {np.rad2deg(theta):g} degrees after {MOST_ITERATIONS} iterations"
    )


def _extrapolate(history: Iterable[tuple[float, FloatArray]], theta: float, size: int) -> FloatArray:
    """Return the Lagrange polynomial through the converged states at theta; zeros without a state."""
    known = list(history)
    result = np.zeros(size)
    for angle, state in known:
        others = np.array([other for other, _ in known if other != angle])
        result += np.prod((theta - others) / (angle - others)) * state
    return result
