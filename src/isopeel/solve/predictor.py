"""Start values along a path, and what its past tells of its slope.

A path is a curve (p(s), y(s)): parameter and unknowns. Polynomials in s through its last points lead on, to
where p(s) is the parameter that is asked for. The parameter itself may be s. Where a front peels, the
adhesive energy is the better measure of the way: it grows steadily with the front, while the parameter halts
at limit points, and hesitates near them. Best of all is what the front did on the element before.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from scipy.linalg.blas import daxpy

from isopeel.arrays import FloatArray
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


class Predictor:
    """The last states of a path, and where they lead to."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._advance = Advance.of(system)
        side = np.unique(system.adhesive.functions)
        self._functions = np.stack([side, side if self._advance is None else self._advance.ahead[side]])
        #: The newest at the end.
        self.states: list[Past] = []
        self._notes: list[_Note] = []
        self._displacement = np.empty((0, 2))  # of the last state
        # whether the adhesive energy was the better measure of the way at the last guess
        self._by_energy = False

    def remember(self, state: Past, displacement: FloatArray) -> None:
        """Take a state, of coefficients u (size, 2)."""
        parameter, advance = state.parameter, self._advance
        ahead = np.nan if advance is None else advance.parameter(parameter, displacement)
        # a turn of the body as a whole, which dwarfs all else, leaves second differences as they are
        order = min(2, self._functions.shape[1] - 1)
        every = 1 + self._functions.shape[1] // _PLACES
        bends = np.diff(displacement[self._functions], order, axis=1)[:, ::every]
        # a drive that turns back meets a parameter again: its last state counts
        known = [k for k, other in enumerate(self.states) if other.parameter != parameter]
        known = known[1 - STATES_TO_GO_ON :]
        self.states = [*(self.states[k] for k in known), state]
        self._notes = [*(self._notes[k] for k in known), _Note(ahead, bends.reshape(1, 2, -1))]
        self._displacement = displacement

    def forget(self) -> None:
        """Leave all states."""
        self.states, self._notes = [], []

    def guess(self, parameter: float) -> FloatArray:
        """Unknowns (count,) that the path leads to; zeros without a state."""
        guess = np.zeros(self._system.count)
        if not self.states:
            return guess
        weights, self._by_energy = best_weights(
            np.array([[past.parameter for past in self.states], [note.ahead for note in self._notes]]),
            np.array([past.adhesive_energy for past in self.states]),
            np.concatenate([note.bends for note in self._notes]),
            parameter,
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
        parameters = np.array([past.parameter for past in last])
        way = np.array([past.adhesive_energy for past in last]) if self._by_energy else parameters
        return slope(way, parameters, np.array([covector @ past.unknown_values for past in last]))


class _Note(NamedTuple):
    """Of a state: its parameter when it is carried on, and its bends (1, 2, m), as it is and carried on."""

    ahead: float
    bends: FloatArray


def extrapolate(history: Mapping[float, FloatArray], parameter: float, count: int) -> FloatArray:
    """Evaluate the polynomial in the parameter through past states: unknowns (count,) at each parameter.

    Lagrange's formula; zeros where there is no past state.
    """
    start = np.zeros(count)
    weights = _lagrange(np.array(list(history)), parameter)
    for weight, values in zip(weights, history.values(), strict=True):
        start += weight * values
    return start


def slope(way: FloatArray, parameters: FloatArray, values: FloatArray) -> float:
    """Derivative by the parameter of what has these values (n,) at the states of a path, at the last of them.

    That of the polynomial in the way through the last states, up to SLOPE_STATES, along which it has grown or
    fallen steadily. Zero where there is no state before the last, and at a limit point of the parameter,
    where there is no such derivative.
    """
    way = way[-SLOPE_STATES:]
    steps = np.diff(way)
    (turns,) = np.nonzero(steps * steps[-1:] <= 0)
    count = len(way) - (turns[-1] + 1 if len(turns) else 0)
    if count < 2:
        return 0.0
    *past, last = way[-count:]
    nodes = np.array(past)
    # of the polynomial (s - last) q(s) + f(last), with q through the difference quotients
    weights = _lagrange(nodes, last) / (nodes - last)
    along, parameter = (float(weights @ (f[-count:-1] - f[-1])) for f in (values, parameters))
    # of which the last step tells the sign
    onwards = parameter * steps[-1] * (parameters[-1] - parameters[-2]) > 0
    return along / parameter if onwards else 0.0


def _lagrange(nodes: FloatArray, at: float) -> FloatArray:
    """Values at a point of Lagrange's polynomials of nodes (n,)."""
    differences = nodes[:, None] - nodes
    np.fill_diagonal(differences, 1.0)
    factors = (at - nodes) / differences
    np.fill_diagonal(factors, 1.0)
    weights: FloatArray = factors.prod(axis=1)
    return weights
