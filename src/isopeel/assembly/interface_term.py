"""An interface as a term of the system, with its maximum openings as the history."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from isopeel.assembly.adhesion_kernel import add_adhesion
from isopeel.assembly.interface_kernel import InterfaceData, Response, read_interface, respond
from isopeel.assembly.loops import Loops
from isopeel.assembly.opening import initial_openings, opened
from isopeel.assembly.packing import Packed, packed
from isopeel.assembly.tables import SideTable
from isopeel.common.arrays import FloatArray, IntArray
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
        return self.adhesion.has_potential

    def couplings(self) -> tuple[IntArray, ...]:
        """See `isopeel.assembly.terms`."""
        return (self.table.functions,)

    def data(self, unknowns: IntArray) -> Packed:
        """See `isopeel.assembly.terms`."""
        return packed(interface_data(self.adhesion, self.table, self.tangents, unknowns))

    def initial(self) -> FloatArray:
        """See `isopeel.assembly.terms`."""
        return initial_openings(self.adhesion, self.opening(None), self.closed)

    def commit(self, displacement: FloatArray, history: FloatArray) -> FloatArray:
        """See `isopeel.assembly.terms`."""
        if not self.adhesion.irreversible:
            return history
        return opened(self.opening(displacement), history, self.closed)

    def respond(self, displacement: FloatArray, history: FloatArray) -> Response:
        """Return the state of all points, at coefficients (size, 2) after a history (E Q,)."""
        found: Response = respond(self._interface, history, displacement)
        return found

    @cached_property
    def _interface(self) -> InterfaceData:
        no_unknowns = np.zeros((int(self.table.functions.max()) + 1, 2), dtype=np.int64)
        # with the types of the assembly
        data: InterfaceData = read_interface.py_func(*self.data(no_unknowns))
        return data

    def opening(self, displacement: FloatArray | None) -> FloatArray:
        """Return the openings (E Q,), gaps minus the equilibrium gap, at coefficients (size, 2) or zero."""
        return self.gap(displacement) - self.adhesion.law.equilibrium_gap

    def gap(self, displacement: FloatArray | None) -> FloatArray:
        """Return the gaps (E Q,) to the substrate, at coefficients (size, 2) or zero."""
        substrate, side = self.adhesion.substrate, self.table
        position = side.positions
        if displacement is not None:
            position = position + np.einsum("eqm,emi->eqi", side.values, displacement[side.functions])
        gap, _, _ = evaluate_substrate(substrate.kernel, substrate.parameters, position)
        return gap.ravel()


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
        augmented=adhesion.penetration is not None,
        sliding_length=float(adhesion.sliding_length or 0.0),
    )
