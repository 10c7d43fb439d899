"""An interface as a term of the system, with its maximum openings as the history."""

from dataclasses import dataclass

import numpy as np

from isopeel.assembly.adhesion_kernel import add_adhesion
from isopeel.assembly.interface_kernel import InterfaceData
from isopeel.assembly.loops import Loops
from isopeel.assembly.packing import Packed, packed
from isopeel.assembly.tables import SideTable
from isopeel.common.arrays import FloatArray, IntArray, frozen
from isopeel.physics.adhesion.irreversible import NOT_CLOSED
from isopeel.physics.batch import evaluate_substrate
from isopeel.physics.substrates import Substrate
from isopeel.problem import Interface


@dataclass(frozen=True, eq=False)
class InterfaceTerm:
    """The interaction of a substrate with a side, at the points of a table.

    The history of an irreversible joint are the maximum openings at the points, (E Q,); `NOT_CLOSED` at
    points that have not closed yet.
    """

    adhesion: Interface
    table: SideTable
    tangents: FloatArray  # of the substrate at the initial positions of the points, (E, Q, 2), for sliding
    closed: float  # an opening up to this one counts as closed: the round-off of positions

    @property
    def loops(self) -> Loops:
        """See `isopeel.assembly.terms`."""
        return add_adhesion

    @property
    def has_potential(self) -> bool:
        """See `isopeel.assembly.terms`."""
        return self.adhesion.traction == "reference"

    def couplings(self) -> tuple[IntArray, ...]:
        """See `isopeel.assembly.terms`."""
        return (self.table.functions,)

    def data(self, unknowns: IntArray) -> Packed:
        """See `isopeel.assembly.terms`."""
        return packed(interface_data(self.adhesion, self.table, self.tangents, unknowns))

    def initial(self) -> FloatArray:
        """See `isopeel.assembly.terms`."""
        count = self.table.weights.size
        if not self.adhesion.irreversible:
            return frozen(np.zeros(count))
        return self._opened(self._opening(None), np.full(count, NOT_CLOSED))

    def commit(self, displacement: FloatArray, history: FloatArray) -> FloatArray:
        """See `isopeel.assembly.terms`."""
        return self._opened(self._opening(displacement), history) if self.adhesion.irreversible else history

    def _opening(self, displacement: FloatArray | None) -> FloatArray:
        """Return the openings (E Q,): gaps minus the equilibrium gap."""
        adhesion, side = self.adhesion, self.table
        position = side.positions
        if displacement is not None:
            position = position + np.einsum("eqm,emi->eqi", side.values, displacement[side.functions])
        gap, _, _ = evaluate_substrate(adhesion.substrate.kernel, adhesion.substrate.parameters, position)
        return (gap - adhesion.law.equilibrium_gap).ravel()

    def _opened(self, opening: FloatArray, before: FloatArray) -> FloatArray:
        """Return the maximum openings after one more opening; see `physics.adhesion.irreversible`."""
        waits = (before < 0) & (opening > self.closed)
        return frozen(np.where(waits, NOT_CLOSED, np.maximum(np.maximum(before, 0.0), opening)))


def substrate_tangents(substrate: Substrate, positions: FloatArray) -> FloatArray:
    """Return the tangents (..., 2) of a substrate at the points closest to positions (..., 2)."""
    _, normals, _ = evaluate_substrate(substrate.kernel, substrate.parameters, positions)
    return np.stack([-normals[..., 1], normals[..., 0]], axis=-1)


def interface_data(
    adhesion: Interface, table: SideTable, tangents: FloatArray, unknowns: IntArray
) -> InterfaceData:
    """Return the data of the loops over an interface, for functions with the unknowns (size, 2)."""
    law, substrate = adhesion.law, adhesion.substrate
    return InterfaceData(
        law=law.kernel.address,
        parameters=law.parameters,
        equilibrium_gap=float(law.equilibrium_gap),
        substrate=substrate.kernel.address,
        substrate_parameters=substrate.parameters,
        **vars(table),
        tangents=tangents,
        unknowns=unknowns[table.functions],
        factors=substrate.constant_curvature,
        projected=adhesion.traction == "projected",
        irreversible=adhesion.irreversible,
        sliding_length=float(adhesion.sliding_length or 0.0),
    )
