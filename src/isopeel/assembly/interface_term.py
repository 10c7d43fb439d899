"""The side that adheres as a term of the system, with the largest openings so far as its history."""

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
from isopeel.problem import Interface


@dataclass(frozen=True, eq=False)
class InterfaceTerm:
    """What a substrate does to a side, at the points of a table.

    The history of an irreversible joint are the largest openings so far at the points, (E Q,); `NOT_CLOSED`
    at those that have not closed yet.
    """

    adhesion: Interface
    table: SideTable
    tangents: FloatArray  # of the substrate at the points' first positions, (E, Q, 2), where a joint may hold
    closed: float  # openings are known to the round-off of positions

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
        """Gap beyond the equilibrium gap (E Q,)."""
        adhesion, side = self.adhesion, self.table
        position = side.positions
        if displacement is not None:
            position = position + np.einsum("eqm,emi->eqi", side.values, displacement[side.functions])
        gap, _, _ = evaluate_substrate(adhesion.substrate.kernel, adhesion.substrate.parameters, position)
        return (gap - adhesion.law.equilibrium_gap).ravel()

    def _opened(self, opening: FloatArray, before: FloatArray) -> FloatArray:
        """Largest openings with one more, after those before; see `physics.adhesion.irreversible`."""
        waits = (before < 0) & (opening > self.closed)
        return frozen(np.where(waits, NOT_CLOSED, np.maximum(np.maximum(before, 0.0), opening)))


def interface_data(
    adhesion: Interface, table: SideTable, tangents: FloatArray, unknowns: IntArray
) -> InterfaceData:
    """What compiled code is told of a side that adheres, where functions have the unknowns (size, 2)."""
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
