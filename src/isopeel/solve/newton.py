"""Newton's method at one value of the drive's parameter."""

from dataclasses import dataclass

import numpy as np

from isopeel.arrays import FloatArray
from isopeel.assembly.system import Equilibrium, System
from isopeel.solve.linear import Factor, NotPositiveDefiniteError, SingularError, factorize


@dataclass(frozen=True)
class NewtonSettings:
    """When Newton's method stops.

    It ends with the first correction whose energy residual per unknown, |R . dz|/n, is below `tolerance`
    times the elastic scale E x area of the body; the correction itself is still applied. `iteration_limit`
    corrections are made at most.
    """

    tolerance: float = 1e-20
    iteration_limit: int = 25


@dataclass(frozen=True, eq=False)
class NewtonResult:
    """A converged state, and the energy residual per unknown before each correction."""

    unknown_values: FloatArray
    displacement: FloatArray
    equilibrium: Equilibrium
    iterations: tuple[float, ...]


class ConvergenceError(ArithmeticError):
    """No equilibrium was found; says why, and holds the energy residuals of the iterations made."""

    def __init__(self, reason: str, iterations: tuple[float, ...]) -> None:
        self.reason = reason
        self.iterations = iterations
        super().__init__(reason)


def newton(system: System, start: FloatArray, parameter: float, settings: NewtonSettings) -> NewtonResult:
    """Solve R(z) = 0 at a value of the drive's parameter from a start z (count,).

    Each correction is dz = -K^-1 R with the exact tangent (Wriggers, Nonlinear Finite Element Methods,
    Sec. 5.1). Raises ConvergenceError with the reason.
    """
    z = start
    threshold = settings.tolerance * system.energy_scale
    measures: list[float] = []
    for _ in range(settings.iteration_limit):
        u = system.constraints.displacement(z, parameter)
        correction, measure = _correction(system, u, tuple(measures))
        z = z + correction
        measures.append(measure)
        if measure < threshold:
            return _accept(system, z, parameter, tuple(measures))
    raise ConvergenceError(
        f"the energy residual per unknown is {measures[-1]:.1e} after {len(measures)} iterations,"
        f" not below {threshold:.1e}",
        tuple(measures),
    )


def _correction(system: System, u: FloatArray, measures: tuple[float, ...]) -> tuple[FloatArray, float]:
    equilibrium, matrix = system.linearize(u)
    _check(system, u, equilibrium, measures)
    try:
        factor: Factor = factorize(matrix)
    except NotPositiveDefiniteError:
        # past a limit point, or on the way to a solution: Newton's correction is still defined
        _, matrix = system.linearize(u, "general")
        try:
            factor = factorize(matrix)
        except SingularError as error:
            raise ConvergenceError(f"the tangent is singular: {error}", measures) from error
    except SingularError as error:
        raise ConvergenceError(f"the tangent is singular: {error}", measures) from error
    correction = -factor.solve(equilibrium.residual)
    return correction, abs(float(equilibrium.residual @ correction)) / len(correction)


def _accept(system: System, z: FloatArray, parameter: float, measures: tuple[float, ...]) -> NewtonResult:
    u = system.constraints.displacement(z, parameter)
    equilibrium = system.equilibrium(u)
    _check(system, u, equilibrium, measures)
    return NewtonResult(z, u, equilibrium, measures)


def _check(system: System, u: FloatArray, equilibrium: Equilibrium, measures: tuple[float, ...]) -> None:
    """Raise ConvergenceError with the cause where a state has no finite forces."""
    if np.isfinite(equilibrium.residual).all():
        return
    inverted = system.inverted_point(u)
    if inverted is None:
        raise ConvergenceError("the forces are not finite", measures)
    place, determinant = inverted
    raise ConvergenceError(
        f"an element is inverted: det F = {determinant:.3g} at X = ({place[0]:.4g}, {place[1]:.4g})", measures
    )
