"""The selection of the displacements of a run that are stored."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Generic, NamedTuple, TypeVar

import numpy as np

from isopeel.common.arrays import FloatArray

_ROUND_OFF = 1e-9


class Field(NamedTuple):
    """The displacement coefficients (functions, 2) of a state, and its maximum openings (E, Q)."""

    displacement: FloatArray
    maximum_openings: FloatArray


Kept = TypeVar("Kept")


class Fields(Generic[Kept]):
    """The states of a run that are stored, by their parameter.

    They are the states of the first step at or beyond each multiple of an interval, and of the last step.
    """

    def __init__(self, interval: float) -> None:
        self._interval = interval
        self._passed: float | None = None
        self._kept: dict[float, Kept] = {}
        self._last: dict[float, Kept] = {}

    def take(self, parameter: float, state: Kept) -> None:
        """Store a state: for good where it is selected, else until the next one."""
        self._last = {parameter: state}
        passed = float(np.floor(abs(parameter) / self._interval + _ROUND_OFF))
        if passed != self._passed:
            self._kept |= self._last
            self._passed = passed

    def take_all(self, states: Mapping[float, Kept]) -> None:
        """Take the states that were stored before."""
        for parameter, state in states.items():
            self.take(parameter, state)

    def all(self) -> Mapping[float, Kept]:
        """Return the selected states and the last one, by parameter."""
        return MappingProxyType(self._kept | self._last)
