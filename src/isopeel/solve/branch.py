"""What a step leaves out: the branch of equilibria inside of it, and where that ends."""

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from isopeel.solve.balance import CUBIC, MISFIT, ROUND_OFF, Misfit, misfit, simpson_misfits
from isopeel.solve.newton import ConvergenceError, NewtonResult, NewtonSettings, newton
from isopeel.solve.predictor import extrapolate
from isopeel.solve.step import PARABOLA_POINTS, AcceptedState, Found

if TYPE_CHECKING:
    from isopeel.solve.path import Path

#: Of the change of the unknowns in a step: two states that differ by more are of two branches. The same ones,
#: found by one step and by many, differed by up to 1.2e-6 in 96 steps of tapes, cylinders, pads and stamps.
_ELSEWHERE = 0.01
#: Of what is left of a step: less than this is none.
LEAST_REST = 1e-9
#: Halvings of a step by which its branch is followed, where its energy does not seem to come from its work.
_DEEPEST = 6
#: Bisections of a step in which a smooth branch is looked for: a step over two or three elements takes all.
_BISECTIONS = 3
#: Corrections of Newton's method where a shorter step can be taken instead: where it converges it takes some
#: six. Past a limit point each costs a pivoted factor, and to exhaust them took nine tenths of the time.
SOON = 10


class End(NamedTuple):
    """Where a branch ends: between its last known state and a parameter beyond, where it has none."""

    last: float
    beyond: float


class Branch:
    """The branch that a path is on, inside of its next step.

    What it has found is forgotten at each requested parameter: a path that goes on from there has to find
    the same.
    """

    def __init__(self, path: "Path") -> None:
        self._path = path
        limit = min(SOON, path.settings.iteration_limit)
        self._settings: NewtonSettings = replace(path.settings, iteration_limit=limit)
        self._end: End | None = None
        self._goes_on = False
        self._followed: tuple[float, float, bool, list[Found]] | None = None

    def step(self) -> None:
        """Go on to a step of the path."""
        self._goes_on, self._followed = False, None

    def forget(self) -> None:
        """Forget where the branch ends, as another one begins or another parameter is asked for."""
        self._end = None

    def goes_on(self) -> None:
        """Take it that the branch goes on beyond its end, up to the next step."""
        self._end, self._goes_on = None, True

    def end_before(self, parameter: float) -> End | None:
        """The end of the branch, where it is known to lie before a parameter."""
        end, history = self._end, self._path.history
        if end is None or not history:
            return None
        forwards = np.sign(end.beyond - end.last)
        ahead = (end.last - history[-1].parameter) * forwards >= 0
        return end if ahead and (parameter - end.beyond) * forwards >= 0 else None

    def verified(self, found: Found, *, by_order: bool = False) -> tuple[Misfit, list[Found]]:
        """The misfit of a step, by the branch inside of it where the ends of the step do not suffice.

        The branch is followed by smaller steps as far as it goes, which are returned too. Where it comes to
        the same state, all is well. Where it ends before, the body has jumped there, with the work of the
        drive so far.
        """
        path = self._path
        whole = path.misfit(found)
        if whole.fits or not path.history or path.history[-1].parameter == found.parameter:
            return whole, []
        one, other = path.history[-1], path.accepted_state_of(found.result, found.parameter)
        if whole.is_slight and self._is_smooth(one, other, abs(whole.gained)):
            return whole._replace(gains=False, releases=False), []
        inside = self.followed(other.parameter, by_order=by_order, whole=whole)
        last = path.accepted_state_of(inside[-1].result, inside[-1].parameter) if inside else one
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
        """Whether one branch joins two states, as states between them tell by Simpson's rule.

        `missed` is what the energy between the two differs by from the work, by a rule of lower order. On
        one branch it falls with each bisection; across a jump it stays.
        """
        path = self._path
        middle = (one.parameter + other.parameter) / 2
        near = [*path.history[-PARABOLA_POINTS + 1 :], other] if one is path.history[-1] else [one, other]
        half = self._accepted_state_at(middle, near)
        if half is None:
            return False
        gained = simpson_misfits(one, half, other)
        most = max(abs(state.rate) for state in (one, half, other)) * abs(other.parameter - one.parameter)
        enough = min(path.gain_allowed, MISFIT * most) + ROUND_OFF * max(abs(one.energy), abs(other.energy))
        for (first, last), rest in zip(pairwise((one, half, other)), gained, strict=True):
            if abs(rest) <= enough:
                continue
            if depth == 0 or abs(rest) > missed / 2 or not self._is_smooth(first, last, abs(rest), depth - 1):
                return False
        return True

    def followed(self, parameter: float, *, by_order: bool, whole: Misfit | None = None) -> list[Found]:
        """States towards a parameter on the branch, by halved steps, as far as they go.

        Where too few states are known for the error of the trapezoidal rule, its `by_order` tells it. Of a
        step that was found whole, its misfit is known.
        """
        path = self._path
        begin = path.history[-1].parameter
        if self._followed is not None and self._followed[:3] == (begin, parameter, by_order):
            return self._followed[3]
        states, found = [*path.history], []
        size = step = parameter - begin
        longer = np.inf  # what a step of twice the size misses
        refused: float | None = None  # where no equilibrium was found from further away
        ends = False  # whether the shortest step has none, or one of another branch
        if whole is not None and not by_order:
            size, longer = step / 2, abs(whole.gained)
        least = abs(step) / 2**_DEEPEST
        while (rest := parameter - states[-1].parameter) and abs(size) > least:
            size = rest if abs(size) >= (1 - LEAST_REST) * abs(rest) else size
            at = parameter if size == rest else states[-1].parameter + size
            if at == refused and abs(size) > 2 * least:
                size /= 2
                continue
            # before the branch is said to end, Newton's method has all its corrections
            result = self._result_at(at, states[-PARABOLA_POINTS:], soon=abs(size) > 2 * least)
            if result is None:
                size, longer, refused, ends = size / 2, np.inf, at, True
                continue
            state = path.accepted_state_of(result, at)
            # some of these make one step
            missed = misfit(states, state, path.gain_allowed / 4)
            smooth = by_order and missed.is_slight and abs(missed.gained) <= CUBIC * longer
            if missed.fits or smooth:
                states.append(state)
                found.append(Found(at, result, "between"))
                longer = np.inf
            else:
                ends = abs(missed.gained) > CUBIC * longer
                size, longer = size / 2, abs(missed.gained)
        if rest and ends and not self._goes_on:
            self._end = End(states[-1].parameter, states[-1].parameter + 2 * size)
        self._followed = begin, parameter, by_order, found
        return found

    def _result_at(
        self, parameter: float, near: list[AcceptedState], *, soon: bool = True
    ) -> NewtonResult | None:
        """The equilibrium at a parameter from the polynomial through some states, if it comes `soon`."""
        path = self._path
        guess = extrapolate({state.parameter: state.exact for state in near}, parameter, path.system.count)
        try:
            return newton(path.system, guess, parameter, self._settings if soon else path.settings)
        except ConvergenceError:
            return None

    def _accepted_state_at(self, parameter: float, near: list[AcceptedState]) -> AcceptedState | None:
        result = self._result_at(parameter, near)
        return None if result is None else self._path.accepted_state_of(result, parameter)
