"""Plain Newton along the path, started from the parabola through the last three states."""

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from time import perf_counter
from typing import Any, Protocol

import numpy as np

from peers.laws import FloatArray

#: Newton stops after the update du with |R . du| / (number of unknowns) below this, in E0 nm^3.
ENERGY_TOLERANCE = 2e-17
MOST_ITERATIONS = 25


class Strip(Protocol):
    """The strip in a library: what Newton's method asks for.

    A state holds the `unknowns`, then a zero for what is fixed; a displacement is what the library likes."""

    unknowns: int

    def displacement(self, state: FloatArray, theta: float) -> FloatArray:
        """Return the displacement of a state (unknowns + 1,) whose face is turned by theta."""

    def assemble(self, u: FloatArray) -> tuple[FloatArray, Any]:
        """Return the residual (unknowns,) and the exact tangent, as `solve` takes it."""

    def solve(self, tangent: Any, right_hand_side: FloatArray) -> FloatArray:
        """Factorize a tangent and solve."""

    def moment(self, u: FloatArray, theta: float) -> float:
        """Return dE/dtheta: the work of the stresses as the face turns."""


@dataclass(frozen=True)
class LoadStep:
    """A converged equilibrium: the moment that holds it, and what it took.

    Seconds of assembly and solution are None where a program doesn't tell them."""

    moment: float
    iterations: int
    seconds: float
    assembly: float | None = None
    solution: float | None = None


def trace(strip: Strip, angles: Iterable[float]) -> Iterator[LoadStep]:
    """Yield the equilibrium at each angle (radians), from the unstressed strip on.

    Raises ArithmeticError where Newton finds none, with the reason."""
    history: deque[tuple[float, FloatArray]] = deque(maxlen=3)
    for theta in angles:
        began = perf_counter()
        state = _extrapolate(history, theta, strip.unknowns + 1)
        iterations, assembly, solution = _solve(strip, state, theta)
        history.append((theta, state))
        moment = strip.moment(strip.displacement(state, theta), theta)
        yield LoadStep(moment, iterations, perf_counter() - began, assembly, solution)


def _solve(strip: Strip, state: FloatArray, theta: float) -> tuple[int, float, float]:
    """Bring a state to equilibrium, in place; return the iterations, and seconds to assemble and to solve."""
    assembly = solution = 0.0
    for iteration in range(1, MOST_ITERATIONS + 1):
        began = perf_counter()
        residual, tangent = strip.assemble(strip.displacement(state, theta))
        assembled = perf_counter()
        if not np.isfinite(residual).all():
            raise ArithmeticError("the forces are not finite")
        update = strip.solve(tangent, -residual)
        solution += perf_counter() - assembled
        assembly += assembled - began
        state[:-1] += update
        if abs(residual @ update) < ENERGY_TOLERANCE * strip.unknowns:
            return iteration, assembly, solution
    raise ArithmeticError(f"none after {MOST_ITERATIONS} iterations")


def _extrapolate(history: Iterable[tuple[float, FloatArray]], theta: float, size: int) -> FloatArray:
    """Return the Lagrange polynomial through the converged states at theta; zeros without a state."""
    known = list(history)
    result = np.zeros(size)
    for angle, state in known:
        others = np.array([other for other, _ in known if other != angle])
        result += np.prod((theta - others) / (angle - others)) * state
    return result
