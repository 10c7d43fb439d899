"""The body as a term of the system."""

from dataclasses import dataclass

from isopeel.assembly.body_kernel import BodyData
from isopeel.assembly.loops import Loops
from isopeel.assembly.packing import Packed, packed
from isopeel.assembly.tables import BodyTable
from isopeel.assembly.terms import WithoutHistory
from isopeel.common.arrays import IntArray
from isopeel.problem import Body


@dataclass(frozen=True, eq=False)
class BodyTerm(WithoutHistory):
    """The deformation of a body, whose functions are those of a table."""

    body: Body
    table: BodyTable
    loops: Loops

    @property
    def has_potential(self) -> bool:
        """See `isopeel.assembly.terms`."""
        return True

    def couplings(self) -> tuple[IntArray, ...]:
        """See `isopeel.assembly.terms`."""
        return self.table.functions()

    def data(self, unknowns: IntArray) -> Packed:
        """See `isopeel.assembly.terms`."""
        table = {name: getattr(self.table, name) for name in BodyData._fields if hasattr(self.table, name)}
        table["unknowns"] = self.table.unknowns(unknowns)
        material = self.body.material
        return packed(BodyData(material=material.kernel.address, parameters=material.parameters, **table))
