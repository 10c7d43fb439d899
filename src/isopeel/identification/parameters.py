"""The parameters of a fit: keys of a case, with a start and bounds."""

from dataclasses import dataclass
from math import exp, inf, log
from typing import NamedTuple

from isopeel.study.factors import Value


@dataclass(frozen=True)
class Parameter:
    """A key of the case with a start and bounds, which are numbers in `unit`; plain numbers have no unit.

    The search changes its coordinate: 1 + ln(value / start) of a logarithmic parameter, value / |start| of
    another one.
    """

    key: str
    start: float
    unit: str = ""
    lower: float = -inf
    upper: float = inf
    logarithmic: bool = False

    def coordinate(self, value: float) -> float:
        """Return the coordinate of a value; a bound at zero of a logarithmic parameter is at -inf."""
        # coordinates near one: the first step of the search is limited to their norm
        if self.logarithmic:
            return 1.0 + log(value / self.start) if value > 0.0 else -inf
        return value / self._scale

    def value(self, coordinate: float) -> float:
        """Return the value at a coordinate."""
        if self.logarithmic:
            return self.start * exp(coordinate - 1.0)
        return coordinate * self._scale

    def slope(self, value: float) -> float:
        """Return d value / d coordinate."""
        return value if self.logarithmic else self._scale

    def written(self, value: float) -> Value:
        """Return a value as a case file has it."""
        return f"{value!r} {self.unit}" if self.unit else value

    def text(self, value: float, digits: int = 6) -> str:
        """Return a value with its unit, for tables and messages."""
        return f"{value:.{digits}g} {self.unit}".rstrip()

    @property
    def heading(self) -> str:
        """The key, and the unit in brackets."""
        return f"{self.key} [{self.unit}]" if self.unit else self.key

    @property
    def _scale(self) -> float:
        return abs(self.start) or 1.0


class Noise(NamedTuple):
    """The standard deviation of a measured value, in the unit of its column, or as a share of the largest."""

    value: float
    is_share: bool
