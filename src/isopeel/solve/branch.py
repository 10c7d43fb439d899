"""The branch of equilibria inside a step, and where it ends."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from isopeel.solve.augmentation import augmented
from isopeel.solve.balance import CUBIC, MISFIT, ROUND_OFF, Misfit, misfit, simpson_misfits
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.newton import NewtonResult, newton
from isopeel.solve.path import Path
from isopeel.solve.predictor import extrapolate
from isopeel.solve.step import PARABOLA_POINTS, AcceptedState, Found

#: Two states lie on different branches where they differ by more than this share of the change of the
#: unknowns in the step. The same states, found by one step and by many, differed by up to 1.2e-6 in 96 steps
#: of tapes, cylinders, pads and stamps.
_ELSEWHERE = 0.01
#: Share of a step below which its rest is round-off.
LEAST_REST = 1e-9
#: Most halvings of a step to follow its branch, where its energy does not seem to come from the work.
_DEEPEST = 6
#: Most bisections of a step to find a smooth branch inside it: a step over two or three elements takes all.
_BISECTIONS = 3


class End(NamedTuple):
    """The end of a branch: it lies between its last known state and a parameter beyond without a state."""

    last: float
    beyond: float


class Branch:
    """The branch of the last accepted state of a path, inside the next step.

    Its results are for that step only. The caller passes the end of the branch to the next step, but not
    beyond the next requested parameter: so a path that continues from there has the same results.
    """

    def __init__(self, path: Path, end: End | None = None) -> None:
        #: Where the branch ends, if that is known.
        self.end: End | None = end
        self._path = path
        self._continues = False
        self._followed: tuple[float, bool, list[Found]] | None = None

    def assume_continues(self) -> None:
        """Assume in this step that the branch continues beyond its known end."""
        self.end, self._continues = None, True

    def end_before(self, parameter: float) -> End | None:
        """Return the end of the branch where it is known to lie before a parameter, else None."""
        end, history = self.end, self._path.history
        if end is None or not history:
            return None
        forwards = np.sign(end.beyond - end.last)
        ahead = (end.last - history[-1].parameter) * forwards >= 0
        return end if ahead and (parameter - end.beyond) * forwards >= 0 else None

    def verified(self, found: Found, whole: Misfit, *, by_order: bool) -> tuple[Misfit, list[Found]]:
        """Return the misfit of a step, and the smaller steps along its branch where they were computed.

        The misfit of its ends, `whole`, is too large. So the branch is followed by smaller steps as far as it
        goes. If it reaches the same state, the step is right. If it ends earlier, the body has jumped from
        there, with the work of the drive up to there.
        """
        path = self._path
        if not path.history or path.history[-1].parameter == found.parameter:
            return whole, []
        one, other = path.history[-1], path.accepted_state(found.result)
        if whole.is_slight and self._is_smooth(one, other, abs(whole.gained)):
            return whole._replace(gains=False, releases=False), []
        inside = self.followed(other.parameter, by_order=by_order, whole=whole)
        last = path.accepted_state(inside[-1].result) if inside else one
        rest = other.parameter - last.parameter
        gained = other.energy - last.energy - max(last.rate * rest, other.rate * rest)
        if rest:
            work = max(abs(one.rate), abs(other.rate)) * abs(other.parameter - one.parameter)
            releases = -gained > path.gain_allowed + MISFIT * work
            return Misfit(gained, gained > path.gain_allowed, releases), inside
        n = path.system.constraints.count
        apart, moved = (
            np.abs(other.unknown_values - state.unknown_values)[:n].max() for state in (last, one)
        )
        elsewhere = bool(apart > _ELSEWHERE * moved)
        gains = gained > path.gain_allowed
        return Misfit(gained, gains, elsewhere and not gains, whole.is_slight), inside

    def _is_smooth(
        self, one: AcceptedState, other: AcceptedState, missed: float, depth: int = _BISECTIONS
    ) -> bool:
        """Return whether one branch joins two states, by Simpson's rule over states between them.

        `missed` is the difference of energy and work between the two, by a rule of lower order. On one branch
        it falls with each bisection; across a jump it stays.
        """
        path = self._path
        middle = (one.parameter + other.parameter) / 2
        near = [*path.history[-PARABOLA_POINTS + 1 :], other] if one is path.history[-1] else [one, other]
        half = self._accepted_state_at(middle, near)
        if half is None:
            return False
        gained = simpson_misfits(one, half, other)
        most = max(abs(state.rate) for state in (one, half, other)) * abs(other.parameter - one.parameter)
        round_off = ROUND_OFF * max(abs(one.energy), abs(other.energy)) + path.round_off
        enough = path.allowance.of_step(most) + round_off
        for (first, last), rest in zip(pairwise((one, half, other)), gained, strict=True):
            if abs(rest) <= enough:
                continue
            if depth == 0 or abs(rest) > missed / 2 or not self._is_smooth(first, last, abs(rest), depth - 1):
                return False
        return True

    def followed(self, parameter: float, *, by_order: bool, whole: Misfit | None = None) -> list[Found]:
        """Return states on the branch towards a parameter, by halved steps, as far as the branch goes.

        With `by_order`, the error of the trapezoidal rule is recognized by its order where too few states are
        known to estimate it. `whole` is the misfit of the whole step, where that was computed.
        """
        path = self._path
        begin = path.history[-1].parameter
        if self._followed is not None and self._followed[:2] == (parameter, by_order):
            return self._followed[2]
        states, found = [*path.history], []
        size = step = parameter - begin
        # several steps make one, and share what it may gain
        allowed = path.allowance._replace(most=path.gain_allowed / 4)
        longer = np.inf  # misfit of a step of twice the size
        refused: float | None = None  # parameter at which a longer step found no equilibrium
        ends = False  # whether the shortest step has no equilibrium, or one of another branch
        if whole is not None and not by_order:
            size, longer = step / 2, abs(whole.gained)
        least = abs(step) / 2**_DEEPEST
        while (rest := parameter - states[-1].parameter) and abs(size) > least:
            size = rest if abs(size) >= (1 - LEAST_REST) * abs(rest) else size
            at = parameter if size == rest else states[-1].parameter + size
            if at == refused and abs(size) > 2 * least:
                size /= 2
                continue
            # the shortest steps have all corrections of Newton's method, before the branch counts as ended
            result = self._result_at(at, states[-PARABOLA_POINTS:], soon=abs(size) > 2 * least)
            if result is None:
                size, longer, refused, ends = size / 2, np.inf, at, True
                continue
            state = path.accepted_state(result)
            missed = misfit(states, state, allowed, path.round_off)
            smooth = by_order and missed.is_slight and abs(missed.gained) <= CUBIC * longer
            if missed.fits or smooth:
                states.append(state)
                found.append(Found(result, "between"))
                longer = np.inf
            else:
                ends = abs(missed.gained) > CUBIC * longer
                size, longer = size / 2, abs(missed.gained)
        if rest and ends and not self._continues:
            self.end = End(states[-1].parameter, states[-1].parameter + 2 * size)
        self._followed = parameter, by_order, found
        return found

    def _result_at(
        self, parameter: float, near: list[AcceptedState], *, soon: bool = True
    ) -> NewtonResult | None:
        """Return the equilibrium at a parameter, from the polynomial through some states, or None.

        With `soon`, Newton's method stops after few corrections.
        """
        path = self._path
        guess = extrapolate({state.parameter: state.exact for state in near}, parameter, path.system.count)
        settings = path.settings.with_few_corrections() if soon else path.settings
        try:
            found = newton(path.system, guess, parameter, settings)
            return augmented(path.system, found, settings)
        except ConvergenceError:
            return None

    def _accepted_state_at(self, parameter: float, near: list[AcceptedState]) -> AcceptedState | None:
        result = self._result_at(parameter, near)
        return None if result is None else self._path.accepted_state(result)
