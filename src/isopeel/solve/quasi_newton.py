"""Modified Newton method: a chord tangent that serves many steps, with L-BFGS updates."""

from dataclasses import dataclass, replace

import numpy as np

from isopeel.assembly.equations import Iterate
from isopeel.assembly.sizes import extent
from isopeel.assembly.system import Equilibrium, System
from isopeel.common.arrays import FloatArray
from isopeel.matrix.factor import NotPositiveDefiniteError
from isopeel.matrix.mixed_precision import Approximate, approximate
from isopeel.solve.corrections import CONVERGED, POOR, corrected
from isopeel.solve.lbfgs import LbfgsPairs
from isopeel.solve.newton import NewtonResult, NewtonSettings

#: Steps that one tangent serves.
_MOST_STEPS = 40
#: A step with more corrections than this is the last one of its tangent.
_SLOW = 6
_MOST_CORRECTIONS = 12
#: Share of the threshold below which the evaluation of the forces after the last correction is skipped.
#: Energies and reactions are known to second order in that correction, and its L-BFGS pair would gain little.
_SKIP_SHARE = 1e-2
#: Factor on the tolerance for drives on several boundaries: with the whole tolerance their reactions missed
#: 1.4e-7 of themselves.
_EXACT = 1e-3
#: Number of steps after which the stiffness of the softest motion of a tangent is evaluated again. If nine
#: tenths of it remain after a tenth of the steps that a tangent serves, and it decreases evenly, it does not
#: vanish in these steps. This costs one evaluation of the forces, a hundredth of the time of these steps.
_LOOK = _MOST_STEPS // 10
_REMAINING = 9 / 10
#: If at most this share of the stiffness of a motion remains, the energy may decrease along a part of it.
_SOFT = 1 / 4
#: Size of the motion over which forces are compared, as a share of the body's size. In bodies some hundred
#: times as long as high, its strain, which is of second order, is smaller than its bending. The residual
#: forces after the corrections are a few hundredths of the forces of this bending.
_SMALL_MOTION = 3e-5


@dataclass(frozen=True, eq=False)
class SolverState:
    """The state at which the chord tangent was made, and the L-BFGS pairs since.

    The tangent itself is not stored: it follows from the state.
    """

    unknown_values: FloatArray  # (count,)
    parameter: float
    maximum_openings: FloatArray  # (E, Q), for irreversible adhesion
    lbfgs_pairs: LbfgsPairs
    steps: int = 0  # that the tangent has served
    slow: bool = False  # the last of them

    def followed_by(self, pairs: LbfgsPairs, *, slow: bool) -> "SolverState":
        """Return the solver state after one more step."""
        return replace(self, lbfgs_pairs=pairs, steps=self.steps + 1, slow=slow)


class QuasiNewton:
    """The method of Broyden, Fletcher, Goldfarb and Shanno with limited memory (L-BFGS) on a chord tangent.

    A residual is far cheaper than a tangent and its factor, and along a path the tangent changes little from
    step to step. So the factor of one tangent serves many steps, and L-BFGS updates from the residuals follow
    its change (Matthies and Strang, Int. J. Numer. Methods Eng. 14, 1979). As in Newton's method, a step ends
    with the first correction whose energy residual is below the tolerance. Where the method does not converge
    well, it stops early, and Newton's method takes over.

    It applies to systems whose forces have a potential and whose load is known.
    """

    def __init__(
        self, system: System, settings: NewtonSettings, solver_state: SolverState | None = None
    ) -> None:
        #: The system after the history of the last step.
        self.system = system
        self._settings = settings
        #: The state that a path needs to continue from here bit for bit.
        self.solver_state: SolverState | None = (
            None
            if solver_state is None
            else replace(solver_state, lbfgs_pairs=solver_state.lbfgs_pairs.copy())
        )
        # the factor of the chord tangent, and a motion close to its softest one with twice its energy
        self._tangent: Approximate | None = None
        # whether that motion was softer at its last evaluation; unknown after a start from a stored state
        self._softens = solver_state is not None
        # whether a tangent was made in this step; it is positive definite then
        self._is_new = False

    @staticmethod
    def applies(system: System) -> bool:
        """Return whether the tangent is symmetric, and positive definite where the body is stable."""
        return system.has_potential and not system.global_unknowns

    def has_softened(self, result: NewtonResult) -> tuple[bool, bool]:
        """Return whether the softest motion of the tangent has softened, and whether its energy may decrease.

        A body may lose its stability while the tangent of an earlier stable state still serves. The check
        costs one evaluation of the forces, once for each tangent that serves long; once the motion has become
        softer, it is checked in each step. The motion is only close to the softest one: this adds the same
        stiffness before and now.
        """
        solver_state = self.solver_state
        if solver_state is None or self._tangent is None or solver_state.slow:
            return False, False
        served = solver_state.steps - 1
        if served != _LOOK and not (self._softens and 0 < served < _LOOK):
            return False, False
        motion, before = self._tangent.soft, self._tangent.needed
        scale = _SMALL_MOTION * extent(self.system.problem) / float(np.abs(motion).max())
        motion, before = scale * motion, scale**2 * before
        u, load = self.system.state(result.unknown_values + motion, result.parameter)
        change = self.system.equilibrium(u, load).residual - result.equilibrium.residual
        now = float(motion @ change)
        if served == _LOOK:
            self._softens = not now >= _REMAINING * before
            return self._softens, not now > 0
        return False, not now > _SOFT * before

    def drop_tangent(self) -> None:
        """Drop the chord tangent: the next step makes a new one."""
        self.solver_state = self._tangent = None

    def equilibrium(
        self, guess: FloatArray, parameter: float, last: FloatArray | None = None
    ) -> NewtonResult | None:
        """Return the equilibrium near a guess y (count,); None where Newton's method has to find it.

        `last` are the unknowns (count,) of the last step.
        """
        system = self.system
        # displacements and works of loads, and the dissipated energy, are known to first order only
        first_order = bool(system.loads) or system.irreversible
        skip_share = 0.0 if first_order else _SKIP_SHARE
        # a tangent made for the last step may mean that it has snapped on: slopes are of the states before
        last = None if self.solver_state is not None and self.solver_state.steps == 1 else last
        # the error of a reaction is of second order in that of the unknowns, that of each boundary of first
        share = _EXACT if len(system.control.factors) > 1 else 1.0
        result = self._solve(guess, parameter, last, share * self._settings.tolerance, skip_share)
        if result is None:
            self.drop_tangent()
        return result

    def _solve(
        self,
        guess: FloatArray,
        parameter: float,
        last: FloatArray | None,
        tolerance: float,
        skip_share: float,
    ) -> NewtonResult | None:
        self._is_new = False
        try:
            tangent, solver_state = self._chord_tangent(guess, parameter)
        except NotPositiveDefiniteError:
            return None
        system, count = self.system, len(guess)
        load = system.control.load(guess, parameter)
        moved, scalars = system.constraints.moved(parameter), np.array([load])
        u, forces = np.empty((2, *system.constraints.unknowns.shape))
        at = Iterate(guess.copy(), u, forces, np.empty(count))
        # read-only as those of a step: the corrections would be compiled anew for writable arrays
        last = (guess if last is None else last).view()
        last.setflags(write=False)
        measures = np.empty(_MOST_CORRECTIONS)
        made, threshold = 0, tolerance * system.energy_scale
        while True:
            pairs = solver_state.lbfgs_pairs.with_room(_MOST_CORRECTIONS)
            outcome, made, first, end, threshold, energies = corrected(
                system.equations,
                system.maximum_openings.ravel(),
                moved,
                scalars,
                tangent.factor.values,
                tangent.factor.starts,
                pairs.rows,
                pairs.products,
                pairs.first,
                pairs.end,
                at,
                last,
                measures,
                made,
                threshold,
                skip_share,
            )
            if outcome == POOR and solver_state.steps > 0:
                # the tangent is of an earlier step: a new one may converge
                try:
                    tangent, solver_state = self._new_tangent(at.unknown_values.copy(), parameter)
                except NotPositiveDefiniteError:
                    return None
            elif outcome == CONVERGED and energies[3] > 0:
                pairs = LbfgsPairs(pairs.rows, pairs.products, first, end)
                self.solver_state = solver_state.followed_by(pairs, slow=made > _SLOW)
                equilibrium = Equilibrium(*energies, at.forces, at.residual)
                iterations = tuple(measures[:made].tolist())
                definite = True if self._is_new else None
                return NewtonResult(
                    parameter, at.unknown_values, u, load, equilibrium, iterations, False, definite
                )
            else:
                return None

    def _chord_tangent(self, guess: FloatArray, parameter: float) -> tuple[Approximate, SolverState]:
        """Return the chord tangent and its state, or a new one where it has served enough."""
        solver_state = self.solver_state
        if solver_state is None or solver_state.slow or solver_state.steps >= _MOST_STEPS:
            return self._new_tangent(guess, parameter)
        if self._tangent is None:
            self._tangent = self._made(solver_state)
        return self._tangent, solver_state

    def _new_tangent(self, y: FloatArray, parameter: float) -> tuple[Approximate, SolverState]:
        solver_state = self._state_at(y, parameter)
        self._tangent = self._made(solver_state)
        self._is_new = True
        return self._tangent, solver_state

    def _state_at(self, y: FloatArray, parameter: float) -> SolverState:
        return SolverState(y, parameter, self.system.maximum_openings, LbfgsPairs.none(len(y)))

    def _made(self, solver_state: SolverState) -> Approximate:
        u, load = self.system.state(solver_state.unknown_values, solver_state.parameter)
        system = self.system.after(solver_state.maximum_openings)
        return approximate(system.linearize(u, "symmetric", load)[1])
