"""The selection of the states of a run that are stored with their fields."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple, Self

import numpy as np

from isopeel.common.arrays import FloatArray, frozen
from isopeel.problem import Drive
from isopeel.solve.step import Step

_ROUND_OFF = 1e-9


class StoredState(NamedTuple):
    """The state of a step, by its number: its parameter, in the unit of the curve's column, and its fields.

    The fields are the displacement coefficients (functions, 2) of all bodies, and the maximum openings at the
    Gauss points of the interfaces, (elements, points), as in a step. Only irreversible adhesion needs the
    openings.
    """

    step: int
    parameter: float
    displacement: FloatArray
    maximum_openings: FloatArray = frozen(np.empty((0, 0)))

    @classmethod
    def of(cls, step: Step, drive: Drive) -> Self:
        """Return the state of a step of a drive."""
        parameter = float(drive.parameter_column.shown(step.parameter))
        return cls(step.number, parameter, step.displacement, step.maximum_openings)


def nearest(states: Sequence[StoredState], parameter: float) -> StoredState:
    """Return the state nearest to a parameter; of several at one parameter, the last."""
    return min(reversed(states), key=lambda state: abs(state.parameter - parameter))


class KeptStates:
    """The selected states: of the first step at or beyond each multiple of an interval, and the last one."""

    def __init__(self, interval: float, states: Iterable[StoredState] = ()) -> None:
        """Begin with the states that were selected before."""
        self._interval = interval
        self._passed: float | None = None
        self._kept: list[StoredState] = []
        self._last: StoredState | None = None
        for state in states:
            self.take(state)

    def take(self, state: StoredState) -> None:
        """Add a state: until the next one is added, or permanently."""
        passed = float(np.floor(abs(state.parameter) / self._interval + _ROUND_OFF))
        self._last = state
        if passed != self._passed:
            self._kept.append(state)
            self._passed = passed

    def all(self) -> tuple[StoredState, ...]:
        """Return the selected states, and the last one."""
        if self._last is None or self._last is self._kept[-1]:
            return tuple(self._kept)
        return (*self._kept, self._last)
