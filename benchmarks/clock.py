"""Counts and times of the parts of a load step."""

from collections import Counter, defaultdict
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from inspect import signature
from time import perf_counter
from typing import Any
from unittest.mock import patch

from isopeel.assembly.system import System
from isopeel.solve import quasi_newton
from isopeel.solve.corrections import corrected
from isopeel.solve.predictor import Predictor

#: The parts of a load step. Corrections are one compiled loop of forces, solutions and updates.
PARTS = ("corrections", "tangent", "factor", "guess")
#: Places of the loop's arguments, by name.
_PLACES = {name: k for k, name in enumerate(signature(corrected).parameters)}


class Clock:
    """Calls and seconds of each part, and numbers of evaluated forces, solutions and updates."""

    def __init__(self) -> None:
        self.calls: Counter[str] = Counter()
        self.seconds: defaultdict[str, float] = defaultdict(float)

    @contextmanager
    def running(self) -> Iterator[None]:
        """Count and time all parts of the paths that are traced in the context."""
        with ExitStack() as patches:
            for owner, name, part in (
                (quasi_newton, "corrected", "corrections"),
                (System, "linearize", "tangent"),
                (quasi_newton, "approximate", "factor"),
                (Predictor, "guess", "guess"),
            ):
                patches.enter_context(patch.object(owner, name, self._counted(part, getattr(owner, name))))
            yield

    def _counted(self, part: str, function: Callable[..., Any]) -> Callable[..., Any]:
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
                    before, made, skipped=made > before and measures[made - 1] <= skip_share * threshold
                )
            return found

        return call

    def _count(self, before: int, made: int, *, skipped: bool) -> None:
        """Count the parts of the corrections `made` after those `before`."""
        # the forces at the start and after each correction, except a skipped last evaluation
        self.calls["forces"] += made - before + (before == 0) - bool(skipped)
        for part in ("solve", "update"):
            self.calls[part] += made - before
