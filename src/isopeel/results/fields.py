"""Which states of a run are kept with their fields."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from isopeel.common.arrays import FloatArray

_ROUND_OFF = 1e-9


class StoredState(NamedTuple):
    """The state of a step, by its number: its parameter, in the unit of the curve's column, and its fields.

    They are the displacement coefficients (functions, 2), and the maximum openings at the Gauss points of the
    interface, (elements, points).
    """

    step: int
    parameter: float
    displacement: FloatArray
    maximum_openings: FloatArray


class KeptStates:
    """What is kept of the states that come.

    They are those of the first step at or beyond each multiple of an interval, and of the last step.
    """

    def __init__(self, interval: float, states: Iterable[StoredState] = ()) -> None:
        """Take what was kept before."""
        self._interval = interval
        self._passed: float | None = None
        self._kept: list[StoredState] = []
        self._last: StoredState | None = None
        for state in states:
            self.take(state)

    def take(self, state: StoredState) -> None:
        """Keep one until the next one comes, or for good."""
        passed = float(np.floor(abs(state.parameter) / self._interval + _ROUND_OFF))
        self._last = state
        if passed != self._passed:
            self._kept.append(state)
            self._passed = passed

    def all(self) -> tuple[StoredState, ...]:
        """Those kept, and the last one."""
        if self._last is None or self._last is self._kept[-1]:
            return tuple(self._kept)
        return (*self._kept, self._last)
