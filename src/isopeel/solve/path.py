"""A path on its way: what the solver knows of it, and the equilibrium at one value of the parameter."""

from collections.abc import Sequence
from time import perf_counter
from typing import NamedTuple
from weakref import ref

import numpy as np

from isopeel.arrays import FloatArray
from isopeel.assembly.system import Equilibrium, System
from isopeel.errors import InputError
from isopeel.solve.descent import descend, potential_energy
from isopeel.solve.newton import ConvergenceError, NewtonResult, NewtonSettings, newton
from isopeel.solve.predictor import Predictor, extrapolate
from isopeel.solve.quasi_newton import QuasiNewton
from isopeel.solve.step import PARABOLA_POINTS, Kind, Past, State, Step

#: Energy that a step may seem to release, of the drive's work in a usual step: errors of the trapezoidal rule
#: are some 1e-4 of it where a path is steep, and the smallest jumps over a snap-back some 1e-2.
MISFIT = 1e-3
#: Of the change of the unknowns in a step: what a parabola may miss them by.
_FORESEEN = 0.3


class Found(NamedTuple):
    """An equilibrium that was found, what it is, and the negative eigenvalues where they were counted."""

    parameter: float
    result: NewtonResult
    kind: Kind
    negative: int | None = None
    resumes: bool = True


class Path:
    """A path on its way: what the solver knows of it."""

    def __init__(self, system: System, settings: NewtonSettings, start: Sequence[State]) -> None:
        self.system = system
        self.settings = settings
        self._predictor = Predictor(system)
        self._number = 0
        past = start[-1].past if start else ()
        for kept in past:
            if any(
                y is not None and y.shape != (system.count,) for y in (kept.unknown_values, kept.polished)
            ):
                allowed = f"the system has {system.count} unknowns"
                raise InputError("start", kept.unknown_values.shape, allowed)
            self._predictor.remember(kept, system.state(kept.unknown_values, kept.parameter)[0])
        for state in () if past else start:
            y = system.unknown_values(state.displacement, state.parameter)
            u, load = system.state(y, state.parameter)
            self._predictor.remember(self.past(state.parameter, y, u, load, system.equilibrium(u, load)), u)
        self._quasi_newton: QuasiNewton | None = None
        if QuasiNewton.applies(system) and not settings.plain:
            memory = start[-1].memory if start else None
            if memory is not None and memory.unknown_values.shape != (system.count,):
                allowed = f"the system has {system.count} unknowns"
                raise InputError("start", memory.unknown_values.shape, allowed)
            self._quasi_newton = QuasiNewton(system, settings, memory)

    @property
    def history(self) -> list[Past]:
        """Its last states, the newest at the end."""
        return self._predictor.states

    @property
    def has_energy(self) -> bool:
        """Whether all forces have a potential."""
        return self.system.storage == "symmetric"

    def step(self, found: Found, began: float) -> Step:
        """Take a note of an equilibrium that was found, and make a step of it, on the way since a time."""
        system, result, parameter = self.system, found.result, found.parameter
        at, u, y = result.equilibrium, result.displacement, result.unknown_values
        released = 0.0
        last = self.history[-1] if self.history else None
        if found.kind == "jump":
            # states of the branch that was left would mislead the next guess
            self._predictor.forget()
        past = self.past(parameter, y, u, result.load, at)
        reaction = past.rate if system.load is None else system.reaction(at, u, result.load, parameter)
        self._predictor.remember(past, u)
        if not result.exact:
            # along the path dE/dp = dE/dp at fixed y + R . dy/dp: so the error is of second order in R
            missed = self._predictor.slope(at.residual)
            past = self.history[-1] = past._replace(rate=past.rate + missed)
            reaction += missed if system.load is None else -missed
        if last is not None and self.has_energy:
            released = _released(last, past)
        system.accept(u)
        u.setflags(write=False)
        y.setflags(write=False)
        memory = None if self._quasi_newton is None else self._quasi_newton.memory
        self._number += 1
        return Step(
            number=self._number - 1,
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
            kind=found.kind,
            negative_eigenvalues=found.negative,
            resumes=found.resumes,
            past=tuple(self.history),
            memory=None if memory is None else ref(memory),
        )

    def past(self, parameter: float, y: FloatArray, u: FloatArray, load: float, at: Equilibrium) -> Past:
        """What is kept of an equilibrium, of unknowns y (count,) and coefficients u (size, 2)."""
        adhesive_energy = at.adhesive_energy + at.dissipated_energy
        return Past(parameter, y, *self.system.potential(at, u, load, parameter), adhesive_energy)

    def equilibrium(self, parameter: float, kind: Kind = "requested") -> Found:
        """By the kept tangent or by Newton's method; raises ConvergenceError."""
        found = self._by_kept_tangent(parameter)
        if found is not None:
            return Found(parameter, found, kind)
        for polished in (False, True) if self._can_polish() else (False,):
            if polished:
                self._polish()
            last = self.history[-PARABOLA_POINTS:]
            guess = extrapolate({past.parameter: past.exact for past in last}, parameter, self.system.count)
            try:
                finish = None if self._quasi_newton is None else self._quasi_newton.finish
                return Found(parameter, newton(self.system, guess, parameter, self.settings, finish), kind)
            except ConvergenceError as error:
                failure = error
        raise failure

    def regular(self, parameter: float) -> Found | None:
        """The equilibrium where the path is plainly regular up to there; None where it may not be.

        Under forces with a potential the energy tells: what the step has released is none but for the error
        of the trapezoidal rule, unless another branch was met. Under others, and an unknown load, the
        parabola through the last states must have met the equilibrium well.
        """
        last = self.history[-1]
        if self._quasi_newton is not None:
            found = self._by_kept_tangent(parameter)
        else:
            found = self._as_foreseen(parameter)
        if found is None:
            return None
        if self.has_energy:
            past = self.past(
                parameter, found.unknown_values, found.displacement, found.load, found.equilibrium
            )
            if not self.fits(last, past, parameter - last.parameter):
                self.forget()
                return None
        return Found(parameter, found, "requested", 0 if self._quasi_newton is not None else None)

    @staticmethod
    def fits(one: Past, other: Past, step: float) -> bool:
        """Whether two states can lie on one branch, by their energies; `step` is a usual one of the path."""
        work = max(abs(one.rate), abs(other.rate)) * abs(step)
        return abs(_released(one, other)) <= MISFIT * work

    def forget(self) -> None:
        """Make a new tangent at the next step: the kept one is of elsewhere."""
        if self._quasi_newton is not None:
            self._quasi_newton.forget()

    def last_exact(self) -> FloatArray:
        """The last unknowns (count,), as Newton's method leaves them; raises ConvergenceError."""
        self.forget()
        last = self.history[-1]
        return newton(self.system, last.exact, last.parameter, self.settings).unknown_values

    def landed(self, starts: Sequence[FloatArray], parameter: float) -> Found:
        """What falling energy leads to from the first sound one of some starts (count,).

        Raises ConvergenceError where there is none.
        """
        self.forget()
        for start in starts:
            # a guess may turn elements inside out
            if np.isfinite(potential_energy(self.system, start, parameter)):
                break
        descent = descend(self.system, start, parameter)
        try:
            result = newton(self.system, descent.unknown_values, parameter, self.settings)
        except ConvergenceError as error:
            if not descent.at_floor:
                raise
            reason = f"the search for lower energy has no shorter step, and {error.reason}"
            raise ConvergenceError(reason, error.iterations, parameter, "line search") from error
        return Found(parameter, result, "jump", 0)

    def guesses(self, parameter: float) -> list[FloatArray]:
        """Where a jump at a parameter may begin: the parabola, and the last states, carried along."""
        last = self.history[-PARABOLA_POINTS:]
        guess = extrapolate({past.parameter: past.exact for past in last}, parameter, self.system.count)
        return [guess, *(past.unknown_values for past in reversed(last))]

    def _by_kept_tangent(self, parameter: float) -> NewtonResult | None:
        if self._quasi_newton is None:
            return None
        last = self.history[-1].unknown_values if self.history else None
        return self._quasi_newton.equilibrium(self._predictor.guess(parameter), parameter, last)

    def _as_foreseen(self, parameter: float) -> NewtonResult | None:
        last = self.history[-PARABOLA_POINTS:]
        guess = extrapolate({past.parameter: past.exact for past in last}, parameter, self.system.count)
        try:
            found = newton(self.system, guess, parameter, self.settings)
        except ConvergenceError:
            return None
        missed = np.abs(found.unknown_values - guess).max()
        moved = np.abs(found.unknown_values - last[-1].unknown_values).max()
        return found if missed <= _FORESEEN * moved else None

    def _can_polish(self) -> bool:
        """Whether the last states are less exact than Newton's method would have left them.

        Past states are none any more once an irreversible joint has opened further.
        """
        return self._quasi_newton is not None and not self.system.problem.adhesion.irreversible

    def _polish(self) -> None:
        """Bring the last states to where plain Newton's method would have left them.

        Whether it converges hangs on the last digits of its start where a step passes a limit point.
        """
        first = max(len(self.history) - PARABOLA_POINTS, 0)
        for k, past in enumerate(self.history[first:], start=first):
            if past.polished is None:
                try:
                    exact = newton(self.system, past.unknown_values, past.parameter, self.settings)
                except ConvergenceError:
                    continue
                self.history[k] = past._replace(polished=exact.unknown_values)


def _released(one: Past, other: Past) -> float:
    """Work of the drive from one state to another, by the trapezoidal rule, less what the energy gained."""
    return one.energy + (one.rate + other.rate) / 2 * (other.parameter - one.parameter) - other.energy
