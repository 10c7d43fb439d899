"""What a load step calls, how often, and how long it takes."""

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from inspect import signature
from time import perf_counter
from typing import Any
from unittest.mock import patch

from isopeel.assembly.system import System
from isopeel.solve import quasi_newton
from isopeel.solve.predictor import Predictor

#: What is called within a load step. Corrections are one compiled loop, of forces, solutions and updates.
PARTS = ("corrections", "tangent", "factor", "guess")
#: Places of the loop's arguments, by name.
_PLACES = {name: k for k, name in enumerate(signature(quasi_newton.corrected).parameters)}


class Clock:
    """Calls and seconds of each part, and how often forces, solutions and updates were asked for."""

    def __init__(self) -> None:
        self.calls: Counter[str] = Counter()
        self.seconds: defaultdict[str, float] = defaultdict(float)

    @contextmanager
    def running(self) -> Iterator[None]:
        """Watch all parts of what is traced meanwhile."""
        with ExitStack() as watched:
            for owner, name, part in (
                (quasi_newton, "corrected", "corrections"),
                (System, "linearize", "tangent"),
                (quasi_newton, "approximate", "factor"),
                (Predictor, "guess", "guess"),
            ):
                watched.enter_context(patch.object(owner, name, self._watched(part, getattr(owner, name))))
            yield

    def _watched(self, part: str, function: Callable[..., Any]) -> Callable[..., Any]:
        def call(*arguments: Any, **named: Any) -> Any:
            began = perf_counter()
            found = function(*arguments, **named)
            self.seconds[part] += perf_counter() - began
            self.calls[part] += 1
            if part == "corrections":
                before, measures, skip_share = (
                    arguments[_PLACES[name]] for name in ("made", "measures", "skip_share")
                )
                made, threshold = found[1], found[4]
                self._count(
                    before, made, spared=made > before and measures[made - 1] <= skip_share * threshold
                )
            return found

        return call

    def _count(self, before: int, made: int, *, spared: bool) -> None:
        """What corrections have asked for, that are made after those before."""
        # the forces of the start, and those after each one, but for a last one that is skipped
        self.calls["forces"] += made - before + (before == 0) - bool(spared)
        for part in ("solve", "update"):
            self.calls[part] += made - before
