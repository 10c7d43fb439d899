"""Which displacements of a run are kept."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from isopeel.common.arrays import FloatArray

_ROUND_OFF = 1e-9


class Fields:
    """The displacements kept of those that come, by their parameter.

    They are those of the first step at or beyond each multiple of an interval, and of the last step.
    """

    def __init__(self, interval: float) -> None:
        self._interval = interval
        self._passed: float | None = None
        self._kept: dict[float, FloatArray] = {}
        self._last: dict[float, FloatArray] = {}

    def take(self, parameter: float, displacement: FloatArray) -> None:
        """Keep one until the next one comes, or for good."""
        self._last = {parameter: displacement}
        passed = float(np.floor(abs(parameter) / self._interval + _ROUND_OFF))
        if passed != self._passed:
            self._kept |= self._last
            self._passed = passed

    def take_all(self, displacements: Mapping[float, FloatArray]) -> None:
        """Take what was kept before."""
        for parameter, displacement in displacements.items():
            self.take(parameter, displacement)

    def all(self) -> Mapping[float, FloatArray]:
        """Those kept, and the last one."""
        return MappingProxyType(self._kept | self._last)
