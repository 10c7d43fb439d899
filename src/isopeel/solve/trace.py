"""The equilibrium path: one immutable step per requested value of the drive's parameter."""

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import NamedTuple

from threadpoolctl import ThreadpoolController

from isopeel.arrays import FloatArray, frozen
from isopeel.assembly.system import System
from isopeel.errors import InputError
from isopeel.problem import Problem
from isopeel.solve.newton import NewtonSettings, newton
from isopeel.solve.predictor import extrapolate
from isopeel.splines.rows import RowSpace

#: Converged states that the predictor extrapolates from: three, for a parabola.
PREDICTOR_POINTS = 3


class State(NamedTuple):
    """Where a path can go on from: a parameter, displacement coefficients (functions, 2), and the history.

    The latter are the largest openings (E, Q) so far, as a step has them; only irreversible adhesion asks.
    """

    parameter: float
    displacement: FloatArray
    openings: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class Step:
    """One converged equilibrium. Energies and reactions are for a unit width, in the problem's units.

    The adhesive energy is the potential of the adhesive forces where these act on the reference area;
    projected forces have none, and the work of the drive differs from the change of the energies. Of
    irreversible adhesion it is what closing would give back, and is zero where it was never opened.
    """

    number: int
    parameter: float  # of the drive; an angle is in radians
    reaction: float  # conjugate to the parameter; a moment for an angle
    displacement: FloatArray  # (functions, 2) coefficients, read-only
    stored_energy: float
    adhesive_energy: float  # zero at infinite gap
    dissipated_energy: float  # by irreversible adhesion
    iterations: tuple[float, ...]  # energy residual per unknown before each Newton correction
    seconds: float  # wall time of the step
    openings: FloatArray  # (E, Q) largest ones so far at the points of the adhesive force, read-only


def trace(
    problem: Problem,
    space: RowSpace,
    parameters: Iterable[float],
    settings: NewtonSettings | None = None,
    *,
    start: Sequence[State] = (),
    contact_points: int | None = None,
) -> Iterator[Step]:
    """Trace the equilibria of a problem on a space through the given values of the drive's parameter.

    Newton's method starts each step from the parabola through the last three states, those of `start`
    among them, of which the last is the newest; without any, from the body as it is. The adhesive force has
    `contact_points` Gauss points on each element, by default one more than the highest degree along it.

    To stop early, break. Raises ConvergenceError where a step finds no equilibrium; all steps before it
    have been yielded. Raises InputError where problem, space, start and points do not fit together, or the
    memory does not suffice.
    """
    system = System(problem, space, contact_points)
    for state in start:
        if state.displacement.shape != (space.size, 2):
            raise InputError("start", state.displacement.shape, f"the space has {space.size} functions")
    if start and start[-1].openings is not None:
        if start[-1].openings.shape != system.openings.shape:
            allowed = f"the adhesive force has {system.openings.shape} points"
            raise InputError("start", start[-1].openings.shape, allowed)
        system.openings = frozen(start[-1].openings)
    return _trace(system, parameters, settings or NewtonSettings(), start)


def _trace(
    system: System, parameters: Iterable[float], settings: NewtonSettings, start: Sequence[State]
) -> Iterator[Step]:
    libraries = ThreadpoolController()
    history = deque(
        (
            (state.parameter, system.constraints.unknown_values(state.displacement, state.parameter))
            for state in start
        ),
        maxlen=PREDICTOR_POINTS,
    )
    for number, parameter in enumerate(parameters):
        began = perf_counter()
        # the factorization of a narrow band gains nothing from threads, and loses by their start
        with libraries.limit(limits=1, user_api="blas"):
            # a drive that turns back meets a parameter again: its last state counts
            guess = extrapolate(dict(history), parameter, system.constraints.count)
            result = newton(system, guess, parameter, settings)
        history.append((parameter, result.unknown_values))
        system.accept(result.displacement)
        result.displacement.setflags(write=False)
        yield Step(
            number=number,
            parameter=parameter,
            reaction=system.constraints.reaction(result.equilibrium.forces, parameter),
            displacement=result.displacement,
            stored_energy=result.equilibrium.stored_energy,
            adhesive_energy=result.equilibrium.adhesive_energy,
            dissipated_energy=result.equilibrium.dissipated_energy,
            iterations=result.iterations,
            seconds=perf_counter() - began,
            openings=system.openings,
        )
