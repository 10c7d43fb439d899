"""Compiled loops that are called by address: what calls them need not compile them again."""

from collections.abc import Callable
from functools import cache
from typing import Any, TypeAlias

from numba import cfunc, float64, types

#: Reordered sums let loops run in vector registers; nan must stay nan, because it is how an inverted element
#: is noticed.
OPTIONS: dict[str, Any] = {
    "cache": True,
    "error_model": "numpy",
    "fastmath": {"contract", "reassoc", "nsz"},
}

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
    return cfunc(signature, **OPTIONS)(loops)
