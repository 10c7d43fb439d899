"""The equilibrium path: one immutable step per requested value of the drive's parameter."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import NamedTuple
from weakref import ReferenceType, ref

import numpy as np
from scipy.linalg.blas import daxpy
from threadpoolctl import ThreadpoolController

from isopeel.arrays import FloatArray, frozen
from isopeel.assembly.system import Equilibrium, System
from isopeel.errors import InputError
from isopeel.problem import Problem
from isopeel.solve.descent import descend, potential_energy
from isopeel.solve.newton import ConvergenceError, NewtonResult, NewtonSettings, newton
from isopeel.solve.predictor import MOST_STATES, TRIES, best_weights, extrapolate, slope
from isopeel.solve.quasi_newton import Memory, QuasiNewton
from isopeel.splines.rows import RowSpace

#: Converged states that plain Newton's method starts from: three, for a parabola.
PARABOLA_POINTS = 3
#: States that a kept tangent starts from at most, and those by which the polynomial is chosen.
STATES_TO_GO_ON = MOST_STATES + TRIES
#: Places along the adhesive side where polynomials are compared, about.
_SAMPLES = 100


class Past(NamedTuple):
    """What the solver keeps of a state, to guess the next one from: unknowns (count,) at a parameter."""

    parameter: float
    unknown_values: FloatArray
    energy: float
    rate: float  # of the energy, by the parameter
    adhesive_energy: float  # and what was dissipated
    polished: FloatArray | None = None  # the unknowns to round-off, once they have been asked for

    @property
    def exact(self) -> FloatArray:
        """The unknowns (count,) as well as they are known."""
        return self.unknown_values if self.polished is None else self.polished


class State(NamedTuple):
    """Where a path can go on from, as a step has it: displacement coefficients (functions, 2) at a parameter.

    Only irreversible adhesion asks for the largest openings (E, Q) so far. Without the solver's past, its
    last states up to this one, what goes on is the same to the tolerance of the solver; with the past, and
    the solver's memory, it is the same bit for bit.
    """

    parameter: float
    displacement: FloatArray
    openings: FloatArray | None = None
    past: tuple[Past, ...] = ()
    memory: Memory | None = None


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
    past: tuple[Past, ...] = ()  # of the solver
    memory: "ReferenceType[Memory] | None" = None  # of the solver, which keeps it until the next step

    @property
    def state(self) -> State:
        """Where another path can go on; with the solver's memory as long as no later step has been made.

        To keep the memory of every step would take more room than all else of it.
        """
        memory = None if self.memory is None else self.memory()
        return State(self.parameter, self.displacement, self.openings, self.past, memory)


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

    Each step starts from the polynomial through the last states, those of `start` among them, of which the
    last is the newest; without any, from the body as it is. A kept tangent is tried first, where forces
    have a potential (see `QuasiNewton`), with the number of states that would have met the last one best;
    then Newton's method from the parabola through the last three. Where the path is a
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
        start = [base._replace(parameter=0.0, past=(), memory=None)]
    settings = settings or NewtonSettings()
    if settings.jumps and system.storage != "symmetric":
        raise InputError("drive.jumps", True, "projected and following forces have no energy that could fall")
    return _Path(system, settings, start).through(parameters)


class _Path:
    """A path on its way: what the solver knows of it."""

    def __init__(self, system: System, settings: NewtonSettings, start: Sequence[State]) -> None:
        self._system = system
        self._settings = settings
        self._side = np.unique(system.adhesive.functions)
        self._history: list[Past] = []
        self._bends: dict[float, FloatArray] = {}
        past = start[-1].past if start else ()
        for kept in past:
            if any(
                y is not None and y.shape != (system.count,) for y in (kept.unknown_values, kept.polished)
            ):
                allowed = f"the system has {system.count} unknowns"
                raise InputError("start", kept.unknown_values.shape, allowed)
            self._remember(kept)
        for state in () if past else start:
            y = system.unknown_values(state.displacement, state.parameter)
            u, load = system.state(y, state.parameter)
            self._remember(self._past(state.parameter, y, u, load, system.equilibrium(u, load)))
        self._quasi_newton: QuasiNewton | None = None
        if QuasiNewton.applies(system) and not settings.plain:
            memory = start[-1].memory if start else None
            if memory is not None and memory.unknown_values.shape != (system.count,):
                allowed = f"the system has {system.count} unknowns"
                raise InputError("start", memory.unknown_values.shape, allowed)
            self._quasi_newton = QuasiNewton(system, settings, memory)

    def through(self, parameters: Iterable[float]) -> Iterator[Step]:
        """Yield one step for each parameter."""
        libraries = ThreadpoolController()
        for number, parameter in enumerate(parameters):
            began = perf_counter()
            # narrow bands and vectors of this length gain nothing from threads, and lose by their start
            with libraries.limit(limits=1, user_api="blas"):
                result, jumped = self._equilibrium(parameter)
                step = self._step(number, parameter, result, jumped, began)
            yield step

    def _step(self, number: int, parameter: float, result: NewtonResult, jumped: bool, began: float) -> Step:
        system, at, u, y = self._system, result.equilibrium, result.displacement, result.unknown_values
        reaction = system.reaction(at, u, result.load, parameter)
        released = 0.0
        last = self._history[-1] if self._history else None
        if jumped:
            # states of the branch that was left would mislead the next guess
            self._history.clear()
        past = self._past(parameter, y, u, result.load, at)
        self._remember(past)
        if not result.exact:
            # along the path dE/dp = dE/dp at fixed y + R . dy/dp: so the error is of second order in R
            missed = slope(_by_parameter(self._history[-PARABOLA_POINTS:]), at.residual)
            past = self._history[-1] = past._replace(rate=past.rate + missed)
            reaction += missed if system.load is None else -missed
        if last is not None and system.storage == "symmetric":
            work = (last.rate + past.rate) / 2 * (parameter - last.parameter)
            released = last.energy + work - past.energy
        system.accept(u)
        u.setflags(write=False)
        y.setflags(write=False)
        memory = None if self._quasi_newton is None else self._quasi_newton.memory
        return Step(
            number=number,
            parameter=parameter,
            reaction=reaction,
            displacement=u,
            stored_energy=at.stored_energy,
            adhesive_energy=at.adhesive_energy,
            dissipated_energy=at.dissipated_energy,
            iterations=result.iterations,
            seconds=perf_counter() - began,
            openings=system.openings,
            unknown_values=y,
            released_energy=released,
            past=tuple(self._history),
            memory=None if memory is None else ref(memory),
        )

    def _past(self, parameter: float, y: FloatArray, u: FloatArray, load: float, at: Equilibrium) -> Past:
        adhesive_energy = at.adhesive_energy + at.dissipated_energy
        return Past(parameter, y, *self._system.potential(at, u, load, parameter), adhesive_energy)

    def _remember(self, past: Past) -> None:
        # a drive that turns back meets a parameter again: its last state counts
        others = [other for other in self._history if other.parameter != past.parameter]
        self._history = [*others, past][-STATES_TO_GO_ON:]
        u, _ = self._system.state(past.unknown_values, past.parameter)
        coefficients = u[self._side]
        # a turn of the body as a whole, which dwarfs all else, leaves second differences as they are
        order = min(2, len(coefficients) - 1)
        bends = np.diff(coefficients, order, axis=0)[:: 1 + len(coefficients) // _SAMPLES]
        known = {other.parameter: self._bends[other.parameter] for other in self._history[:-1]}
        self._bends = known | {past.parameter: bends.ravel()}

    def _equilibrium(self, parameter: float) -> tuple[NewtonResult, bool]:
        """By the kept tangent, by Newton's method or, where the settings allow it, after a jump."""
        system, settings = self._system, self._settings
        if self._quasi_newton is not None:
            found = self._quasi_newton.equilibrium(self._guess(parameter), parameter)
            if found is not None:
                return found, False
        for polished in (False, True) if self._can_polish() else (False,):
            if polished:
                self._polish()
            last = self._history[-PARABOLA_POINTS:]
            guess = extrapolate({past.parameter: past.exact for past in last}, parameter, system.count)
            try:
                return newton(system, guess, parameter, settings), False
            except ConvergenceError as error:
                failure = error
        if not settings.jumps:
            raise failure
        # the guess may turn elements inside out; a state before, carried along by the drive, seldom does
        for start in (guess, *(past.unknown_values for past in reversed(last))):
            if np.isfinite(potential_energy(system, start, parameter)):
                break
        return newton(system, descend(system, start, parameter), parameter, settings), True

    def _guess(self, parameter: float) -> FloatArray:
        """Where the path leads to."""
        guess = np.zeros(self._system.count)
        if self._history:
            weights = best_weights(
                np.array([past.parameter for past in self._history]),
                np.array([past.adhesive_energy for past in self._history]),
                np.array([self._bends[past.parameter] for past in self._history]),
                parameter,
            )
            for weight, past in zip(weights, self._history, strict=True):
                daxpy(past.unknown_values, guess, a=weight)
        return guess

    def _can_polish(self) -> bool:
        """Whether the last states are less exact than Newton's method would have left them.

        Past states are none any more once an irreversible joint has opened further.
        """
        return self._quasi_newton is not None and not self._system.problem.adhesion.irreversible

    def _polish(self) -> None:
        """Bring the last states to where plain Newton's method would have left them.

        Whether it converges hangs on the last digits of its start where a step passes a limit point.
        """
        first = max(len(self._history) - PARABOLA_POINTS, 0)
        for k, past in enumerate(self._history[first:], start=first):
            if past.polished is None:
                try:
                    exact = newton(self._system, past.unknown_values, past.parameter, self._settings)
                except ConvergenceError:
                    continue
                self._history[k] = past._replace(polished=exact.unknown_values)


def _by_parameter(history: Iterable[Past]) -> dict[float, FloatArray]:
    return {past.parameter: past.unknown_values for past in history}
