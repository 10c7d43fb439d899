"""The body as a term of the system: its forces have a potential, and no history."""

from dataclasses import dataclass

from isopeel.assembly.body_kernel import BodyData, add_body
from isopeel.assembly.loops import Loops
from isopeel.assembly.packing import Packed, packed
from isopeel.assembly.tables import BodyTable
from isopeel.common.arrays import FloatArray, IntArray, frozen
from isopeel.problem import Body

#: The history of a term that has none.
_NO_HISTORY = frozen([])


@dataclass(frozen=True, eq=False)
class BodyTerm:
    """The deformation of a body, whose functions are those of a table."""

    body: Body
    table: BodyTable
    loops: Loops = add_body

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

    def initial(self) -> FloatArray:
        """See `isopeel.assembly.terms`."""
        return _NO_HISTORY

    def commit(self, _displacement: FloatArray, history: FloatArray) -> FloatArray:
        """See `isopeel.assembly.terms`."""
        return history
