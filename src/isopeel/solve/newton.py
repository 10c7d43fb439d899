"""Newton's method at one value of the drive's parameter."""

from dataclasses import dataclass, replace
from math import inf
from typing import get_args

import numpy as np

from isopeel.assembly.system import Equilibrium, System
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.interrupts import check
from isopeel.common.path_control import PathControl
from isopeel.matrix.band import BandMatrix
from isopeel.matrix.bordered import Border, Bordered
from isopeel.matrix.factor import Factor, NotPositiveDefiniteError, SingularError
from isopeel.matrix.factorize import factorize
from isopeel.solve.convergence import INVERTED, Cause, ConvergenceError

#: So many corrections without a smaller energy residual are a stall.
_STALL = 10
#: Most corrections where a shorter step can be taken instead: where the method converges it takes about six.
#: Past a limit point each correction costs a pivoted factor: with the full number of corrections they took
#: nine tenths of the time.
_FEW = 10


@dataclass(frozen=True)
class NewtonSettings:
    """When Newton's method stops, and what a path does where it fails.

    The iteration ends with the first correction whose energy residual per unknown, |R . dz|/n, is below
    `tolerance` times the elastic scale E x area of the body; the correction itself is still applied. At most
    `iteration_limit` corrections are made with new tangents; those with chord tangents have their own limit.

    `path_control` defines what happens where a step finds no equilibrium, for example past a limit point.
    `newton`: the path ends. `auto`: the step is cut; where the smallest step fails too, the path jumps to the
    next stable equilibrium that a descent of the energy reaches, if there is an energy. `jump`: the limit
    point is located, and the path jumps from there, as in a test that prescribes the parameter.
    `continuation`: the path is followed through limit points, as a curve on which the parameter may fall.

    `plain` makes a new tangent for every correction. Without it a chord tangent serves as long as it
    converges well. Its last correction leaves about a tenth of the error, where that of Newton's method
    squares it; reactions are corrected for the rest, to first order. Where the chord tangent does not
    converge quickly, Newton's method is used.

    Raises InputError where a value is not allowed.
    """

    tolerance: float = 1e-20
    iteration_limit: int = 25
    path_control: PathControl = "newton"
    plain: bool = False

    def __post_init__(self) -> None:
        """Check all values."""
        if not 0 < self.tolerance < inf:
            raise InputError("settings.tolerance", self.tolerance, "it must be positive")
        if self.iteration_limit < 1:
            raise InputError("settings.iteration_limit", self.iteration_limit, "it must be at least 1")
        kinds = get_args(PathControl)
        if self.path_control not in kinds:
            raise InputError("settings.path_control", self.path_control, f"it is one of {', '.join(kinds)}")

    def with_few_corrections(self) -> "NewtonSettings":
        """Return the settings with so few corrections as suffice where a shorter step can be taken."""
        return replace(self, iteration_limit=min(_FEW, self.iteration_limit))


@dataclass(frozen=True, eq=False)
class NewtonResult:
    """An equilibrium at a parameter, and the energy residual per unknown before each correction."""

    parameter: float
    unknown_values: FloatArray
    displacement: FloatArray
    load: float
    equilibrium: Equilibrium
    iterations: tuple[float, ...]
    exact: bool = True  # converged so far that reactions need no correction by the residual
    #: Whether the last tangent of the iteration was positive definite: None where none was made, or where
    #: forces have no potential. False means that Cholesky's method failed, which may be round-off.
    definite: bool | None = None
    #: Multipliers with which it was found, where contact has some: the history of the system, and the energy
    #: that the gaps at points in contact leave open.
    history: FloatArray | None = None
    uncertain_energy: float = 0.0


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
            check()
            correction, measure, definite = _correction(system, y, parameter)
            y = y + correction
            measures.append(measure)
            if measure <= threshold:
                u, load = system.state(y, parameter)
                equilibrium = _accepted(system, u, load)
                return NewtonResult(parameter, y, u, load, equilibrium, tuple(measures), definite=definite)
    except _StoppedError as error:
        failure = ConvergenceError(str(error), tuple(measures), parameter, error.cause)
        failure.displacement = error.displacement
        raise failure from error
    reason = (
        f"the energy residual per unknown is {measures[-1]:.1e} after {len(measures)} iterations,"
        f" not below {threshold:.1e}"
    )
    # Newton's method squares its error where it converges: _STALL corrections would have reduced it
    stalled = len(measures) > _STALL and measures[-1] > min(measures[:-_STALL])
    cause: Cause = "stalled residual" if stalled else "iteration limit"
    raise ConvergenceError(reason, tuple(measures), parameter, cause)


class _StoppedError(ArithmeticError):
    """The iteration cannot continue, for a reason."""

    def __init__(self, reason: str, cause: Cause, displacement: FloatArray | None = None) -> None:
        self.cause = cause
        self.displacement = displacement
        super().__init__(reason)


def _correction(system: System, y: FloatArray, parameter: float) -> tuple[FloatArray, float, bool | None]:
    """Return Newton's correction, its energy residual per unknown, and if the tangent is definite."""
    u, load = system.state(y, parameter)
    equilibrium, matrix = system.linearize(u, load=load)
    residual = equilibrium.residual
    if not np.isfinite(residual).all():
        raise _unsound(equilibrium, u)
    try:
        if system.global_unknowns:
            correction, residual, again = _with_unknown_load(system, u, load, parameter, residual, matrix)
        else:
            factor, again = _factorized(system, u, load, matrix)
            correction = -factor.solve(residual)
    except SingularError as error:
        raise _StoppedError(f"the tangent is singular: {error}", "singular tangent") from error
    measure = abs(float(residual @ correction)) / len(correction)
    return correction, measure, not again if matrix.storage == "symmetric" else None


def _with_unknown_load(
    system: System, u: FloatArray, load: float, parameter: float, residual: FloatArray, matrix: BandMatrix
) -> tuple[FloatArray, FloatArray, bool]:
    """Return correction and residual of the system bordered by an unknown load and its displacement control.

    The last value is whether the tangent was made again because it is indefinite.
    """
    missed, column, row = system.control.equation(u, parameter)
    # where the load could pull the body away, K is indefinite, but K plus the outer product seldom is
    size = float(np.abs(matrix.entries[:, 0]).mean()) / float(column @ column)
    held = matrix.add_outer(column, size)
    inner, again = _factorized(system, u, load, matrix)
    factor = Bordered.of(inner, Border(column, row))
    held = held and not again  # a tangent that was made again has no outer product in it
    right_side = np.append(residual + (size * missed * column if held else 0.0), missed)
    return -factor.solve(right_side), np.append(residual, missed), again


def _factorized(system: System, u: FloatArray, load: float, matrix: BandMatrix) -> tuple[Factor, bool]:
    """Return the factor of a tangent, and whether the tangent was made again because it is indefinite."""
    try:
        return factorize(matrix), False
    except NotPositiveDefiniteError:
        # past a limit point, or during the iteration: Newton's correction is still defined
        return factorize(system.linearize(u, "general", load)[1]), True


def _accepted(system: System, u: FloatArray, load: float) -> Equilibrium:
    equilibrium = system.equilibrium(u, load)
    if not np.isfinite(equilibrium.residual).all():
        raise _unsound(equilibrium, u)
    # a law that stays finite where the body is turned inside out may balance there
    if equilibrium.lowest_determinant <= 0:
        raise _StoppedError(INVERTED, "inverted element", u)
    return equilibrium


def _unsound(equilibrium: Equilibrium, u: FloatArray) -> _StoppedError:
    if equilibrium.lowest_determinant <= 0:
        return _StoppedError(INVERTED, "inverted element", u)
    return _StoppedError("the forces are not finite", "non-finite traction")
