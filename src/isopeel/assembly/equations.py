"""Compiled: forces and energies of a state, for compiled code that goes on with them."""

from typing import NamedTuple

import numpy as np

from isopeel.assembly.constraints import condense, displace
from isopeel.assembly.loops import Energies, Sums, TermList, add_terms
from isopeel.assembly.tie_kernel import Followers, lead
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import compiled


class Equations(NamedTuple):
    """What stays the same of the equations of a system along a path, for compiled code."""

    terms: TermList
    unknowns: IntArray  # this and the following as in `Constraints`
    offset: FloatArray
    driven: IntArray
    followers: Followers


class Iterate(NamedTuple):
    """Unknowns during the iteration, and displacement, forces and residual of these unknowns."""

    unknown_values: FloatArray  # (count,)
    displacement: FloatArray  # (size, 2)
    forces: FloatArray  # (size, 2)
    residual: FloatArray  # (count,)


@compiled
def place(equations: Equations, unknown_values: FloatArray, moved: FloatArray, u: FloatArray) -> None:
    """Set the coefficients u (size, 2) of unknowns, where the driven functions are moved by (n, 2)."""
    offset, driven, followers = equations.offset, equations.driven, equations.followers
    displace(equations.unknowns, unknown_values, offset, driven, moved, followers, u)


@compiled
def evaluate(
    equations: Equations, history: FloatArray, moved: FloatArray, scalars: FloatArray, at: Iterate
) -> Energies:
    """Set displacement, forces and residual of unknowns, where the driven functions are moved by (n, 2).

    The scalars are those that terms depend on, see `isopeel.assembly.loops`.
    """
    unknowns, u, forces, residual = equations.unknowns, at.displacement, at.forces, at.residual
    place(equations, at.unknown_values, moved, u)
    forces.fill(0.0)
    energies = add_terms(equations.terms, history, scalars, u, Sums(forces, np.empty((0, 0)), 0, False))
    lead(equations.followers, forces)
    # with this sign, zero changes no number that is added to it
    residual.fill(-0.0)
    condense(unknowns, forces, residual)
    return energies
