"""The equilibrium at one value of the parameter, from the accepted states of a path."""

from collections.abc import Iterator, Sequence

from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.solve.augmentation import augmented
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.held_loads import applied_in_parts
from isopeel.solve.newton import NewtonResult, NewtonSettings, newton
from isopeel.solve.predictor import Predictor, extrapolate
from isopeel.solve.quasi_newton import QuasiNewton, SolverState
from isopeel.solve.stability import stability
from isopeel.solve.step import PARABOLA_POINTS, AcceptedState, Found, State


class Solver:
    """Solves for equilibria, and stores the accepted states from which they are extrapolated.

    The chord tangent is tried first, from the selected predictor; then Newton's method, from the parabola
    through the last three states.
    """

    def __init__(self, system: System, settings: NewtonSettings, start: Sequence[State]) -> None:
        #: The system after the history of the last accepted state.
        self.system = system
        self.settings = settings
        self._predictor = Predictor(system)
        for state, displacement in _accepted_states(system, start):
            self._predictor.add(state, displacement)
        self._quasi_newton: QuasiNewton | None = None
        if QuasiNewton.applies(system) and not settings.plain:
            self._quasi_newton = QuasiNewton(system, settings, _solver_state(system, start))

    @property
    def states(self) -> list[AcceptedState]:
        """The last accepted states, the newest at the end."""
        return self._predictor.states

    @property
    def state(self) -> SolverState | None:
        """What a path needs, besides the accepted states, to continue bit for bit."""
        return None if self._quasi_newton is None else self._quasi_newton.solver_state

    @property
    def has_chord_tangent(self) -> bool:
        """Whether the chord tangent is tried at all."""
        return self._quasi_newton is not None

    def accept(self, found: Found, state: AcceptedState) -> AcceptedState:
        """Store the accepted state of an equilibrium; return it, its rate corrected for the residual.

        The system then has the history after this state.
        """
        result = found.result
        if found.leaves_branch:
            self._predictor.clear()
        self._predictor.add(state, result.displacement)
        if not result.exact:
            # along the path dE/dp = dE/dp at fixed y + R . dy/dp: so the error is of second order in R
            missed = self._predictor.slope(result.equilibrium.residual)
            state = self.states[-1] = state._replace(rate=state.rate + missed)
        if self.system.irreversible:
            history = result.history
            found_in = self.system if history is None else self.system.after(history)
            self.system = self.system.after(found_in.commit(result.displacement))
            if self._quasi_newton is not None:
                self._quasi_newton.system = self.system
        return state

    def equilibrium(self, parameter: float, *, soon: bool = False) -> NewtonResult:
        """Return the equilibrium at a parameter, by the chord tangent or by Newton's method.

        With `soon`, Newton's method stops after few corrections, as a shorter step can be taken instead. If
        the first step fails under held loads, they are applied in parts. Raises ConvergenceError.
        """
        return augmented(self.system, self._equilibrium(parameter, soon=soon), self.settings)

    def _equilibrium(self, parameter: float, *, soon: bool) -> NewtonResult:
        found = self.by_chord_tangent(parameter)
        if found is not None:
            return found
        try:
            return self._by_newton(parameter, soon=soon)
        except ConvergenceError:
            if self.states or not self.system.held:
                raise
            found = applied_in_parts(self.system, parameter, self.settings)
            if found is None:
                raise
            return found

    def _by_newton(self, parameter: float, *, soon: bool) -> NewtonResult:
        settings = self.settings.with_few_corrections() if soon else self.settings
        try:
            return newton(self.system, self.parabola(parameter), parameter, settings)
        except ConvergenceError:
            # the last states of an irreversible joint are no equilibria once it has opened further
            if soon or self._quasi_newton is None or self.system.irreversible:
                raise
        self._converge_fully()
        return newton(self.system, self.parabola(parameter), parameter, settings)

    def by_chord_tangent(self, parameter: float) -> NewtonResult | None:
        """Return the equilibrium at a parameter, or None where the chord tangent does not find it."""
        if self._quasi_newton is None:
            return None
        last = self.states[-1].unknown_values if self.states else None
        return self._quasi_newton.equilibrium(self._predictor.guess(parameter), parameter, last)

    def drop_tangent(self) -> None:
        """Drop the chord tangent, which is of another state: the next step makes a new one."""
        if self._quasi_newton is not None:
            self._quasi_newton.drop_tangent()

    def parabola(self, parameter: float) -> FloatArray:
        """Return the unknowns (count,) at a parameter by the parabola through the last states."""
        last = self.states[-PARABOLA_POINTS:]
        return extrapolate({state.parameter: state.exact for state in last}, parameter, self.system.count)

    def starts(self, parameter: float) -> list[FloatArray]:
        """Return starts (count,) of a jump: the parabola, and the unknowns of the last states."""
        last = self.states[-PARABOLA_POINTS:]
        return [self.parabola(parameter), *(state.unknown_values for state in reversed(last))]

    def last_exact(self) -> FloatArray:
        """Return the last unknowns (count,), converged by Newton's method; raises ConvergenceError."""
        self.drop_tangent()
        last = self.states[-1]
        return newton(self.system, last.exact, last.parameter, self.settings).unknown_values

    def negative_eigenvalues(self, result: NewtonResult, *, always: bool = False) -> int | None:
        """Count the negative eigenvalues of the tangent at an equilibrium; return None where not counted.

        They are counted where the last tangents show that there may be some, or `always` (at the cost of a
        factor). Forces without a potential have no such count.
        """
        if not self.system.has_potential:
            return None
        if result.definite is None and not always:
            if self._quasi_newton is None:
                return None
            softer, falls = self._quasi_newton.has_softened(result)
            if softer:
                # the new tangent of the next step shows whether it is definite
                self.drop_tangent()
            if not falls:
                return None
        if result.definite:
            return 0
        known = stability(self.system, result.unknown_values, result.parameter)
        return None if known is None else known.negative

    def _converge_fully(self) -> None:
        """Converge the last states as far as plain Newton's method would.

        Where a step passes a limit point, its convergence depends on the last digits of its start.
        """
        first = max(len(self.states) - PARABOLA_POINTS, 0)
        for k, state in enumerate(self.states[first:], start=first):
            if state.fully_converged is None:
                try:
                    exact = newton(self.system, state.unknown_values, state.parameter, self.settings)
                except ConvergenceError:
                    continue
                self.states[k] = state._replace(fully_converged=exact.unknown_values)


def _accepted_states(system: System, start: Sequence[State]) -> Iterator[tuple[AcceptedState, FloatArray]]:
    """Yield the accepted states of a start, and their coefficients (size, 2)."""
    accepted = start[-1].accepted_states if start else ()
    for one in accepted:
        for y in (one.unknown_values, one.fully_converged):
            _check_shape(y, (system.count,))
        yield one, system.state(one.unknown_values, one.parameter)[0]
    for state in () if accepted else start:
        y = system.unknown_values(state.displacement, state.parameter)
        u, load = system.state(y, state.parameter)
        result = NewtonResult(state.parameter, y, u, load, system.equilibrium(u, load), ())
        yield AcceptedState.of(system, result), u


def _solver_state(system: System, start: Sequence[State]) -> SolverState | None:
    solver_state = start[-1].solver_state if start else None
    if solver_state is not None:
        _check_shape(solver_state.unknown_values, (system.count,))
        _check_shape(solver_state.maximum_openings, system.maximum_openings.shape)
    return solver_state


def _check_shape(values: FloatArray | None, shape: tuple[int, ...]) -> None:
    """Raise InputError where an array of the start has another shape: compiled code would not notice."""
    if values is not None and values.shape != shape:
        raise InputError("start", values.shape, f"the system needs arrays of the shape {shape}")
