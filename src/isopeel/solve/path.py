"""A path while it is traced: its solver data, and the equilibrium at one value of the parameter."""

from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter
from weakref import ref

import numpy as np

from isopeel.assembly.start import extent
from isopeel.assembly.system import Equilibrium, System
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.physics.batch import evaluate_substrate
from isopeel.solve.balance import (
    MISFIT,
    NO_MISFIT,
    ROUND_OFF,
    Misfit,
    energy_round_off,
    gain_allowed,
    misfit,
    released,
)
from isopeel.solve.branch import SOON, Branch
from isopeel.solve.descent import Descent, descend, potential_energy
from isopeel.solve.newton import ConvergenceError, NewtonResult, NewtonSettings, newton
from isopeel.solve.predictor import Predictor, extrapolate
from isopeel.solve.quasi_newton import QuasiNewton
from isopeel.solve.stability import stability
from isopeel.solve.step import PARABOLA_POINTS, AcceptedState, Found, Kind, State, Step

#: An equilibrium is well predicted where the parabola misses it by at most this share of the step's change.
_WELL_PREDICTED = 0.3
#: Iterations of a descent after which the body without its joint is tried: a jump over some elements takes 10
#: to 170 iterations, the jump of a block that comes off on a fine mesh many hundreds. When this limit was
#: 200, a stamp of 60 x 10 elements came off as a whole where the full descent ends half open.
_FAR = 3000
#: The same under a load that is kept: a longer descent means that the load is too large.
_FAR_UNDER_LOAD = 700


class Path:
    """A path while it is traced: accepted states, predictor, chord tangent and branch."""

    def __init__(
        self, system: System, settings: NewtonSettings, start: Sequence[State], *, begins: bool = False
    ) -> None:
        """Start from states; with `begins`, the last of them need not be an equilibrium."""
        #: The system after the history of its last step.
        self.system = system
        self.settings = settings
        self._predictor = Predictor(system)
        self._number = 0
        self._begins = begins or not start
        self._judged: tuple[NewtonResult | None, AcceptedState | None] = None, None
        #: The branch that the path is on.
        self.branch = Branch(self)
        #: Whether all forces have a potential.
        self.has_energy: bool = system.has_potential
        #: Energy that any step may gain without work.
        self.gain_allowed: float = gain_allowed(system)
        #: Round-off of the energy of any state.
        self.round_off: float = energy_round_off(system)
        #: Size of the body, and its control points (size, 2).
        self.extent: float = extent(system.problem)
        self.points: FloatArray = system.spaces.control_points()
        accepted = start[-1].accepted_states if start else ()
        for one in accepted:
            if any(
                y is not None and y.shape != (system.count,)
                for y in (one.unknown_values, one.fully_converged)
            ):
                allowed = f"the system has {system.count} unknowns"
                raise InputError("start", one.unknown_values.shape, allowed)
            self._predictor.add(one, system.state(one.unknown_values, one.parameter)[0])
        for state in () if accepted else start:
            y = system.unknown_values(state.displacement, state.parameter)
            u, load = system.state(y, state.parameter)
            self._predictor.add(
                self.accepted_state(state.parameter, y, u, load, system.equilibrium(u, load)), u
            )
        self._quasi_newton: QuasiNewton | None = None
        if QuasiNewton.applies(system) and not settings.plain:
            solver_state = start[-1].solver_state if start else None
            if solver_state is not None and solver_state.unknown_values.shape != (system.count,):
                allowed = f"the system has {system.count} unknowns"
                raise InputError("start", solver_state.unknown_values.shape, allowed)
            self._quasi_newton = QuasiNewton(system, settings, solver_state)

    @property
    def history(self) -> list[AcceptedState]:
        """The last accepted states, the newest at the end."""
        return self._predictor.states

    def step(self, found: Found, began: float) -> Step:
        """Accept an equilibrium and return it as a step; `began` is the time at which the step began."""
        system, result, parameter = self.system, found.result, found.parameter
        at, u, y = result.equilibrium, result.displacement, result.unknown_values
        released_energy = 0.0
        last = self.history[-1] if self.history else None
        if found.kind == "jump" or found.is_elsewhere:
            # states of the old branch must not be extrapolated
            self._predictor.clear()
            self.branch.forget()
        state = self.accepted_state_of(result, parameter)
        self._predictor.add(state, u)
        if not result.exact:
            # along the path dE/dp = dE/dp at fixed y + R . dy/dp: so the error is of second order in R
            missed = self._predictor.slope(at.residual)
            state = self.history[-1] = state._replace(rate=state.rate + missed)
        # as the load is raised, the energy falls by its displacement
        reaction = -state.rate if system.control.raises_load else state.rate
        # at the same parameter, the stage before has released what it held
        releases = last is not None and last.parameter == parameter
        if last is not None and self.has_energy and (releases or not found.is_balanced):
            released_energy = released(last, state)
            if found.kind == "jump":
                # no jump gains energy: a gain is the error of the trapezoidal rule
                released_energy = max(released_energy, 0.0)
        self._begins = False
        self.branch.step()
        if system.irreversible:
            self.system = system.after(system.commit(u))
            if self._quasi_newton is not None:
                self._quasi_newton.system = self.system
        u.setflags(write=False)
        y.setflags(write=False)
        solver_state = None if self._quasi_newton is None else self._quasi_newton.solver_state
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
            maximum_openings=self.system.maximum_openings,
            unknown_values=y,
            released_energy=released_energy,
            reactions=self._reactions(result, parameter, reaction),
            load_work=system.held_work(u) if system.held else None,
            kind=found.kind,
            negative_eigenvalues=found.negative,
            resumes=found.resumes,
            accepted_states=tuple(self.history),
            solver_state=None if solver_state is None else ref(solver_state),
        )

    def _reactions(self, result: NewtonResult, parameter: float, total: float) -> tuple[float, ...]:
        """Return the reactions of several boundaries, whose sum by their factors is the total reaction."""
        control = self.system.control
        factors = control.factors
        if len(factors) == 1:
            return ()
        forces, u = result.equilibrium.forces, result.displacement
        found = control.reactions(forces, u, result.load, parameter)
        if self.system.global_unknowns:
            return found
        # the total reaction is corrected by the residual, and each of these by its share
        rest = total - sum(factor * one for factor, one in zip(factors, found, strict=True))
        share = rest / sum(factor**2 for factor in factors)
        return tuple(one + factor * share for factor, one in zip(factors, found, strict=True))

    def accepted_state(
        self, parameter: float, y: FloatArray, u: FloatArray, load: float, at: Equilibrium
    ) -> AcceptedState:
        """Return the accepted state of an equilibrium: unknowns y (count,), coefficients u (size, 2)."""
        adhesive_energy = at.adhesive_energy + at.dissipated_energy
        return AcceptedState(parameter, y, *self.system.potential(at, u, load, parameter), adhesive_energy)

    def accepted_state_of(self, result: NewtonResult, parameter: float) -> AcceptedState:
        """Return the accepted state of a result of Newton's method; that of the last result is cached."""
        known, state = self._judged
        if state is None or known is not result:
            state = self.accepted_state(
                parameter, result.unknown_values, result.displacement, result.load, result.equilibrium
            )
            self._judged = result, state
        return state

    def misfit(self, found: Found) -> Misfit:
        """Return the energy that a step to an equilibrium gains or releases, from the accepted states."""
        if not self.has_energy:
            return NO_MISFIT
        state = self.accepted_state_of(found.result, found.parameter)
        if not self.history or (self._begins and self.history[-1].parameter != found.parameter):
            # the undeformed or just released body is no equilibrium, and its reaction means nothing
            # nor has a body at rest the displacement that an unknown load must have
            if self.history or self.system.constraints.global_unknowns:
                return NO_MISFIT
            at_rest = potential_energy(self.system, np.zeros(self.system.count), found.parameter)
            gained = state.energy - at_rest
            return Misfit(gained, gained > self.gain_allowed, releases=False)
        one = self.history[-1]
        if one.parameter == found.parameter:
            gained = state.energy - one.energy
            return Misfit(gained, gained > self.gain_allowed, releases=False)
        work = max(abs(one.rate), abs(state.rate)) * abs(state.parameter - one.parameter)
        if abs(released(one, state)) <= min(self.gain_allowed, MISFIT * work) + self.round_off:
            # nearly all steps end here, after a few sums
            return NO_MISFIT
        return misfit(self.history, state, self.gain_allowed, self.round_off)

    def negative_eigenvalues(self, found: Found, *, always: bool = False) -> int | None:
        """Count the negative eigenvalues of the tangent at an equilibrium; return None where not counted.

        They are counted where the last tangents show that there may be some, or `always` (at the cost of a
        factor).
        """
        if not self.has_energy:
            return None
        if found.result.definite is None and not always:
            if self._quasi_newton is None:
                return None
            softer, falls = self._quasi_newton.has_softened(found.result, found.parameter)
            if softer:
                # the new tangent of the next step shows whether it is definite
                self.forget()
            if not falls:
                return None
        if found.result.definite:
            return 0
        known = stability(self.system, found.result.unknown_values, found.parameter)
        return None if known is None else known.negative

    def equilibrium(self, parameter: float, kind: Kind = "requested", *, soon: bool = False) -> Found:
        """Return the equilibrium at a parameter, by the chord tangent or by Newton's method.

        With `soon`, Newton's method stops after few corrections, as a shorter step can be taken instead.
        Raises ConvergenceError.
        """
        found = self._by_chord_tangent(parameter)
        if found is not None:
            return Found(parameter, found, kind)
        settings = self.settings
        if soon:
            settings = replace(settings, iteration_limit=min(SOON, settings.iteration_limit))
        for fully_converged in (False, True) if self._can_converge_fully() and not soon else (False,):
            if fully_converged:
                self._converge_fully()
            last = self.history[-PARABOLA_POINTS:]
            guess = extrapolate(
                {state.parameter: state.exact for state in last}, parameter, self.system.count
            )
            try:
                finish = None if self._quasi_newton is None else self._quasi_newton.finish
                return Found(parameter, newton(self.system, guess, parameter, settings, finish), kind)
            except ConvergenceError as error:
                failure = error
        raise failure

    def regular(self, parameter: float) -> Found | None:
        """Return the equilibrium where the path is clearly regular up to the parameter, else None.

        For forces with a potential the energy decides: on one branch a step releases nothing but the error of
        the trapezoidal rule. For other forces, and an unknown load, the parabola through the last states must
        predict the equilibrium well.
        """
        last = self.history[-1]
        if self._quasi_newton is not None:
            found = self._by_chord_tangent(parameter)
        else:
            found = self._well_predicted(parameter)
        if found is None:
            return None
        if self.has_energy:
            state = self.accepted_state(
                parameter, found.unknown_values, found.displacement, found.load, found.equilibrium
            )
            if not self.fits(last, state, parameter - last.parameter):
                self.forget()
                return None
        regular = Found(parameter, found, "requested")
        return regular._replace(negative=self.negative_eigenvalues(regular))

    def fits(self, one: AcceptedState, other: AcceptedState, step: float) -> bool:
        """Return whether two states can lie on one branch, by their energies; `step` is a usual step."""
        misfits = released(one, other)
        most = MISFIT * max(abs(one.rate), abs(other.rate)) * abs(step)
        # next to a limit point, where the rate goes with the root of the parameter, the error of the
        # trapezoidal rule is half of this
        change = abs((other.rate - one.rate) * (other.parameter - one.parameter)) / 3
        return abs(misfits) <= most and -misfits <= self.gain_allowed + change

    def moves_to(self, parameter: float) -> bool:
        """Return whether a step to a parameter changes the parameter."""
        return bool(self.history) and self.history[-1].parameter != parameter

    def is_smooth(self, found: Found) -> bool:
        """Return whether an equilibrium lies on the branch of the last state, by its energy."""
        state = self.accepted_state_of(found.result, found.parameter)
        return self.misfit(found).fits and self.on_one_branch(self.history[-1], state)

    @staticmethod
    def on_one_branch(one: AcceptedState, other: AcceptedState) -> bool:
        """Return whether the energy between two near states comes from the work, without any allowance."""
        change = abs(other.rate - one.rate) * abs(other.parameter - one.parameter) / 6
        round_off = ROUND_OFF * max(abs(one.energy), abs(other.energy))
        return abs(released(one, other)) <= change + round_off + MISFIT * abs(
            one.rate * (other.parameter - one.parameter)
        )

    def forget(self) -> None:
        """Drop the chord tangent, which is of another state: the next step makes a new one."""
        if self._quasi_newton is not None:
            self._quasi_newton.forget()

    def last_exact(self) -> FloatArray:
        """Return the last unknowns (count,), converged by Newton's method; raises ConvergenceError."""
        self.forget()
        last = self.history[-1]
        return newton(self.system, last.exact, last.parameter, self.settings).unknown_values

    def jump_from(self, starts: Sequence[FloatArray], parameter: float) -> Found:
        """Return the stable equilibrium that a descent of the energy reaches: a jump.

        It begins at the first of some starts (count,) at which no element is inverted. Raises
        ConvergenceError where it reaches no equilibrium.
        """
        self.forget()
        for start in starts:
            # an extrapolated start may invert elements
            if np.isfinite(potential_energy(self.system, start, parameter)):
                break
        far = _FAR_UNDER_LOAD if self.system.control.raises_load else _FAR
        descent = descend(self.system, start, parameter, far)
        loose = self._come_off(descent, parameter) if descent.is_unfinished else None
        if loose is not None:
            descent = descend(self.system, loose, parameter)
        if descent.is_unfinished:
            reason = "the descent of the energy goes far, and has not ended after many steps"
            raise ConvergenceError(reason, (), parameter, "long fall")
        if descent.away:
            reason = "the body comes off and moves away: its energy has no lower bound"
            raise ConvergenceError(reason, (), parameter, "limit load")
        try:
            result = newton(self.system, descent.unknown_values, parameter, self.settings)
        except ConvergenceError as error:
            if not descent.line_search_failed:
                raise
            reason = f"the line search of the descent failed, and {error.reason}"
            raise ConvergenceError(reason, error.iterations, parameter, "line search") from error
        fallen_from, reached = (
            potential_energy(self.system, y, parameter) for y in (start, descent.unknown_values)
        )
        # where points of a stiff contact open and close, Newton's method raises the energy a little again
        given_back = MISFIT * (fallen_from - reached) if np.isfinite(fallen_from) else 0.0
        if self.accepted_state_of(result, parameter).energy > reached + self.gain_allowed + given_back:
            reason = "Newton's method leaves the state that the descent of the energy has reached"
            raise ConvergenceError(reason, result.iterations, parameter, "line search")
        return Found(parameter, result, "jump", 0)

    def _come_off(self, descent: Descent, parameter: float) -> FloatArray | None:
        """Return the unknowns (count,) of the body without its joint where their energy is lower, else None.

        The energy is compared with that of a long descent. A block whose joint opens at an edge comes off as
        a whole, while a descent has to open it point by point. Returns None too where the body is held by its
        joint alone.
        """
        reached = potential_energy(self.system, descent.unknown_values, parameter)
        for start in (descent.unknown_values, self.history[-1].unknown_values if self.history else None):
            if start is None:
                continue
            try:
                loose = newton(self.system.without_joint(), start, parameter, self.settings).unknown_values
            except ConvergenceError:
                continue
            return loose if potential_energy(self.system, loose, parameter) < reached else None
        return None

    def jump(self, parameter: float) -> Found:
        """Return the equilibrium at a parameter that the last states jump to.

        The energy may grow by the work of the drive at most. Raises ConvergenceError.
        """
        last = self.history[-1] if self.history else None
        failure: ConvergenceError | None = None
        for start in self.guesses(parameter):
            try:
                found = self.jump_from([start], parameter)
            except ConvergenceError as error:
                failure = failure or error
                if error.cause in ("limit load", "long fall"):
                    # the descent from another start would go as far
                    break
                continue
            if last is None or self._begins:
                return found
            state = self.accepted_state_of(found.result, parameter)
            step = parameter - last.parameter
            # before the jump the drive has done work at the old rate or at the new one
            most = max(last.rate * step, state.rate * step)
            if state.energy <= last.energy + most + self.gain_allowed:
                return found
        raise failure or ConvergenceError(
            "every state that a descent of the energy reaches has more energy than the drive has done work",
            (),
            parameter,
            "energy without work",
        )

    def displacement(self, state: AcceptedState) -> FloatArray:
        """Return the coefficients (size, 2) of an accepted state."""
        return self.system.state(state.unknown_values, state.parameter)[0]

    def gaps(self, displacement: FloatArray) -> FloatArray:
        """Return the gaps (size,) of all control points to the nearest substrate, for u (size, 2)."""
        system, gaps = self.system, np.full(len(displacement), np.inf)
        for interface in system.problem.interfaces:
            place, substrate = system.spaces.places[interface.boundary.body], interface.substrate
            position = self.points[place] + displacement[place]
            gap = evaluate_substrate(substrate.kernel, substrate.parameters, position)[0]
            gaps[place] = np.minimum(gaps[place], gap)
        return gaps

    def depth(self, displacement: FloatArray) -> float:
        """Return the largest depth of a control point in the substrate, for coefficients (size, 2)."""
        return -min(float(self.gaps(displacement).min()), 0.0)

    def guesses(self, parameter: float) -> list[FloatArray]:
        """Return starts (count,) of a jump: the parabola, and the unknowns of the last states."""
        last = self.history[-PARABOLA_POINTS:]
        guess = extrapolate({state.parameter: state.exact for state in last}, parameter, self.system.count)
        return [guess, *(state.unknown_values for state in reversed(last))]

    def _by_chord_tangent(self, parameter: float) -> NewtonResult | None:
        if self._quasi_newton is None:
            return None
        last = self.history[-1].unknown_values if self.history else None
        return self._quasi_newton.equilibrium(self._predictor.guess(parameter), parameter, last)

    def _well_predicted(self, parameter: float) -> NewtonResult | None:
        last = self.history[-PARABOLA_POINTS:]
        guess = extrapolate({state.parameter: state.exact for state in last}, parameter, self.system.count)
        try:
            found = newton(self.system, guess, parameter, self.settings)
        except ConvergenceError:
            return None
        missed = np.abs(found.unknown_values - guess).max()
        moved = np.abs(found.unknown_values - last[-1].unknown_values).max()
        return found if missed <= _WELL_PREDICTED * moved else None

    def _can_converge_fully(self) -> bool:
        """Return whether the last states can be converged further by Newton's method.

        Those of an irreversible joint cannot: once it has opened further, they are no equilibria any more.
        """
        return self._quasi_newton is not None and not self.system.irreversible

    def _converge_fully(self) -> None:
        """Converge the last states as far as plain Newton's method would.

        Where a step passes a limit point, its convergence depends on the last digits of its start.
        """
        first = max(len(self.history) - PARABOLA_POINTS, 0)
        for k, state in enumerate(self.history[first:], start=first):
            if state.fully_converged is None:
                try:
                    exact = newton(self.system, state.unknown_values, state.parameter, self.settings)
                except ConvergenceError:
                    continue
                self.history[k] = state._replace(fully_converged=exact.unknown_values)
