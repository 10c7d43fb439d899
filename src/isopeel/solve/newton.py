"""Newton's method at one value of the drive's parameter."""

from dataclasses import dataclass

import numpy as np

from isopeel.arrays import FloatArray
from isopeel.assembly.system import BandMatrix, Equilibrium, System
from isopeel.solve.linear import (
    Border,
    Bordered,
    Factor,
    NotPositiveDefiniteError,
    SingularError,
    factorize,
)


@dataclass(frozen=True)
class NewtonSettings:
    """When Newton's method stops.

    It ends with the first correction whose energy residual per unknown, |R . dz|/n, is below `tolerance`
    times the elastic scale E x area of the body; the correction itself is still applied. `iteration_limit`
    corrections are made at most. Where that finds no equilibrium, as past a limit point, a path with `jumps`
    goes on from the next stable equilibrium that falling energy leads to.

    `plain` makes a new tangent for every correction. Without it a path keeps its tangents as long as they
    serve, with a hundredth of the tolerance, since their last correction leaves more than that of Newton's
    method; and turns to plain Newton where they do not lead to an equilibrium quickly.
    """

    tolerance: float = 1e-20
    iteration_limit: int = 25
    jumps: bool = False
    plain: bool = False


@dataclass(frozen=True, eq=False)
class NewtonResult:
    """A converged state, and the energy residual per unknown before each correction."""

    unknown_values: FloatArray
    displacement: FloatArray
    load: float
    equilibrium: Equilibrium
    iterations: tuple[float, ...]
    exact: bool = True  # to round-off, by a last correction of full Newton


class ConvergenceError(ArithmeticError):
    """No equilibrium was found at a value of the drive's parameter.

    Holds the reason, the energy residuals of the iterations made, and the parameter.
    """

    def __init__(self, reason: str, iterations: tuple[float, ...], parameter: float) -> None:
        self.reason = reason
        self.iterations = iterations
        self.parameter = parameter
        super().__init__(f"no equilibrium at {parameter:g}: {reason}")

    def __reduce__(self) -> tuple[type["ConvergenceError"], tuple[str, tuple[float, ...], float]]:
        """Go from process to process with its parts."""
        return type(self), (self.reason, self.iterations, self.parameter)


def newton(system: System, start: FloatArray, parameter: float, settings: NewtonSettings) -> NewtonResult:
    """Solve R(y) = 0 at a value of the drive's parameter from a start y (count,).

    Each correction is dy = -K^-1 R with the exact tangent (Wriggers, Nonlinear Finite Element Methods,
    Sec. 5.1). Raises ConvergenceError with the reason.
    """
    y = start
    threshold = settings.tolerance * system.energy_scale
    measures: list[float] = []
    try:
        for _ in range(settings.iteration_limit):
            correction, measure = _correction(system, y, parameter)
            y = y + correction
            measures.append(measure)
            if measure <= threshold:
                u, load = system.state(y, parameter)
                return NewtonResult(y, u, load, _accepted(system, u, load), tuple(measures))
    except _StoppedError as error:
        raise ConvergenceError(str(error), tuple(measures), parameter) from error
    reason = (
        f"the energy residual per unknown is {measures[-1]:.1e} after {len(measures)} iterations,"
        f" not below {threshold:.1e}"
    )
    raise ConvergenceError(reason, tuple(measures), parameter)


class _StoppedError(ArithmeticError):
    """The iteration cannot go on; says why."""


def _correction(system: System, y: FloatArray, parameter: float) -> tuple[FloatArray, float]:
    """Newton's correction of a state, and its energy residual per unknown."""
    u, load = system.state(y, parameter)
    equilibrium, matrix = system.linearize(u, load=load)
    residual = equilibrium.residual
    if not np.isfinite(residual).all():
        raise _StoppedError(_inversion(system, u) or "the forces are not finite")
    try:
        if system.load_is_unknown:
            correction, residual = _under_control(system, u, load, parameter, residual, matrix)
        else:
            correction = -_factorized(system, u, load, matrix)[0].solve(residual)
    except SingularError as error:
        raise _StoppedError(f"the tangent is singular: {error}") from error
    return correction, abs(float(residual @ correction)) / len(correction)


def _under_control(
    system: System, u: FloatArray, load: float, parameter: float, residual: FloatArray, matrix: BandMatrix
) -> tuple[FloatArray, FloatArray]:
    """The correction with that of an unknown load at its end, and the residual with that of its control."""
    missed, column, row = system.control(u, parameter)
    # where the load itself could pull the body away, K is indefinite, but seldom what its control adds to it
    size = float(np.abs(matrix.entries[:, 0]).mean()) / float(column @ column)
    held = matrix.add_outer(column, size)
    inner, again = _factorized(system, u, load, matrix)
    factor = Bordered.of(inner, Border(column, row))
    held = held and not again  # the tangent that was made again is what it is
    right_side = np.append(residual + (size * missed * column if held else 0.0), missed)
    return -factor.solve(right_side), np.append(residual, missed)


def _factorized(system: System, u: FloatArray, load: float, matrix: BandMatrix) -> tuple[Factor, bool]:
    """The factor of a tangent, and whether the tangent was made again because it is indefinite."""
    try:
        return factorize(matrix), False
    except NotPositiveDefiniteError:
        # past a limit point, or on the way to a solution: Newton's correction is still defined
        return factorize(system.linearize(u, "general", load)[1]), True


def _accepted(system: System, u: FloatArray, load: float) -> Equilibrium:
    equilibrium = system.equilibrium(u, load)
    if not np.isfinite(equilibrium.residual).all():
        raise _StoppedError(_inversion(system, u) or "the forces are not finite")
    # a law that stays finite where the body is turned inside out may balance there
    if equilibrium.lowest_determinant <= 0:
        raise _StoppedError(_inversion(system, u) or "an element is inverted")
    return equilibrium


def _inversion(system: System, u: FloatArray) -> str | None:
    """Where the body is turned inside out, if it is."""
    inverted = system.inverted_point(u)
    if inverted is None:
        return None
    place, determinant = inverted
    return f"an element is inverted: det F = {determinant:.3g} at X = ({place[0]:.4g}, {place[1]:.4g})"
