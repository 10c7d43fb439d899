"""Compiled loops of terms, called by address: what calls them need not compile them again.

The loops of all terms have one signature, and so have lists of terms of any number and kind: code that is
compiled for one list serves all. The arguments are the data of the term (see `packing`), its part of the
history, the scalars that forces depend on (the size of the drive's load), the coefficients u (size, 2) of the
displacement, and the arrays to add to: forces (size, 2) and, `with_tangent`, the band of a tangent, whose
rows have their diagonal at the place `diagonal`. The loops return what they add to the energies.
"""

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numba import boolean, float64, int64, types

from isopeel.assembly.packing import Packed
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import REORDERED, compiled, compiled_now
from isopeel.physics.batch import of_address

#: Stored, adhesive and dissipated energy, and the lowest determinant of F at the quadrature points.
Energies: TypeAlias = tuple[float, float, float, float]


def _read_only(kind: Any, dimensions: int) -> Any:
    """Type of an array that loops only read: one that could be written to will do, too."""
    return types.Array(kind, dimensions, "C", readonly=True)


# of floats that could be written to, as laws are compiled for such parameters
#: (integers, floats, history, scalars, u, forces, band, diagonal, with_tangent)
LOOPS_SIGNATURE = types.UniTuple(float64, 4)(  # type: ignore[no-untyped-call]
    _read_only(int64, 1),
    float64[::1],
    _read_only(float64, 1),
    _read_only(float64, 1),
    _read_only(float64, 2),
    float64[:, ::1],
    float64[:, ::1],
    int64,
    boolean,
)

Loops: TypeAlias = Callable[
    [IntArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, int, bool], Energies
]

_loops_at = of_address(LOOPS_SIGNATURE)


@cache
def compile_loops(loops: Loops) -> Any:
    """The loops in compiled form, with their `address`."""
    return compiled_now(LOOPS_SIGNATURE, loops, REORDERED)


class TermList(NamedTuple):
    """Terms for compiled code: addresses of their loops, and their data, one after another."""

    addresses: IntArray  # (terms,)
    places: IntArray  # (terms, 2, 3) where a term begins and ends: in the integers, the floats, the history
    integers: IntArray
    floats: FloatArray

    def only(self, kept: Sequence[int]) -> "TermList":
        """Some of the terms, with the same history."""
        chosen = np.array(kept, dtype=np.int64)
        return self._replace(addresses=self.addresses[chosen], places=self.places[chosen])

    def differing(self, other: "TermList") -> list[int]:
        """Return the numbers of the terms whose loops or data differ from those of another list as long."""
        return [
            t
            for t, (mine, theirs) in enumerate(zip(self.places, other.places, strict=True))
            if self.addresses[t] != other.addresses[t]
            or not np.array_equal(self._integers(mine), other._integers(theirs))
            or not np.array_equal(self._floats(mine), other._floats(theirs))
        ]

    def _integers(self, place: IntArray) -> IntArray:
        return self.integers[place[0, 0] : place[1, 0]]

    def _floats(self, place: IntArray) -> FloatArray:
        return self.floats[place[0, 1] : place[1, 1]]


def term_list(terms: Sequence[tuple[Loops, Packed, int]]) -> TermList:
    """Join terms, each of its loops, their data and the size of its history."""
    sizes = [(data.integers.size, data.floats.size, history) for _, data, history in terms]
    ends = np.cumsum(np.array(sizes, dtype=np.int64), axis=0)
    return TermList(
        np.array([compile_loops(loops).address for loops, _, _ in terms], dtype=np.int64),
        np.ascontiguousarray(np.stack([ends - sizes, ends], axis=1)),
        np.concatenate([data.integers for _, data, _ in terms]),
        np.concatenate([data.floats for _, data, _ in terms]),
    )


class Sums(NamedTuple):
    """What the loops add to."""

    forces: FloatArray  # (size, 2)
    band: FloatArray  # workspace of a tangent
    diagonal: int  # where a row of it has its diagonal
    with_tangent: bool  # whether to add to it


@compiled
def add_terms(
    terms: TermList, history: FloatArray, scalars: FloatArray, u: FloatArray, sums: Sums
) -> Energies:
    """Add forces and tangents of all terms, after a history, of scalars and coefficients u (size, 2)."""
    stored, adhesive, dissipated, lowest = 0.0, 0.0, 0.0, np.inf
    for t in range(len(terms.addresses)):
        start, end = terms.places[t, 0], terms.places[t, 1]
        loops = _loops_at(terms.addresses[t])
        energies = loops(
            terms.integers[start[0] : end[0]],
            terms.floats[start[1] : end[1]],
            history[start[2] : end[2]],
            scalars,
            u,
            sums.forces,
            sums.band,
            sums.diagonal,
            sums.with_tangent,
        )
        stored += energies[0]
        adhesive += energies[1]
        dissipated += energies[2]
        lowest = min(lowest, energies[3])
    return stored, adhesive, dissipated, lowest
