"""Newton's method at one value of the drive's parameter."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np

from isopeel.assembly.system import Equilibrium, System
from isopeel.common.arrays import FloatArray
from isopeel.common.interrupts import check
from isopeel.common.path_control import PathControl
from isopeel.matrix.band import BandMatrix
from isopeel.matrix.bordered import Border, Bordered
from isopeel.matrix.factor import Factor, NotPositiveDefiniteError, SingularError
from isopeel.matrix.factorize import factorize

#: Why no equilibrium was found.
Cause = Literal[
    "inverted element",
    "limit point",
    "limit load",
    "energy without work",
    "instability",
    "long fall",
    "stalled residual",
    "line search",
    "non-finite traction",
    "singular tangent",
    "iteration limit",
]

#: The reason where det F is not positive.
INVERTED = "an element is inverted"
#: Corrections without a smaller energy residual are a stall.
_STALL = 10
#: An energy residual that falls to less of the last one is near a solution: a tangent that is kept then lets
#: errors fall by as much again, a sixth of what they were, at each correction.
_NEAR = 0.03

#: What to try.
HINTS: dict[Cause, str] = {
    "inverted element": "take smaller steps, or a mesh that is finer where the element is",
    "limit point": (
        "go beyond it with path_control = continuation, or with jump where forces have an energy, or refine"
    ),
    "limit load": "stay below it, or prescribe the displacement where the load acts (control = displacement)",
    "energy without work": "take path_control = auto, which looks for the stable branch, or smaller steps",
    "instability": "follow the unstable branch by path_control = continuation, or refine the mesh",
    "long fall": "refine the mesh where the joint opens, or stop before, where the body begins to come off",
    "stalled residual": "take smaller steps, or path_control = continuation",
    "line search": "take smaller steps, or a finer mesh",
    "non-finite traction": "take smaller steps, or see whether the body meets the substrate",
    "singular tangent": "hold the body so that it cannot move freely, or take path_control = continuation",
    "iteration limit": "take smaller steps, or path_control = auto, which cuts them",
}


@dataclass(frozen=True)
class NewtonSettings:
    """When Newton's method stops, and how a path goes on there.

    It ends with the first correction whose energy residual per unknown, |R . dz|/n, is below `tolerance`
    times the elastic scale E x area of the body; the correction itself is still applied. At most
    `iteration_limit` corrections are made with new tangents; those with kept ones have a limit of their own.

    `control` says what happens where that finds no equilibrium, as past a limit point. `newton`: the path
    ends. `auto`: the step is cut, and where the smallest one fails too, the path jumps to the next stable
    equilibrium that falling energy leads to, if there is an energy. `jump`: the limit point is located, and
    the path jumps from there, as in a test that prescribes the parameter. `continuation`: the path is
    followed through limit points, as a curve on which the parameter may fall.

    `plain` makes a new tangent for every correction. Without it a path keeps its tangents as long as they
    serve. Their last correction leaves about a tenth of the error, where that of Newton's method squares it;
    reactions are corrected for what is left, to first order. It turns to Newton's method where they do not
    lead to an equilibrium quickly, whose last tangent then serves on.
    """

    tolerance: float = 1e-20
    iteration_limit: int = 25
    path_control: PathControl = "newton"
    plain: bool = False


@dataclass(frozen=True, eq=False)
class NewtonResult:
    """A converged state, and the energy residual per unknown before each correction."""

    unknown_values: FloatArray
    displacement: FloatArray
    load: float
    equilibrium: Equilibrium
    iterations: tuple[float, ...]
    exact: bool = True  # so nearly that reactions need no correction by what is left
    #: Whether the last tangent on the way was positive definite under what is held: None where none was made,
    #: or forces have no potential. False only says that Cholesky's method does not tell.
    definite: bool | None = None


class ConvergenceError(ArithmeticError):
    """No equilibrium was found at a value of the drive's parameter.

    Holds the reason in words, the energy residuals of the iterations made, the parameter, and the cause.
    """

    def __init__(
        self, reason: str, iterations: tuple[float, ...], parameter: float, cause: Cause = "iteration limit"
    ) -> None:
        self.reason = reason
        self.iterations = iterations
        self.parameter = parameter
        self.cause = cause
        #: Coefficients (size, 2) where an element was inverted: to find the place takes as long as a step.
        self.displacement: FloatArray | None = None
        super().__init__(f"no equilibrium at {parameter:g}: {reason}")

    def located(self, system: System) -> "ConvergenceError":
        """The same with the place of the inverted element in its reason, where there is one."""
        inverted = None if self.displacement is None else system.inverted_point(self.displacement)
        if inverted is None:
            return self
        place, determinant = inverted
        at = f"det F = {determinant:.3g} at X = ({place[0]:.4g}, {place[1]:.4g})"
        reason = self.reason.replace(INVERTED, f"{INVERTED}: {at}", 1)
        return ConvergenceError(reason, self.iterations, self.parameter, self.cause)

    @property
    def hint(self) -> str:
        """What to try."""
        return HINTS[self.cause]

    def __reduce__(self) -> tuple[type["ConvergenceError"], tuple[str, tuple[float, ...], float, Cause]]:
        """Go from process to process with its parts."""
        return type(self), (self.reason, self.iterations, self.parameter, self.cause)


#: Ends what Newton's method has begun, from unknowns (count,) on, with its last tangent, which was made at
#: others (count,), at a parameter. None where it cannot.
Finish: TypeAlias = Callable[[FloatArray, BandMatrix, FloatArray, float], NewtonResult | None]


def newton(
    system: System,
    start: FloatArray,
    parameter: float,
    settings: NewtonSettings,
    finish: Finish | None = None,
) -> NewtonResult:
    """Solve R(y) = 0 at a value of the drive's parameter from a start y (count,).

    Each correction is dy = -K^-1 R with the exact tangent (Wriggers, Nonlinear Finite Element Methods,
    Sec. 5.1). Once they fall as they do near a solution, others may `finish`. Raises ConvergenceError with
    the reason.
    """
    y = start
    threshold = settings.tolerance * system.energy_scale
    measures: list[float] = []
    try:
        for _ in range(settings.iteration_limit):
            check()
            made_at = y
            correction, measure, matrix, definite = _correction(system, y, parameter)
            y = y + correction
            near = len(measures) > 0 and threshold < measure < _NEAR * measures[-1]
            measures.append(measure)
            if near and finish is not None and definite and not system.load_is_unknown:
                found = finish(made_at, matrix, y, parameter)
                if found is not None:
                    return replace(found, iterations=(*measures, *found.iterations))
                finish = None
            if measure <= threshold:
                u, load = system.state(y, parameter)
                return NewtonResult(
                    y, u, load, _accepted(system, u, load), tuple(measures), definite=definite
                )
    except _StoppedError as error:
        failure = ConvergenceError(str(error), tuple(measures), parameter, error.cause)
        failure.displacement = error.displacement
        raise failure from error
    reason = (
        f"the energy residual per unknown is {measures[-1]:.1e} after {len(measures)} iterations,"
        f" not below {threshold:.1e}"
    )
    # Newton's method squares its error where it converges: ten more corrections would have told
    stalled = len(measures) > _STALL and measures[-1] > min(measures[:-_STALL])
    cause: Cause = "stalled residual" if stalled else "iteration limit"
    raise ConvergenceError(reason, tuple(measures), parameter, cause)


class _StoppedError(ArithmeticError):
    """The iteration cannot go on; says why."""

    def __init__(self, reason: str, cause: Cause, displacement: FloatArray | None = None) -> None:
        self.cause = cause
        self.displacement = displacement
        super().__init__(reason)


def _correction(
    system: System, y: FloatArray, parameter: float
) -> tuple[FloatArray, float, BandMatrix, bool | None]:
    """Newton's correction of a state, its energy residual per unknown, the tangent, and if it is definite."""
    u, load = system.state(y, parameter)
    equilibrium, matrix = system.linearize(u, load=load)
    residual = equilibrium.residual
    if not np.isfinite(residual).all():
        raise _unsound(equilibrium, u)
    try:
        if system.load_is_unknown:
            correction, residual, again = _under_control(system, u, load, parameter, residual, matrix)
        else:
            factor, again = _factorized(system, u, load, matrix)
            correction = -factor.solve(residual)
    except SingularError as error:
        raise _StoppedError(f"the tangent is singular: {error}", "singular tangent") from error
    measure = abs(float(residual @ correction)) / len(correction)
    return correction, measure, matrix, not again if matrix.storage == "symmetric" else None


def _under_control(
    system: System, u: FloatArray, load: float, parameter: float, residual: FloatArray, matrix: BandMatrix
) -> tuple[FloatArray, FloatArray, bool]:
    """The correction with that of an unknown load at its end, the residual with that of its control.

    Last comes whether the tangent was made again because it is indefinite.
    """
    missed, column, row = system.control(u, parameter)
    # where the load itself could pull the body away, K is indefinite, but seldom what its control adds to it
    size = float(np.abs(matrix.entries[:, 0]).mean()) / float(column @ column)
    held = matrix.add_outer(column, size)
    inner, again = _factorized(system, u, load, matrix)
    factor = Bordered.of(inner, Border(column, row))
    held = held and not again  # the tangent that was made again is what it is
    right_side = np.append(residual + (size * missed * column if held else 0.0), missed)
    return -factor.solve(right_side), np.append(residual, missed), again


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
        raise _unsound(equilibrium, u)
    # a law that stays finite where the body is turned inside out may balance there
    if equilibrium.lowest_determinant <= 0:
        raise _StoppedError(INVERTED, "inverted element", u)
    return equilibrium


def _unsound(equilibrium: Equilibrium, u: FloatArray) -> _StoppedError:
    if equilibrium.lowest_determinant <= 0:
        return _StoppedError(INVERTED, "inverted element", u)
    return _StoppedError("the forces are not finite", "non-finite traction")
