"""What the discrete system is a sum of: a term is one piece of physics on some coefficients."""

from typing import Protocol

from isopeel.assembly.loops import Loops
from isopeel.assembly.packing import Packed
from isopeel.common.arrays import FloatArray, IntArray


class Term(Protocol):
    """A piece of physics: compiled loops that add its forces and tangent, and what these are told.

    A history is what an accepted step leaves behind for the next one; a trial never changes it.
    """

    @property
    def loops(self) -> Loops:
        """What adds forces and tangent, see `isopeel.assembly.loops`."""
        ...

    @property
    def has_potential(self) -> bool:
        """Whether the forces are derivatives of an energy, so that the tangent is symmetric."""
        ...

    def couplings(self) -> tuple[IntArray, ...]:
        """Functions (E, m) of elements, of several sizes: those of one element are coupled."""
        ...

    def data(self, unknowns: IntArray) -> Packed:
        """What the loops are told, where functions have the unknowns (size, 2)."""
        ...

    def initial(self) -> FloatArray:
        """The history (n,) of a body as it is made."""
        ...

    def commit(self, displacement: FloatArray, history: FloatArray) -> FloatArray:
        """The history (n,) after a step to coefficients (size, 2), of that before it."""
        ...
