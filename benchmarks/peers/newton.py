"""Plain Newton's method along the path, from the parabola through the last three states."""

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from time import perf_counter, process_time
from typing import Any, Protocol

import numpy as np

from peers.laws import FloatArray

#: Newton stops after the update du with |R . du| / (number of unknowns) below this, in E0 nm^3.
ENERGY_TOLERANCE = 2e-17
MOST_ITERATIONS = 25


class Strip(Protocol):
    """The strip in a library, with the interface that Newton's method needs.

    A state has the `unknowns`, then a zero for fixed degrees of freedom; a displacement is of any type."""

    unknowns: int

    def displacement(self, state: FloatArray, theta: float) -> FloatArray:
        """Return the displacement of a state (unknowns + 1,) whose face is rotated by theta."""

    def assemble(self, u: FloatArray) -> tuple[FloatArray, Any]:
        """Return the residual (unknowns,) and the exact tangent, as `solve` takes it."""

    def solve(self, tangent: Any, right_hand_side: FloatArray) -> FloatArray:
        """Factorize a tangent and solve."""

    def moment(self, u: FloatArray, theta: float) -> float:
        """Return dE/dtheta: the work of the stresses per rotation of the face."""


@dataclass(frozen=True)
class LoadStep:
    """A converged equilibrium: its moment, and its costs.

    Seconds of assembly and solution are None if a program does not report them."""

    moment: float
    iterations: int
    seconds: float
    assembly: float | None = None
    solution: float | None = None


def trace(strip: Strip, angles: Iterable[float]) -> Iterator[LoadStep]:
    """Yield the equilibrium at each angle (radians), from the unstressed strip on.

    Raises ArithmeticError with the reason if Newton's method finds none."""
    history: deque[tuple[float, FloatArray]] = deque(maxlen=3)
    for theta in angles:
        began = perf_counter()
        state = _extrapolate(history, theta, strip.unknowns + 1)
        iterations, assembly, solution = _solve(strip, state, theta)
        history.append((theta, state))
        moment = strip.moment(strip.displacement(state, theta), theta)
        yield LoadStep(moment, iterations, perf_counter() - began, assembly, solution)


def by_processor_time(steps: Iterator[LoadStep]) -> Iterator[LoadStep]:
    """Yield the same steps with the processor time of each one in place of its wall time."""
    began = process_time()
    for step in steps:
        yield replace(step, seconds=process_time() - began)
        began = process_time()


def _solve(strip: Strip, state: FloatArray, theta: float) -> tuple[int, float, float]:
    """Correct a state in place until it is in equilibrium; return iterations and seconds of both parts."""
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
