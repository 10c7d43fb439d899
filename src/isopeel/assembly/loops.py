"""Compiled loops that are called by address: what calls them need not compile them again."""

from collections.abc import Callable
from functools import cache
from typing import Any, TypeAlias

from numba import float64, types

from isopeel.common.compilation import REORDERED, compiled_now

#: What loops return.
PAIR: Any = types.UniTuple(float64, 2)  # type: ignore[no-untyped-call]


def read_only(kind: Any, dimensions: int) -> Any:
    """Type of an array that loops only read: one that could be written to will do, too."""
    return types.Array(kind, dimensions, "C", readonly=True)


#: They return two energies, or one and the lowest determinant of F.
Loops: TypeAlias = Callable[..., tuple[float, float]]


@cache
def compile_loops(signature: Any, loops: Loops) -> Any:
    """The loops in compiled form, with their `address`."""
    return compiled_now(signature, loops, REORDERED)
