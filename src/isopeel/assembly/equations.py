"""Compiled: forces and energies of a state, for compiled code that goes on with them.

The loops over the body and over the side that adheres are called by address, as these call material and law:
so they are compiled once, whatever code asks for them.
"""

from typing import NamedTuple, TypeAlias

import numpy as np

from isopeel.assembly.adhesion_kernel import AdhesionArguments, adhesion_at
from isopeel.assembly.body_kernel import BodyArguments, body_at
from isopeel.assembly.constraints import condense, displace
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import compiled


class Equations(NamedTuple):
    """What stays the same of the equations of a system along a path, for compiled code."""

    body: BodyArguments
    adhesion: AdhesionArguments
    unknowns: IntArray  # this and the following as in `Constraints`
    offset: FloatArray
    driven: IntArray


class Sums(NamedTuple):
    """What the compiled loops add to."""

    forces: FloatArray  # (size, 2)
    band: FloatArray  # workspace of a tangent
    diagonal: int  # where a row of it has its diagonal
    with_tangent: bool  # whether to add to it


#: Stored, adhesive and dissipated energy, and the lowest determinant of F at the quadrature points.
Energies: TypeAlias = tuple[float, float, float, float]


@compiled
def add_forces(equations: Equations, openings: FloatArray, u: FloatArray, sums: Sums) -> Energies:
    """Add what deforms the body and what the substrate does, of coefficients u (size, 2)."""
    of_body, of_side = equations.body, equations.adhesion
    body, adhesion = body_at(of_body.loops), adhesion_at(of_side.loops)
    stored, lowest_determinant = body(
        of_body.material,
        of_body.parameters,
        of_body.kinds,
        of_body.sizes,
        of_body.along,
        of_body.first,
        of_body.across,
        of_body.first_rows,
        of_body.map_kinds,
        of_body.maps,
        of_body.weight_kinds,
        of_body.weights,
        of_body.rectangles,
        of_body.unknowns,
        u,
        sums.forces,
        sums.band,
        sums.diagonal,
        sums.with_tangent,
    )
    adhesive, dissipated = adhesion(
        of_side.law,
        of_side.law_parameters,
        of_side.substrate,
        of_side.substrate_parameters,
        of_side.functions,
        of_side.values,
        of_side.gradients,
        of_side.weights,
        of_side.positions,
        of_side.normals,
        of_side.unknowns,
        of_side.factors,
        of_side.projected,
        of_side.irreversible,
        of_side.sliding_length,
        of_side.tangents,
        of_side.equilibrium_gap,
        openings,
        u,
        sums.forces,
        sums.band,
        sums.diagonal,
        sums.with_tangent,
    )
    return stored, adhesive, dissipated, lowest_determinant


class Iterate(NamedTuple):
    """Unknowns on their way to an equilibrium, and what has been found there."""

    unknown_values: FloatArray  # (count,)
    displacement: FloatArray  # (size, 2)
    forces: FloatArray  # (size, 2)
    residual: FloatArray  # (count,)


@compiled
def evaluate(
    equations: Equations, openings: FloatArray, moved: FloatArray, external: FloatArray, at: Iterate
) -> Energies:
    """Set displacement, forces and residual of unknowns, where the driven functions are moved by (n, 2).

    External forces (count,) are those of a load.
    """
    unknowns, u, forces, residual = equations.unknowns, at.displacement, at.forces, at.residual
    displace(unknowns, at.unknown_values, equations.offset, equations.driven, moved, u)
    forces.fill(0.0)
    energies = add_forces(equations, openings, u, Sums(forces, np.empty((0, 0)), 0, False))
    for i in range(len(residual)):
        residual[i] = -external[i]
    condense(unknowns, forces, residual)
    return energies
