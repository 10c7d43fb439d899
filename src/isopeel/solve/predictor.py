"""Predictors along a path: start values of the next step, and the slope of the path.

A path is a curve (p(s), y(s)) of parameter and unknowns over a path measure s. Polynomials in s through the
accepted states are extrapolated to the place where p(s) is the requested parameter. The parameter itself may
be s. Where a front peels, the adhesive energy is the better path measure: it grows steadily with the front,
while the parameter is stationary at limit points. The best predictor is often the translation of the states
one element before.
"""

from collections.abc import Mapping

import numpy as np
from scipy.linalg.blas import daxpy, ddot

from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import compiled
from isopeel.solve.polynomials import lagrange, slope
from isopeel.solve.predictor_selection import select_predictor
from isopeel.solve.step import AcceptedState
from isopeel.solve.translation_predictor import TranslationPredictor

#: Number of accepted states that are stored: those of two elements and some more. A front of the published
#: study passes an element in 9 to 14 steps.
MOST_STORED_STATES = 36
#: Most states from which a slope is computed: more of them gain nothing over their own errors.
SLOPE_STATES = 5
#: Approximate number of places along the adhesive side where states are compared.
_PLACES = 100
#: Rows of the arrays of data of states: those beyond the stored states are room for the next.
_ROWS = 3 * MOST_STORED_STATES


class Predictor:
    """The last accepted states of a path, and their extrapolation."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._translation = TranslationPredictor.of(system)
        sides = [term.table.functions.ravel() for term in system.interfaces]
        if not sides:
            # states are compared along the driven sides
            driven = [one.boundary for one in system.problem.driven]
            sides = [system.spaces.side(boundary.body, boundary.side) for boundary in driven]
        side = np.unique(np.concatenate(sides))
        ahead = side if self._translation is None else self._translation.ahead[side]
        self._functions = np.stack([side, ahead])
        # second differences are unchanged by a rotation of the whole body, which would dominate
        self._order = min(2, len(side) - 1)
        self._every = 1 + len(side) // _PLACES
        #: The newest at the end.
        self.states: list[AcceptedState] = []
        # the data of the states are the last of `end` rows: parameters, as they are and translated, and
        # adhesive energies; and bends, as they are and translated
        self._end = 0
        self._numbers = np.empty((3, _ROWS))
        self._bends = np.empty((_ROWS, 2, 2 * -(-(len(side) - self._order) // self._every)))
        self._displacement = np.empty((0, 2))  # of the last state
        # whether the adhesive energy was the selected path measure at the last guess
        self._by_energy = False

    @property
    def _rows(self) -> slice:
        """Rows of the data of the states."""
        return slice(self._end - len(self.states), self._end)

    def add(self, state: AcceptedState, displacement: FloatArray) -> None:
        """Store an accepted state, whose coefficients are the displacement (size, 2)."""
        parameter, translation = state.parameter, self._translation
        # if a drive turns back and meets a parameter again, only the last state there is stored
        (known,) = np.nonzero(self._numbers[0, self._rows] != parameter)
        if self._end == _ROWS or len(known) < len(self.states):
            rows = self._rows.start + known
            self.states, self._end = [self.states[k] for k in known], len(known)
            self._numbers[:, : self._end] = self._numbers[:, rows]
            self._bends[: self._end] = self._bends[rows]
        self.states = [*self.states[1 - MOST_STORED_STATES :], state]
        ahead = np.nan if translation is None else translation.parameter(parameter, displacement)
        for row, number in enumerate((parameter, ahead, state.adhesive_energy)):
            self._numbers[row, self._end] = number
        _bend(displacement, self._functions, self._order, self._every, self._bends[self._end])
        self._end += 1
        self._displacement = displacement

    def clear(self) -> None:
        """Drop all states."""
        self.states, self._end = [], 0

    def guess(self, parameter: float) -> FloatArray:
        """Return the predicted unknowns (count,) at a parameter; zeros without a state."""
        guess = np.zeros(self._system.count)
        if not self.states:
            return guess
        rows = self._rows
        parameters, ahead, energies = self._numbers
        weights, self._by_energy = select_predictor(
            parameters[rows],
            ahead[rows],
            energies[rows],
            self._bends[rows],
            parameter,
        )
        if self._translation is not None and weights[1].any():
            self._add(weights[1], guess)
            guess = self._translation.change(guess, self._displacement)
        self._add(weights[0], guess)
        return guess

    def _add(self, weights: FloatArray, values: FloatArray) -> None:
        for weight, state in zip(weights.tolist(), self.states, strict=True):
            if weight:
                daxpy(state.unknown_values, values, a=weight)

    def slope(self, covector: FloatArray) -> float:
        """Return the derivative of covector (count,) . unknowns by the parameter, at the last state."""
        last = self.states[-SLOPE_STATES:]
        parameters, _, energies = self._numbers[:, self._end - len(last) : self._end]
        values = np.array([ddot(covector, state.unknown_values) for state in last])
        return float(slope(energies if self._by_energy else parameters, parameters, values))


def extrapolate(history: Mapping[float, FloatArray], parameter: float, count: int) -> FloatArray:
    """Return the unknowns (count,) at a parameter, by the polynomial through the states of a history.

    The history maps parameters to unknowns (count,). Lagrange's formula; zeros where there is no state.
    """
    start = np.zeros(count)
    nodes, basis = np.array(list(history), np.float64), np.empty((2, len(history)))
    lagrange(nodes, 0, len(nodes), parameter, basis)
    for weight, values in zip(basis[0].tolist(), history.values(), strict=True):
        start += weight * values
    return start


@compiled
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
