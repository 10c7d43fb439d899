"""Start values along a path, and what its past tells of its slope.

A path is a curve (p(s), y(s)): parameter and unknowns. Polynomials in s through its last points lead on, to
where p(s) is the parameter that is asked for. The parameter itself may be s. Where a front peels, the
adhesive energy is the better measure of the way: it grows steadily with the front, while the parameter halts
at limit points, and hesitates near them. Best of all is what the front did on the element before.
"""

from collections.abc import Mapping, Sequence
from math import prod

import numpy as np
from numba import njit
from scipy.linalg.blas import daxpy, ddot

from isopeel.arrays import FloatArray, IntArray
from isopeel.assembly.system import System
from isopeel.solve.advance import Advance
from isopeel.solve.leading import best_weights
from isopeel.solve.step import Past

#: States that are remembered: those of two elements and some more, of which a front of the published study
#: passes each in 9 to 14 steps.
STATES_TO_GO_ON = 36
#: States that a slope is taken from, at most: more of them gain nothing over their own errors.
SLOPE_STATES = 5
#: Places along the adhesive side where states are compared, about.
_PLACES = 100
#: Of notes of states: those beyond the remembered ones are room for the next.
_ROWS = 3 * STATES_TO_GO_ON

_compiled = njit(cache=True)


class Predictor:
    """The last states of a path, and where they lead to."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._advance = Advance.of(system)
        side = np.unique(system.adhesive.functions)
        self._functions = np.stack([side, side if self._advance is None else self._advance.ahead[side]])
        # a turn of the body as a whole, which dwarfs all else, leaves second differences as they are
        self._order = min(2, len(side) - 1)
        self._every = 1 + len(side) // _PLACES
        #: The newest at the end.
        self.states: list[Past] = []
        # notes of the states are the last of `end` rows: parameters, as they are and carried on, and adhesive
        # energies; bends, as they are and carried on
        self._end = 0
        self._numbers = np.empty((3, _ROWS))
        self._bends = np.empty((_ROWS, 2, 2 * -(-(len(side) - self._order) // self._every)))
        self._displacement = np.empty((0, 2))  # of the last state
        # whether the adhesive energy was the better measure of the way at the last guess
        self._by_energy = False

    def remember(self, state: Past, displacement: FloatArray) -> None:
        """Take a state, of coefficients u (size, 2)."""
        parameter, advance = state.parameter, self._advance
        # a drive that turns back meets a parameter again: its last state counts
        known = [k for k, other in enumerate(self.states) if other.parameter != parameter]
        if self._end == _ROWS or len(known) < len(self.states):
            rows = self._end - len(self.states) + np.array(known, np.int64)
            self._end = len(known)
            self._numbers[:, : self._end] = self._numbers[:, rows]
            self._bends[: self._end] = self._bends[rows]
        known = known[1 - STATES_TO_GO_ON :]
        self.states = [*(self.states[k] for k in known), state]
        ahead = np.nan if advance is None else advance.parameter(parameter, displacement)
        self._numbers[:, self._end] = parameter, ahead, state.adhesive_energy
        _bend(displacement, self._functions, self._order, self._every, self._bends[self._end])
        self._end += 1
        self._displacement = displacement

    def forget(self) -> None:
        """Leave all states."""
        self.states, self._end = [], 0

    def guess(self, parameter: float) -> FloatArray:
        """Unknowns (count,) that the path leads to; zeros without a state."""
        guess = np.zeros(self._system.count)
        if not self.states:
            return guess
        rows = slice(self._end - len(self.states), self._end)
        parameters, ahead, energies = self._numbers
        weights, self._by_energy = best_weights(
            parameters[rows], ahead[rows], energies[rows], self._bends[rows], parameter
        )
        if self._advance is not None and weights[1].any():
            self._add(weights[1], guess)
            guess = self._advance.change(guess, self._displacement)
        self._add(weights[0], guess)
        return guess

    def _add(self, weights: FloatArray, values: FloatArray) -> None:
        for weight, past in zip(weights.tolist(), self.states, strict=True):
            if weight:
                daxpy(past.unknown_values, values, a=weight)

    def slope(self, covector: FloatArray) -> float:
        """Derivative of covector (count,) . unknowns by the parameter, at the last state."""
        last = self.states[-SLOPE_STATES:]
        parameters = [past.parameter for past in last]
        way = [past.adhesive_energy for past in last] if self._by_energy else parameters
        return slope(way, parameters, [ddot(covector, past.unknown_values) for past in last])


def extrapolate(history: Mapping[float, FloatArray], parameter: float, count: int) -> FloatArray:
    """Evaluate the polynomial in the parameter through past states: unknowns (count,) at each parameter.

    Lagrange's formula; zeros where there is no past state.
    """
    start = np.zeros(count)
    weights = _lagrange(list(history), parameter)
    for weight, values in zip(weights, history.values(), strict=True):
        start += weight * values
    return start


def slope(way: Sequence[float], parameters: Sequence[float], values: Sequence[float]) -> float:
    """Derivative by the parameter of what has these values at the states of a path, at the last of them.

    That of the polynomial in the way through the last states, up to SLOPE_STATES, along which it has grown or
    fallen steadily. Zero where there is no state before the last, and at a limit point of the parameter,
    where there is no such derivative.
    """
    last = len(way) - 1
    first = last
    while first > max(0, last - SLOPE_STATES + 1) and (way[first] - way[first - 1]) * (way[-1] - way[-2]) > 0:
        first -= 1
    # of the polynomial (s - last) q(s) + f(last), with q through the difference quotients
    along = parameter = 0.0
    for k, value in enumerate(_lagrange(way[first:last], way[last]), start=first):
        weight = value / (way[k] - way[last])
        along += weight * (values[k] - values[last])
        parameter += weight * (parameters[k] - parameters[last])
    # of which the last step tells the sign
    onwards = last > 0 and parameter * (way[-1] - way[-2]) * (parameters[-1] - parameters[-2]) > 0
    return along / parameter if onwards else 0.0


def _lagrange(nodes: Sequence[float], at: float) -> list[float]:
    """Values at a point of Lagrange's polynomials of a few distinct nodes."""
    return [prod((at - other) / (node - other) for other in nodes if other != node) for node in nodes]


@_compiled
def _bend(displacement: FloatArray, functions: IntArray, order: int, every: int, bends: FloatArray) -> None:
    """Set bends (2, m) to differences of displacements along functions (2, n), at every so many of them."""
    places = bends.shape[1] // 2
    for kind in range(2):
        for place in range(places):
            f = functions[kind, place * every :]
            for i in range(2):
                bend = displacement[f[0], i]
                if order > 0:
                    bend = displacement[f[1], i] - bend
                if order > 1:
                    bend = displacement[f[2], i] - displacement[f[1], i] - bend
                bends[kind, 2 * place + i] = bend
