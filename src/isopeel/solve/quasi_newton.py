"""Newton's method with a tangent that is kept from step to step, and learns from the steps it has taken."""

from dataclasses import dataclass, replace

import numpy as np

from isopeel.assembly.constraints import displace
from isopeel.assembly.equations import Equations, Iterate, evaluate
from isopeel.assembly.loops import Energies
from isopeel.assembly.start import extent
from isopeel.assembly.system import Equilibrium, System
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import compiled_reordered
from isopeel.matrix.band import BandMatrix
from isopeel.matrix.cholesky import BandCholesky, Floats
from isopeel.matrix.factor import NotPositiveDefiniteError
from isopeel.matrix.mixed_precision import approximate
from isopeel.solve.lbfgs import LbfgsPairs, Singles, correct, follow
from isopeel.solve.newton import NewtonResult, NewtonSettings

#: Steps that one tangent serves.
_MOST_STEPS = 40
#: A step that takes more corrections is the last one of its tangent.
_SLOW = 6
_MOST_CORRECTIONS = 12
#: Of the tolerance, where a guess has missed more than this part of the way from the last state: the last
#: correction leaves a tenth of the error, where Newton's method squares it, and what is left turns up in
#: reactions as far as the path's slope is known no better. At 1e-3 one step of L4 at 200 x 10 elements missed
#: its moment by 1.4e-8 in one run of several; at this those of L1, L2 and L4 are met to 6e-9.
_SHARE = 1e-3
_FORESEEN = 3e-4
#: Of the tolerance: what a last correction may leave, as the one before tells. Where they fall slowly that is
#: most of it: a step of L4 with the last two at 0.4 of each other missed its moment by 1.1e-8.
_LEFT = 0.1
#: Of what a step ends at: a last correction below this is no more than what others leave. Energies and
#: reactions are known to second order in it, and it teaches little. So forces are not asked for once more.
_TRIFLE = 1e-2
#: Of the tolerance, and _SHARE of that: where Newton's method has begun, whose end squares what is left. The
#: slope of a path that has just snapped on would correct no reaction.
_EXACT = 1e-3
#: Steps after that of its tangent in which the stiffness of its softest motion is looked at again: one that
#: has kept nine tenths in a tenth of the steps that a tangent serves, and falls evenly, does not vanish
#: while it serves. A look costs an evaluation of the forces, a hundredth of the time of these steps.
_LOOK = _MOST_STEPS // 10
_KEPT = 9 / 10
#: A motion that has kept no more of its stiffness may hide one that falls in energy, of which it is a part.
_SOFT = 1 / 4
#: Of the size of the body: the motion over which forces are compared. What it strains by its square is below
#: what it bends by, in bodies some hundred times as long as high; and what corrections have left of the
#: forces is a few hundredths of those that it takes to bend them by it.
_SMALL_MOTION = 3e-5
#: An energy residual that falls by less is a poor correction; the second one of a tangent ends it.
_POOR = 0.5

# what corrections have led to
_CONVERGED, _POORLY, _NOWHERE = range(3)


@dataclass(frozen=True, eq=False)
class Memory:
    """What is kept from step to step: where the tangent was made, and what was learned since.

    The tangent itself is not kept here: it follows from where it was made.
    """

    unknown_values: FloatArray  # (count,)
    parameter: float
    openings: FloatArray  # (E, Q), for irreversible adhesion
    pairs: LbfgsPairs
    steps: int = 0
    slow: bool = False  # the last step

    def followed_by(self, pairs: LbfgsPairs, *, slow: bool) -> "Memory":
        """After one more step."""
        return Memory(self.unknown_values, self.parameter, self.openings, pairs, self.steps + 1, slow)


class QuasiNewton:
    """The method of Broyden, Fletcher, Goldfarb and Shanno with limited memory, on a kept tangent.

    A residual is far cheaper than a tangent and its factor, and along a path the tangent changes little
    from step to step. So the factor of one tangent serves many steps; what has changed since is learned
    from the residuals (Matthies and Strang, Int. J. Numer. Methods Eng. 14, 1979). It ends as Newton's method
    does, with the first correction whose energy residual is below the tolerance, and gives up early where
    it does not converge well: Newton's method then decides.

    For systems whose forces have a potential, under no unknown load.
    """

    def __init__(self, system: System, settings: NewtonSettings, memory: Memory | None = None) -> None:
        self._system = system
        self._settings = settings
        self._factor: BandCholesky | None = None
        #: What goes on from here needs to do so bit for bit.
        self.memory: Memory | None = None if memory is None else replace(memory, pairs=memory.pairs.copy())
        # a motion next to the softest one of the tangent, and twice the energy that it takes there
        self._softest: tuple[FloatArray, float] | None = None
        # whether the last look has found that softer; not known of a path that goes on from a stored state
        self._softens = memory is not None
        # whether a tangent, which is positive definite then, was made in the step
        self._is_new = False

    @staticmethod
    def applies(system: System) -> bool:
        """Whether the tangent is symmetric, and positive definite where the body is stable."""
        return system.storage == "symmetric" and not system.load_is_unknown

    def has_softened(self, result: NewtonResult, parameter: float) -> tuple[bool, bool]:
        """Whether the softest motion of the tangent is much softer in what was found, and may fall in energy.

        It costs an evaluation of the forces, once for each tangent that serves long: a body may lose its
        stability while a tangent of a stable state serves on. Once it has become softer, it is looked at in
        each step. What the motion misses of the softest one shows in both stiffnesses alike.
        """
        memory = self.memory
        if memory is None or self._softest is None or memory.slow:
            return False, False
        served = memory.steps - 1
        if served != _LOOK and not (self._softens and 0 < served < _LOOK):
            return False, False
        motion, before = self._softest
        scale = _SMALL_MOTION * extent(self._system.problem) / float(np.abs(motion).max())
        motion, before = scale * motion, scale**2 * before
        u, load = self._system.state(result.unknown_values + motion, parameter)
        change = self._system.equilibrium(u, load).residual - result.equilibrium.residual
        now = float(motion @ change)
        if served == _LOOK:
            self._softens = not now >= _KEPT * before
            return self._softens, not now > 0
        return False, not now > _SOFT * before

    def forget(self) -> None:
        """Make a new tangent at the next step."""
        self.memory = self._factor = None

    def equilibrium(
        self, guess: FloatArray, parameter: float, last: FloatArray | None = None
    ) -> NewtonResult | None:
        """Find the equilibrium near a guess y (count,), one step from the last; None where Newton should."""
        system = self._system
        # what a load moves by, and what is dissipated, are known to first order only
        first_order = system.load is not None or system.problem.adhesion.irreversible
        trifle = 0.0 if first_order else _TRIFLE
        # the tangent was made for the last step: if that has snapped on, slopes are of states before
        last = None if self.memory is not None and self.memory.steps == 1 else last
        result = self._solve(guess, parameter, last, self._settings.tolerance, trifle)
        if result is None:
            self.forget()
        return result

    def finish(
        self, made_at: FloatArray, matrix: BandMatrix, start: FloatArray, parameter: float
    ) -> NewtonResult | None:
        """End what Newton's method has begun: see `isopeel.solve.newton.Finish`."""
        try:
            made = approximate(matrix)
        except NotPositiveDefiniteError:
            return None
        self._factor, self._softest = made.factor, (made.soft, made.needed)
        self.memory = Memory(made_at, parameter, self._system.openings, LbfgsPairs.none(len(start)))
        result = self._solve(start, parameter, None, _EXACT * self._settings.tolerance, 0.0)
        if result is None:
            self.forget()
        return None if result is None else replace(result, exact=True, definite=True)

    def _solve(
        self, guess: FloatArray, parameter: float, last: FloatArray | None, tolerance: float, trifle: float
    ) -> NewtonResult | None:
        self._is_new = False
        try:
            factor, memory = self._kept_tangent(guess, parameter)
        except NotPositiveDefiniteError:
            return None
        system, count = self._system, len(guess)
        load = 0.0 if system.load is None else parameter
        moved, external = system.constraints.moved(parameter), system.external(load)
        u, forces = np.empty((2, *system.constraints.unknowns.shape))
        at = Iterate(guess.copy(), u, forces, np.empty(count))
        # as those of a step are: loops are compiled anew for arrays that can be written to
        last = (guess if last is None else last).view()
        last.setflags(write=False)
        measures = np.empty(_MOST_CORRECTIONS)
        made, threshold = 0, tolerance * system.energy_scale
        while True:
            pairs = memory.pairs.with_room(_MOST_CORRECTIONS)
            outcome, made, first, end, threshold, energies = corrected(
                system.equations,
                system.openings.ravel(),
                moved,
                external,
                factor.values,
                factor.starts,
                pairs.rows,
                pairs.products,
                pairs.first,
                pairs.end,
                at,
                last,
                measures,
                made,
                threshold,
                trifle,
            )
            if outcome == _POORLY and memory.steps > 0:
                # the tangent is of another step: one of this step may do
                try:
                    factor, memory = self._new_tangent(at.unknown_values.copy(), parameter)
                except NotPositiveDefiniteError:
                    return None
            elif outcome == _CONVERGED and energies[3] > 0:
                pairs = LbfgsPairs(pairs.rows, pairs.products, first, end)
                self.memory = memory.followed_by(pairs, slow=made > _SLOW)
                equilibrium = Equilibrium(*energies, at.forces, at.residual)
                iterations = tuple(measures[:made].tolist())
                definite = True if self._is_new else None
                return NewtonResult(at.unknown_values, u, load, equilibrium, iterations, False, definite)
            else:
                return None

    def _kept_tangent(self, guess: FloatArray, parameter: float) -> tuple[BandCholesky, Memory]:
        """The factor of the tangent that is kept, or of a new one at a guess where that has served enough."""
        memory = self.memory
        if memory is None or memory.slow or memory.steps >= _MOST_STEPS:
            return self._new_tangent(guess, parameter)
        if self._factor is None:
            self._factor = self._made(memory)
        return self._factor, memory

    def _new_tangent(self, y: FloatArray, parameter: float) -> tuple[BandCholesky, Memory]:
        memory = Memory(y, parameter, self._system.openings, LbfgsPairs.none(len(y)))
        self._factor = self._made(memory)
        self._is_new = True
        return self._factor, memory

    def _made(self, memory: Memory) -> BandCholesky:
        u, load = self._system.state(memory.unknown_values, memory.parameter)
        made = approximate(self._system.linearize(u, "symmetric", load, memory.openings)[1])
        self._softest = made.soft, made.needed
        return made.factor


@compiled_reordered
def corrected(
    equations: Equations,
    history: FloatArray,
    moved: FloatArray,
    external: FloatArray,
    values: Floats,
    starts: IntArray,
    rows: Singles,
    products: FloatArray,
    first: int,
    end: int,
    at: Iterate,
    last: FloatArray,
    measures: FloatArray,
    made: int,
    threshold: float,
    trifle: float,
) -> tuple[int, int, int, int, float, Energies]:
    """Correct unknowns until they are converged, or a second correction is poor, or all have been made.

    Told are what the equations ask for at the parameter (see `evaluate`), the factor, the pairs, the unknowns
    of the last step, and what was `made` of the corrections with another tangent before: their energy
    residuals are the first of `measures`. Returns what has become of it, the number of corrections, first and
    end of the pairs, the threshold, which the first correction may tighten, and the energies.

    These, forces and residual are those before the last correction where that is a `trifle` of the threshold.
    """
    y, residual = at.unknown_values, at.residual
    count = len(y)
    correction, change = np.empty(count), np.empty(count)
    energies = (0.0, 0.0, 0.0, 0.0)
    if made == 0:
        energies = evaluate(equations, history, moved, external, at)
    poor, before = 0, made
    while made < len(measures):
        correct(values, starts, rows, products, first, end, residual, correction)
        measure = abs(_product(residual, correction)) / count
        if made == 0 and not _foreseen(y, correction, last):
            threshold *= _SHARE
        if not np.isfinite(measure):
            break
        if made > before and not measure < max(_POOR * measures[made - 1], threshold):
            poor += 1
            if poor > 1:
                return _POORLY, made, first, end, threshold, energies
        measures[made] = measure
        made += 1
        for i in range(count):
            y[i] += correction[i]
            change[i] = -residual[i]
        # with the tangent of before, forces were asked for elsewhere
        if measure <= trifle * threshold and (before == 0 or made > before + 1):
            displace(equations.unknowns, y, equations.offset, equations.driven, moved, at.displacement)
            return _CONVERGED, made, first, end, threshold, energies
        energies = evaluate(equations, history, moved, external, at)
        finite = True
        for i in range(count):
            change[i] += residual[i]
            finite &= np.isfinite(residual[i])
        first, end = follow(rows, products, first, end, correction, change)
        slow = made > before + 1 and measure * measure > _LEFT * threshold * measures[made - 2]
        if measure <= threshold and not slow:
            return (_CONVERGED if finite else _NOWHERE), made, first, end, threshold, energies
    return _NOWHERE, made, first, end, threshold, energies


@compiled_reordered
def _product(one: FloatArray, other: FloatArray) -> float:
    total = 0.0
    for i in range(len(one)):
        total += one[i] * other[i]
    return total


@compiled_reordered
def _foreseen(guess: FloatArray, correction: FloatArray, last: FloatArray) -> bool:
    """Whether the first correction of a guess (count,) is little of the way from the last state."""
    largest, way = 0.0, 0.0
    for i in range(len(guess)):
        largest = max(largest, abs(correction[i]))
        way = max(way, abs(guess[i] - last[i]))
    return largest < _FORESEEN * way
