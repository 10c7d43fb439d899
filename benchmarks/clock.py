"""What a load step calls, how often, and how long it takes."""

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from time import perf_counter
from typing import Any
from unittest.mock import patch

from isopeel.assembly.system import System
from isopeel.solve import quasi_newton
from isopeel.solve.blocks import BlockedFactor
from isopeel.solve.pairs import Pairs
from isopeel.solve.predictor import Predictor

#: The parts of a load step, by what is called for each.
PARTS = ("forces", "tangent", "factor", "solve", "update", "state", "guess")


class Clock:
    """Calls and seconds of each part; what one part calls of another counts for the latter alone."""

    def __init__(self) -> None:
        self.calls: Counter[str] = Counter()
        self.seconds: defaultdict[str, float] = defaultdict(float)
        self._inner: list[float] = []

    @contextmanager
    def running(self) -> Iterator[None]:
        """Watch all parts of what is traced meanwhile."""
        with ExitStack() as watched:
            for owner, name, part in (
                (System, "equilibrium", "forces"),
                (System, "linearize", "tangent"),
                (BlockedFactor, "solve", "solve"),
                (quasi_newton, "approximate", "factor"),
                (Pairs, "correction", "update"),
                (System, "state", "state"),
                (Predictor, "guess", "guess"),
            ):
                watched.enter_context(patch.object(owner, name, self._watched(part, getattr(owner, name))))
            yield

    def _watched(self, part: str, function: Callable[..., Any]) -> Callable[..., Any]:
        def call(*arguments: Any, **named: Any) -> Any:
            self._inner.append(0.0)
            began = perf_counter()
            try:
                return function(*arguments, **named)
            finally:
                taken = perf_counter() - began
                self.calls[part] += 1
                self.seconds[part] += taken - self._inner.pop()
                if self._inner:
                    self._inner[-1] += taken

        return call
