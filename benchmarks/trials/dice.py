"""Random choices of one case."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from trials.quantities import FORCES, LENGTHS, STRESSES, WORKS, rounded, written

T = TypeVar("T")


@dataclass(frozen=True)
class Dice:
    """A source of random choices; numbers are rounded to four digits, as they are written in the case."""

    random: np.random.Generator

    def between(self, low: float, high: float) -> float:
        """Return a uniform number between two numbers."""
        return rounded(float(self.random.uniform(low, high)))

    def decades(self, low: float, high: float) -> float:
        """Return a number between two numbers, whose logarithm is uniform."""
        return rounded(float(np.exp(self.random.uniform(np.log(low), np.log(high)))))

    def pick(self, choices: Sequence[T]) -> T:
        """Return one of several values, each with the same probability."""
        return choices[int(self.random.integers(len(choices)))]

    def chance(self, share: float) -> bool:
        """Return whether an event of this probability happens."""
        return bool(self.random.random() < share)

    def length(self, metres: float) -> str:
        """Write a length."""
        return written(self.random, metres, LENGTHS)

    def stress(self, pascals: float) -> str:
        """Write a stress."""
        return written(self.random, pascals, STRESSES)

    def work(self, joules_per_area: float) -> str:
        """Write an energy per area."""
        return written(self.random, joules_per_area, WORKS)

    def force(self, newtons_per_width: float) -> str:
        """Write a force per width."""
        return written(self.random, newtons_per_width, FORCES)
