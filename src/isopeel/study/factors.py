"""The factors of a study: keys of a case, and the values that each of them takes."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from isopeel.common.units import measured_as, unit_of

#: What a key of a case may be.
Value: TypeAlias = str | float | bool | list[object] | dict[str, object]


@dataclass(frozen=True)
class Scale:
    """How the values of a factor are shown: as numbers in a unit, or as names where there is none."""

    unit: str | None

    @classmethod
    def of(cls, values: Sequence[Value]) -> "Scale":
        """Return the scale of values: the unit of the first one, if all are numbers or quantities."""
        if all(_is_number(value) for value in values):
            return cls("")
        first = values[0]
        if not isinstance(first, str):
            return cls(None)
        try:
            unit = unit_of(first)
            for value in values:
                measured_as(str(value), unit)
        except ValueError:
            return cls(None)
        return cls(unit)

    def number(self, value: Value) -> float | None:
        """Return a value in the unit; None for a name."""
        if self.unit is None:
            return None
        return measured_as(str(value), self.unit) if self.unit else float(str(value))


@dataclass(frozen=True)
class Listed:
    """Values one by one."""

    values: tuple[Value, ...]

    def at(self, share: float) -> Value:
        """Return the value at a share in [0, 1) of a sample: each value has an equal part of it."""
        return self.values[min(int(share * len(self.values)), len(self.values) - 1)]


@dataclass(frozen=True)
class Range:
    """Values between two ends, which are numbers in a unit; the empty unit is that of plain numbers."""

    lower: float
    upper: float
    unit: str
    count: int
    logarithmic: bool

    @property
    def values(self) -> tuple[Value, ...]:
        """Return the values at equal distances, or at equal ratios."""
        spaced = np.geomspace if self.logarithmic else np.linspace
        return tuple(self._written(number) for number in spaced(self.lower, self.upper, self.count).tolist())

    def at(self, share: float) -> Value:
        """Return the value at a share in [0, 1) of a sample."""
        if self.logarithmic:
            return self._written(float(self.lower * (self.upper / self.lower) ** share))
        return self._written(self.lower + (self.upper - self.lower) * share)

    def _written(self, number: float) -> Value:
        # the same text for numbers that differ by round-off alone
        rounded = float(f"{number:.12g}")
        return f"{rounded!r} {self.unit}" if self.unit else rounded


@dataclass(frozen=True)
class Factor:
    """A key of the case, and its values; factors of the same `zip` change together."""

    key: str
    values: Listed | Range
    zip: str = ""

    @property
    def scale(self) -> Scale:
        """How its values are shown."""
        return Scale.of(self.values.values)

    @property
    def heading(self) -> str:
        """The heading of its column: the key, and the unit in brackets."""
        unit = self.scale.unit
        return f"{self.key} [{unit}]" if unit else self.key

    @property
    def ends(self) -> tuple[Value, ...]:
        """The values whose check shows whether the key and its kind of value exist."""
        values = self.values.values
        return values if isinstance(self.values, Listed) else (values[0], values[-1])


def _is_number(value: Value) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
