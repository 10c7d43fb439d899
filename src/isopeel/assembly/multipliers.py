"""The multipliers of contact: their update, and the gaps that they leave, see `physics.adhesion.augmented`.

The overlaps that they replace are the history of an interface. They change between equilibria only.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from isopeel.assembly.interface_kernel import Response
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray, frozen
from isopeel.physics.adhesion.augmented import largest_gap, replaced_overlap


class Remaining(NamedTuple):
    """The gaps that an equilibrium leaves at points in contact, and their multipliers after an update."""

    gap: float  # the largest gap of the interface that misses its own allowed one by the largest factor
    allowed: float
    name: str  # of that interface
    energy: float  # pressure times gap over all points: what the energy is uncertain by
    history: FloatArray  # of all interfaces, see `System.maximum_openings`

    @property
    def is_allowed(self) -> bool:
        """Return whether all gaps are small enough."""
        return self.gap <= self.allowed


def remaining(system: System, displacement: FloatArray) -> Remaining:
    """Return what an equilibrium of coefficients (size, 2) leaves, after the history of its system."""
    history = system.maximum_openings.ravel().copy()
    worst, energy = (0.0, 1.0, ""), 0.0
    for name, allowed, weights, place, response in _responses(system, displacement):
        opening = response.gap - system.problem.interface_of(name).law.equilibrium_gap
        found = largest_gap(opening, history[place]), allowed, name
        worst = max(worst, found, key=lambda one: one[0] / one[1])
        energy += float(weights.ravel() @ np.abs(response.traction * np.minimum(opening, history[place])))
        history[place] = replaced_overlap(opening, history[place])
    return Remaining(*worst, energy, frozen(history.reshape(system.maximum_openings.shape)))


def _responses(
    system: System, displacement: FloatArray
) -> Iterator[tuple[str, float, FloatArray, slice, Response]]:
    """Yield names, allowed gaps, weights, places in the history and states of interfaces with multipliers."""
    start = 0
    parts = system.maximum_openings_of(system.maximum_openings)
    u = np.ascontiguousarray(displacement).view()
    u.setflags(write=False)
    for (name, part), term in zip(parts.items(), system.interfaces, strict=True):
        place, start = slice(start, start + part.size), start + part.size
        allowed = term.adhesion.penetration
        if allowed is not None:
            known = part.ravel().view()
            known.setflags(write=False)
            yield name, allowed, term.table.weights, place, term.respond(u, known)
