"""The history of an interface: the maximum openings at its points since they first closed."""

import numpy as np

from isopeel.assembly.sizes import ROUND_OFF, extent_of
from isopeel.common.arrays import FloatArray, frozen
from isopeel.physics.adhesion.irreversible import NOT_CLOSED
from isopeel.problem import Interface, Problem


def closed_opening(problem: Problem, interface: Interface) -> float:
    """Return an opening up to which a point counts as closed: the round-off of positions."""
    return ROUND_OFF * extent_of(problem.body_of(interface.boundary.body))


def initial_openings(interface: Interface, opening: FloatArray, closed: float) -> FloatArray:
    """Return the history (n,) of points with these openings (n,) at the start; zero for a reversible law."""
    if not interface.irreversible:
        return frozen(np.zeros(opening.size))
    return opened(opening, np.full(opening.size, NOT_CLOSED), closed)


def opened(opening: FloatArray, before: FloatArray, closed: float) -> FloatArray:
    """Return the history (n,) after one more opening; one up to `closed` is none, to round-off.

    See `isopeel.physics.adhesion.irreversible`.
    """
    waits = (before < 0) & (opening > closed)
    return frozen(np.where(waits, NOT_CLOSED, np.maximum(np.maximum(before, 0.0), opening)))
