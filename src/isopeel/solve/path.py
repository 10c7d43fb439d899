"""A path while it is traced: its accepted states, their energy, and its steps."""

from collections.abc import Sequence
from time import perf_counter
from weakref import ref

import numpy as np

from isopeel.assembly.system import System
from isopeel.solve.balance import (
    NO_MISFIT,
    Allowance,
    Misfit,
    allowance,
    energy_round_off,
    joint_energy,
    misfit,
    released,
)
from isopeel.solve.descent import potential_energy
from isopeel.solve.newton import NewtonResult, NewtonSettings
from isopeel.solve.solver import Solver
from isopeel.solve.step import AcceptedState, Found, State, Step


class Path:
    """A path while it is traced: it judges equilibria by their energy, and accepts them as steps."""

    def __init__(
        self, system: System, settings: NewtonSettings, start: Sequence[State], *, begins: bool = False
    ) -> None:
        """Start from states; with `begins`, the last of them need not be an equilibrium."""
        #: Solves for equilibria from the accepted states.
        self.solver = Solver(system, settings, start)
        #: Whether the last state need not be an equilibrium: the first step has not been accepted yet.
        self.begins: bool = begins or not start
        #: Round-off of the energy of any state.
        self.round_off: float = energy_round_off(system)
        self._joint_energy = joint_energy(system)
        self._number = 0
        self._judged: tuple[NewtonResult, AcceptedState] | None = None

    @property
    def system(self) -> System:
        """The system after the history of the last step."""
        return self.solver.system

    @property
    def settings(self) -> NewtonSettings:
        """The settings of Newton's method, and the path control."""
        return self.solver.settings

    @property
    def history(self) -> list[AcceptedState]:
        """The last accepted states, the newest at the end."""
        return self.solver.states

    @property
    def allowance(self) -> Allowance:
        """The energy that the next step may gain without work."""
        return allowance(self._joint_energy, self.history[-1] if self.history else None, self.round_off)

    @property
    def gain_allowed(self) -> float:
        """The same for any work of the step."""
        return self.allowance.most

    def accept(self, found: Found, began: float) -> Step:
        """Accept an equilibrium and return it as a step; `began` is the time at which the step began."""
        system, result = self.system, found.result
        at, u, y = result.equilibrium, result.displacement, result.unknown_values
        last = self.history[-1] if self.history else None
        state = self.solver.accept(found, self.accepted_state(result))
        # as the load is raised, the energy falls by its displacement
        reaction = -state.rate if system.control.raises_load else state.rate
        self.begins = False
        u.setflags(write=False)
        y.setflags(write=False)
        solver_state = self.solver.state
        self._number += 1
        return Step(
            number=self._number - 1,
            parameter=found.parameter,
            reaction=reaction,
            displacement=u,
            stored_energy=at.stored_energy,
            adhesive_energy=at.adhesive_energy,
            dissipated_energy=at.dissipated_energy,
            iterations=result.iterations,
            seconds=perf_counter() - began,
            maximum_openings=self.system.maximum_openings,
            unknown_values=y,
            released_energy=0.0 if last is None else self._released(last, state, found),
            reactions=_reactions(system, result, reaction),
            load_work=system.held_work(u) if system.held else None,
            kind=found.kind,
            negative_eigenvalues=found.negative,
            resumes=found.resumes,
            accepted_states=tuple(self.history),
            solver_state=None if solver_state is None else ref(solver_state),
        )

    def accepted_state(self, result: NewtonResult) -> AcceptedState:
        """Return the accepted state of an equilibrium; the last result is cached."""
        if self._judged is None or self._judged[0] is not result:
            self._judged = result, AcceptedState.of(self.system, result)
        return self._judged[1]

    def misfit(self, result: NewtonResult) -> Misfit:
        """Return the energy that a step to an equilibrium gains or releases, from the accepted states."""
        if not self.system.has_potential:
            return NO_MISFIT
        state = self.accepted_state(result)
        if not self.history or (self.begins and self.history[-1].parameter != result.parameter):
            # the undeformed or just released body is no equilibrium, and its reaction means nothing; nor has
            # a body at rest the displacement that an unknown load must have
            if self.history or self.system.global_unknowns:
                return NO_MISFIT
            at_rest = potential_energy(self.system, np.zeros(self.system.count), result.parameter)
            return self._gained_at_once(state.energy - at_rest)
        one = self.history[-1]
        if one.parameter == result.parameter:
            return self._gained_at_once(state.energy - one.energy)
        work = max(abs(one.rate), abs(state.rate)) * abs(state.parameter - one.parameter)
        allowed = self.allowance
        if result.uncertain_energy:
            # that of the last state is about as large
            allowed = allowed._replace(most=allowed.most + 2 * result.uncertain_energy)
        if abs(released(one, state)) <= allowed.of_step(work) + self.round_off:
            # nearly all steps end here, after a few sums
            return NO_MISFIT
        return misfit(self.history, state, allowed, self.round_off)

    def _gained_at_once(self, gained: float) -> Misfit:
        """Return the misfit of an energy that was gained at one value of the parameter."""
        return Misfit(gained, gained > self.gain_allowed, releases=False)

    def _released(self, last: AcceptedState, state: AcceptedState, found: Found) -> float:
        # at the same parameter, the stage before has released what it held
        releases = last.parameter == state.parameter
        if not self.system.has_potential or not (releases or not found.is_balanced):
            return 0.0
        energy = released(last, state)
        # no jump gains energy: a gain is the error of the trapezoidal rule
        return max(energy, 0.0) if found.kind == "jump" else energy


def _reactions(system: System, result: NewtonResult, total: float) -> tuple[float, ...]:
    """Return the reactions of several boundaries, whose sum by their factors is the total reaction."""
    control = system.control
    factors = control.factors
    if len(factors) == 1:
        return ()
    found = control.reactions(result.equilibrium.forces, result.displacement, result.load, result.parameter)
    if system.global_unknowns:
        return found
    # the total reaction is corrected by the residual, and each of these by its share
    rest = total - sum(factor * one for factor, one in zip(factors, found, strict=True))
    share = rest / sum(factor**2 for factor in factors)
    return tuple(one + factor * share for factor, one in zip(factors, found, strict=True))
