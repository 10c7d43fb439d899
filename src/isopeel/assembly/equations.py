"""Compiled: forces and energies of a state, for compiled code that goes on with them."""

from typing import NamedTuple

import numpy as np

from isopeel.assembly.constraints import condense, displace
from isopeel.assembly.loops import Energies, Sums, TermList, add_terms
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import compiled


class Equations(NamedTuple):
    """What stays the same of the equations of a system along a path, for compiled code."""

    terms: TermList
    unknowns: IntArray  # this and the following as in `Constraints`
    offset: FloatArray
    driven: IntArray


class Iterate(NamedTuple):
    """Unknowns during the iteration, and displacement, forces and residual of these unknowns."""

    unknown_values: FloatArray  # (count,)
    displacement: FloatArray  # (size, 2)
    forces: FloatArray  # (size, 2)
    residual: FloatArray  # (count,)


@compiled
def evaluate(
    equations: Equations, history: FloatArray, moved: FloatArray, scalars: FloatArray, at: Iterate
) -> Energies:
    """Set displacement, forces and residual of unknowns, where the driven functions are moved by (n, 2).

    The scalars are those that terms depend on, see `isopeel.assembly.loops`.
    """
    unknowns, u, forces, residual = equations.unknowns, at.displacement, at.forces, at.residual
    displace(unknowns, at.unknown_values, equations.offset, equations.driven, moved, u)
    forces.fill(0.0)
    energies = add_terms(equations.terms, history, scalars, u, Sums(forces, np.empty((0, 0)), 0, False))
    # with this sign, zero changes no number that is added to it
    residual.fill(-0.0)
    condense(unknowns, forces, residual)
    return energies
