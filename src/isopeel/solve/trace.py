"""The equilibrium path: one immutable step per requested value of the drive's parameter."""

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import NamedTuple

import numpy as np
from threadpoolctl import ThreadpoolController

from isopeel.arrays import FloatArray, frozen
from isopeel.assembly.system import System
from isopeel.errors import InputError
from isopeel.problem import Problem
from isopeel.solve.descent import descend, potential_energy
from isopeel.solve.newton import ConvergenceError, NewtonResult, NewtonSettings, newton
from isopeel.solve.predictor import extrapolate
from isopeel.splines.rows import RowSpace

#: Converged states that the predictor extrapolates from: three, for a parabola.
PREDICTOR_POINTS = 3


class State(NamedTuple):
    """Where a path can go on from, as a step has it: displacement coefficients (functions, 2) at a parameter.

    Only irreversible adhesion asks for the largest openings (E, Q) so far. Without the solver's unknowns
    (count,), what goes on is the same to round-off; with those of three states it is the same bit for bit.
    """

    parameter: float
    displacement: FloatArray
    openings: FloatArray | None = None
    unknown_values: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class Step:
    """One converged equilibrium. Energies and reactions are for a unit width, in the problem's units.

    The adhesive energy is the potential of the adhesive forces where these act on the reference area;
    projected forces have none, and the work of the drive differs from the change of the energies. Of
    irreversible adhesion it is what closing would give back, and is zero where it was never opened.

    The released energy is the work of the drive since the last step, by the trapezoidal rule, less what the
    energies gained: zero to second order in the step, unless the path jumped (then it is known up to half
    of the step times the fall of the reaction), or a stage before let go of what it held. Forces without a
    potential have none.
    """

    number: int
    parameter: float  # of the drive; an angle is in radians
    reaction: float  # a moment for an angle, a force for a displacement, a displacement for a force
    displacement: FloatArray  # (functions, 2) coefficients, read-only
    stored_energy: float
    adhesive_energy: float  # zero at infinite gap
    dissipated_energy: float  # by irreversible adhesion
    iterations: tuple[float, ...]  # energy residual per unknown before each Newton correction
    seconds: float  # wall time of the step
    openings: FloatArray  # (E, Q) largest ones so far at the points of the adhesive force, read-only
    unknown_values: FloatArray  # (count,) of the solver, read-only
    released_energy: float = 0.0  # since the last step, see below

    @property
    def state(self) -> State:
        """Where another path can go on."""
        return State(self.parameter, self.displacement, self.openings, self.unknown_values)


def trace(
    problem: Problem,
    space: RowSpace,
    parameters: Iterable[float],
    settings: NewtonSettings | None = None,
    *,
    start: Sequence[State] = (),
    base: State | None = None,
    contact_points: int | None = None,
) -> Iterator[Step]:
    """Trace the equilibria of a problem on a space through the given values of the drive's parameter.

    Newton's method starts each step from the parabola through the last three states, those of `start`
    among them, of which the last is the newest; without any, from the body as it is. Where the path is a
    stage after another, `base` is the state that the latter ended in: there the drive begins, with the
    parameter zero, and what is held stays where it is. The adhesive force has `contact_points` Gauss points
    on each element, by default one more than the highest degree along it.

    To stop early, break. Raises ConvergenceError where a step finds no equilibrium; all steps before it
    have been yielded. Raises InputError where problem, space, start and points do not fit together, or the
    memory does not suffice.
    """
    given = [*start] if base is None else [base, *start]
    for state in given:
        if state.displacement.shape != (space.size, 2):
            raise InputError("start", state.displacement.shape, f"the space has {space.size} functions")
    system = System(problem, space, contact_points, None if base is None else base.displacement)
    if given and given[-1].openings is not None:
        if given[-1].openings.shape != system.openings.shape:
            allowed = f"the adhesive force has {system.openings.shape} points"
            raise InputError("start", given[-1].openings.shape, allowed)
        system.openings = frozen(given[-1].openings)
    if base is not None and not start:
        start = [base._replace(parameter=0.0, unknown_values=None)]
    settings = settings or NewtonSettings()
    if settings.jumps and system.storage != "symmetric":
        raise InputError("drive.jumps", True, "projected and following forces have no energy that could fall")
    history = []
    for state in start:
        y = _unknown_values(system, state)
        u, load = system.state(y, state.parameter)
        potential = system.potential(system.equilibrium(u, load), u, load, state.parameter)
        history.append(_Past(state.parameter, y, *potential))
    return _trace(system, parameters, settings, history)


class _Past(NamedTuple):
    """What the next step is guessed from."""

    parameter: float
    unknown_values: FloatArray
    energy: float
    rate: float  # of the energy, by the parameter


def _trace(
    system: System,
    parameters: Iterable[float],
    settings: NewtonSettings,
    start: Iterable[_Past],
) -> Iterator[Step]:
    libraries = ThreadpoolController()
    history = deque(start, maxlen=PREDICTOR_POINTS)
    for number, parameter in enumerate(parameters):
        began = perf_counter()
        # the factorization of a narrow band gains nothing from threads, and loses by their start
        with libraries.limit(limits=1, user_api="blas"):
            # a drive that turns back meets a parameter again: its last state counts
            guess = extrapolate(
                {past.parameter: past.unknown_values for past in history}, parameter, system.count
            )
            result, jumped = _equilibrium(system, guess, history, parameter, settings)
        energy, rate = system.potential(result.equilibrium, result.displacement, result.load, parameter)
        released = 0.0
        if history and system.storage == "symmetric":
            last = history[-1]
            work = (last.rate + rate) / 2 * (parameter - last.parameter)
            released = last.energy + work - energy
        if jumped:
            # states of the branch that was left would mislead the next guess
            history.clear()
        history.append(_Past(parameter, result.unknown_values, energy, rate))
        system.accept(result.displacement)
        result.displacement.setflags(write=False)
        result.unknown_values.setflags(write=False)
        yield Step(
            number=number,
            parameter=parameter,
            reaction=system.reaction(result.equilibrium, result.displacement, result.load, parameter),
            displacement=result.displacement,
            stored_energy=result.equilibrium.stored_energy,
            adhesive_energy=result.equilibrium.adhesive_energy,
            dissipated_energy=result.equilibrium.dissipated_energy,
            iterations=result.iterations,
            seconds=perf_counter() - began,
            openings=system.openings,
            unknown_values=result.unknown_values,
            released_energy=released,
        )


def _equilibrium(
    system: System, guess: FloatArray, history: Sequence[_Past], parameter: float, settings: NewtonSettings
) -> tuple[NewtonResult, bool]:
    """Newton's method from a guess or, where it fails and the settings allow it, after a jump."""
    try:
        return newton(system, guess, parameter, settings), False
    except ConvergenceError:
        if not settings.jumps:
            raise
    # the guess may turn elements inside out; a state before, carried along by the drive, seldom does
    for start in (guess, *(past.unknown_values for past in reversed(history))):
        if np.isfinite(potential_energy(system, start, parameter)):
            break
    return newton(system, descend(system, start, parameter), parameter, settings), True


def _unknown_values(system: System, state: State) -> FloatArray:
    if state.unknown_values is None:
        return system.unknown_values(state.displacement, state.parameter)
    if state.unknown_values.shape != (system.count,):
        raise InputError("start", state.unknown_values.shape, f"the system has {system.count} unknowns")
    return state.unknown_values
