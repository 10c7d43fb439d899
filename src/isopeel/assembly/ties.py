"""Ties as relations of functions: the coefficients of a side that follows are sums of those of the other one.

Two sides with the same functions, in one order or the other, share their coefficients. Otherwise the side
that follows has the mortar projection of the other one's displacement (`isopeel.assembly.mortar`).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_array

from isopeel.assembly.mortar import projection, side_space
from isopeel.assembly.sizes import ROUND_OFF, extent_of
from isopeel.assembly.spaces import Spaces
from isopeel.assembly.tie_kernel import Followers, condense_tangent
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.errors import InputError
from isopeel.matrix.band import BandMatrix
from isopeel.problem import Tie


@dataclass(frozen=True, eq=False)
class TiedFunctions:
    """The functions that follow others, of all ties of a problem."""

    followers: Followers
    copies: IntArray  # (size,) the function whose coefficients each one has; of itself where there is none
    mixed: IntArray  # (n,) rows of the followers that have several leaders

    @cached_property
    def leading(self) -> IntArray:
        """The functions (n,) that do not follow others."""
        return np.setdiff1d(np.arange(len(self.copies)), self.followers.functions)

    @property
    def of_several(self) -> IntArray:
        """The functions (n,) that follow several others."""
        return self.followers.functions[self.mixed]

    def condense(self, tangent: BandMatrix, unknowns: IntArray) -> None:
        """Replace a tangent by that without the functions that follow several others.

        Each of these has an unknown of its own, by `unknowns` (size, 2), which keeps a diagonal entry alone.
        """
        if len(self.mixed):
            band, width = tangent.workspace, tangent.half_bandwidth
            condense_tangent(band, tangent.diagonal, width, unknowns, self.followers, self.mixed)

    def coupled(self, elements: Sequence[IntArray]) -> list[IntArray]:
        """Return functions (E, m) of elements, with what those follow that follow several others."""
        if not len(self.mixed):
            return list(elements)
        starts, leaders = self.followers.starts, self.followers.leaders
        led = {int(self.followers.functions[k]): leaders[starts[k] : starts[k + 1]] for k in self.mixed}
        found = []
        for functions in elements:
            tied = np.isin(functions, list(led)).any(axis=1)
            found.append(functions[~tied])
            found += [
                np.concatenate([one, *(led[f] for f in one.tolist() if f in led)])[None]
                for one in functions[tied]
            ]
        return [functions for functions in found if len(functions)]


def tied_functions(spaces: Spaces) -> TiedFunctions:
    """Return the functions that follow others.

    Raises InputError where a side does not lie on the one that it follows, or where a function would follow
    in two ways, or itself.
    """
    size, ties = spaces.size, spaces.problem.ties
    representative = np.arange(size)
    if not ties:
        nothing = Followers(np.empty(0, np.int64), np.zeros(1, np.int64), np.empty(0, np.int64), np.empty(0))
        return TiedFunctions(nothing, representative, np.empty(0, np.int64))
    related = [_related(spaces, tie, number) for number, tie in enumerate(ties, start=1)]
    for functions, shares in related:
        for function, leaders, _ in _split(functions, shares):
            if len(leaders) == 1:
                _join(representative, function, int(leaders[0]))
    representative = np.array([_root(representative, f) for f in range(size)])
    rows: dict[int, tuple[IntArray, FloatArray]] = {}
    for number, (functions, shares) in enumerate(related, start=1):
        for function, leaders, values in _split(functions, shares):
            if len(leaders) > 1:
                follower = int(representative[function])
                if follower in rows:
                    raise _in_two_ways(spaces, number)
                rows[follower] = representative[leaders], values
    every = _matrix(representative, rows)
    # each function by those that it follows, which may follow others: at most as many times as there are ties
    for _ in ties:
        every = every @ every
    every.sum_duplicates()
    every.eliminate_zeros()
    if np.isin(every.indices, list(rows)).any():
        raise _in_two_ways(spaces, len(ties))
    first = every.indices[every.indptr[:-1]].astype(np.int64)
    is_single = np.diff(every.indptr) == 1
    (functions,) = np.nonzero(~is_single | (first != np.arange(size)))
    chosen = every[functions]
    followers = Followers(
        functions.astype(np.int64),
        chosen.indptr.astype(np.int64),
        chosen.indices.astype(np.int64),
        np.ascontiguousarray(chosen.data),
    )
    (mixed,) = np.nonzero(np.diff(followers.starts) > 1)
    return TiedFunctions(followers, np.where(is_single, first, np.arange(size)), mixed)


def _split(functions: IntArray, shares: csr_array) -> Iterator[tuple[int, IntArray, FloatArray]]:
    """Yield each of the functions (n,) with its leaders and their shares, the rows of a matrix."""
    for function, start, end in zip(functions, shares.indptr[:-1], shares.indptr[1:], strict=True):
        yield int(function), shares.indices[start:end], shares.data[start:end]


def _matrix(representative: IntArray, rows: Mapping[int, tuple[IntArray, FloatArray]]) -> csr_array:
    """Return the matrix (size, size) from coefficients to coefficients, by one relation each."""
    size = len(representative)
    shares = np.ones(size)
    shares[list(rows)] = 0.0
    parts = [(np.arange(size), representative, shares)]
    parts += [(np.full(len(leaders), f), leaders, values) for f, (leaders, values) in rows.items()]
    functions, leaders, values = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    found = csr_array((values, (functions, leaders)), shape=(size, size))
    found.eliminate_zeros()
    return found


def _in_two_ways(spaces: Spaces, number: int) -> InputError:
    allowed = (
        "points of this side follow in two ways, or follow themselves; exchange the sides of one of the ties,"
        " or take meshes that match"
    )
    tie = spaces.problem.ties[number - 1]
    return InputError(f"tie.{number}.between", spaces.problem.side_name(tie.boundary), allowed)


def _root(representative: IntArray, function: int) -> int:
    while representative[function] != function:
        function = int(representative[function])
    return function


def _join(representative: IntArray, one: int, other: int) -> None:
    """Let two functions have one representative, the lowest of their functions."""
    first, second = sorted((_root(representative, one), _root(representative, other)))
    representative[second] = first


def _related(spaces: Spaces, tie: Tie, number: int) -> tuple[IntArray, csr_array]:
    """Return the functions (n,) of a side that follows, and their shares (n, size) of all functions."""
    functions = spaces.side(tie.boundary.body, tie.boundary.side)
    size = spaces.size
    order = _same_functions(spaces, tie)
    if order is not None:
        leaders = spaces.side(tie.to.body, tie.to.side)[::order]
        n = len(functions)
        return functions, csr_array((np.ones(n), (np.arange(n), leaders)), shape=(n, size))
    return functions, projection(spaces, tie, number, functions)


def _same_functions(spaces: Spaces, tie: Tie) -> int | None:
    """Return the order, 1 or -1, in which two whole sides have the same functions; None where they differ."""
    if not tie.to.is_whole:
        return None
    (own, own_weights), (other, weights) = (side_space(spaces, one) for one in (tie.boundary, tie.to))
    if own.degree != other.degree or own.knot_vector.size != other.knot_vector.size:
        return None
    points = spaces.control_points()
    mine, theirs = (points[spaces.side(one.body, one.side)] for one in (tie.boundary, tie.to))
    near = ROUND_OFF * extent_of(spaces.problem.body_of(tie.boundary.body))
    for order in (1, -1):
        knots = other.knot_vector if order == 1 else 1.0 - other.knot_vector[::-1]
        ratios = own_weights / weights[::order]
        if (
            np.abs(own.knot_vector - knots).max() <= ROUND_OFF
            and np.abs(mine - theirs[::order]).max() <= near
            and np.ptp(ratios) <= ROUND_OFF * ratios[0]
        ):
            return order
    return None
