"""Newton's method with a tangent that is kept from step to step, and learns from the steps it has taken."""

from dataclasses import dataclass, replace
from math import isfinite

import numpy as np
from scipy.linalg.blas import idamax

from isopeel.arrays import FloatArray
from isopeel.assembly.system import Equilibrium, System
from isopeel.solve.blocks import NotPositiveDefiniteError
from isopeel.solve.linear import Factor, approximate
from isopeel.solve.newton import NewtonResult, NewtonSettings
from isopeel.solve.pairs import Pairs

#: Steps that one tangent serves.
_MOST_STEPS = 40
#: A step that takes more corrections is the last one of its tangent.
_SLOW = 6
_MOST_CORRECTIONS = 12
#: Of the tolerance, where a guess has missed more than this part of the way from the last state: the last
#: correction leaves a tenth of the error, where Newton's method squares it, and what is left turns up in
#: reactions as far as the path's slope is known no better. At 1e-3 one step of L4 at 200 x 10 elements missed
#: its moment by 1.4e-8 in one run of several; at this those of L1, L2 and L4 are met to 4e-9.
_SHARE = 1e-2
_FORESEEN = 3e-4
#: An energy residual that falls by less is a poor correction; the second one of a step ends it.
_POOR = 0.5


@dataclass(frozen=True, eq=False)
class Memory:
    """What is kept from step to step: where the tangent was made, and what was learned since.

    The tangent itself is not kept here: it follows from where it was made.
    """

    unknown_values: FloatArray  # (count,)
    parameter: float
    openings: FloatArray  # (E, Q), for irreversible adhesion
    pairs: Pairs
    steps: int = 0
    slow: bool = False  # the last step


class QuasiNewton:
    """The method of Broyden, Fletcher, Goldfarb and Shanno with limited memory, on a kept tangent.

    A residual is far cheaper than a tangent and its factor, and along a path the tangent changes little
    from step to step. So the factor of one tangent serves many steps; what has changed since is learned
    from the residuals (Matthies and Strang, Int. J. Numer. Methods Eng. 14, 1979). It ends as Newton's method
    does, with the first correction whose energy residual is below the tolerance, and gives up early where
    it does not converge well: Newton's method then decides.

    For systems whose forces have a potential, under no unknown load. Tangents lie in the array of the
    system, so that whoever makes another one must let this one `forget`.
    """

    def __init__(self, system: System, settings: NewtonSettings, memory: Memory | None = None) -> None:
        self._system = system
        self._settings = settings
        self._factor: Factor | None = None
        #: What goes on from here needs to do so bit for bit.
        self.memory: Memory | None = None if memory is None else replace(memory, pairs=memory.pairs.copy())

    @staticmethod
    def applies(system: System) -> bool:
        """Whether the tangent is symmetric, and positive definite where the body is stable."""
        return system.storage == "symmetric" and not system.load_is_unknown

    def forget(self) -> None:
        """Make a new tangent at the next step."""
        self.memory = self._factor = None

    def equilibrium(
        self, guess: FloatArray, parameter: float, last: FloatArray | None = None
    ) -> NewtonResult | None:
        """Find the equilibrium near a guess y (count,), one step from the last; None where Newton should."""
        result = self._solve(guess, parameter, last)
        if result is None:
            self.forget()
        return result

    def _solve(self, guess: FloatArray, parameter: float, last: FloatArray | None) -> NewtonResult | None:
        try:
            factor, memory = self._kept_tangent(guess, parameter)
        except NotPositiveDefiniteError:
            return None
        y, pairs = guess, memory.pairs
        u, load, at = self._at(y, parameter)
        threshold = self._settings.tolerance * self._system.energy_scale
        measures: list[float] = []
        poor = 0
        for _ in range(_MOST_CORRECTIONS):
            correction, measure = _correction(factor, pairs, at)
            if not measures and not _foreseen(guess, correction, last):
                threshold *= _SHARE
            # a residual that is not finite fails this test too
            poor += bool(measures) and not measure < max(_POOR * measures[-1], threshold)
            if poor > 1 and memory.steps > 0 and isfinite(measure):
                # the tangent is of another step: one of this step may do
                try:
                    (factor, memory), poor = self._new_tangent(y, parameter), 0
                    pairs = memory.pairs
                except NotPositiveDefiniteError:
                    return None
                correction, measure = _correction(factor, pairs, at)
            if not isfinite(measure) or poor > 1:
                return None
            measures.append(measure)
            y = y + correction
            before = at
            u, load, at = self._at(y, parameter)
            pairs = pairs.followed_by(correction, at.residual - before.residual)
            if measure <= threshold:
                if not (np.isfinite(at.residual).all() and at.lowest_determinant > 0):
                    return None
                slow = len(measures) > _SLOW
                self.memory = replace(memory, pairs=pairs, steps=memory.steps + 1, slow=slow)
                return NewtonResult(y, u, load, at, tuple(measures), exact=False)
        return None

    def _at(self, y: FloatArray, parameter: float) -> tuple[FloatArray, float, Equilibrium]:
        u, load = self._system.state(y, parameter)
        return u, load, self._system.equilibrium(u, load)

    def _kept_tangent(self, guess: FloatArray, parameter: float) -> tuple[Factor, Memory]:
        """The factor of the tangent that is kept, or of a new one at a guess where that has served enough."""
        memory = self.memory
        if memory is None or memory.slow or memory.steps >= _MOST_STEPS:
            return self._new_tangent(guess, parameter)
        if self._factor is None:
            self._factor = self._made(memory)
        return self._factor, memory

    def _new_tangent(self, y: FloatArray, parameter: float) -> tuple[Factor, Memory]:
        memory = Memory(y, parameter, self._system.openings, Pairs.none(len(y)))
        self._factor = self._made(memory)
        return self._factor, memory

    def _made(self, memory: Memory) -> Factor:
        u, load = self._system.state(memory.unknown_values, memory.parameter)
        return approximate(self._system.linearize(u, "symmetric", load, memory.openings)[1])


def _foreseen(guess: FloatArray, correction: FloatArray, last: FloatArray | None) -> bool:
    """Whether the first correction of a guess (count,) is little of the way from the last state."""
    if last is None:
        return False
    way = guess - last
    return bool(abs(correction[idamax(correction)]) < _FORESEEN * abs(way[idamax(way)]))


def _correction(factor: Factor, pairs: Pairs, at: Equilibrium) -> tuple[FloatArray, float]:
    """The correction of a state, and its energy residual per unknown."""
    correction = pairs.correction(factor, at.residual)
    return correction, abs(float(at.residual @ correction)) / len(correction)
