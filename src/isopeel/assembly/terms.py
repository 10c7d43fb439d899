"""Terms, whose sum is the discrete system: each is one piece of physics on some coefficients."""

from typing import Protocol

from isopeel.assembly.loops import Loops
from isopeel.assembly.packing import Packed
from isopeel.common.arrays import FloatArray, IntArray, frozen


class Term(Protocol):
    """A piece of physics: compiled loops that add its forces and tangent, and the data of these loops.

    The history is changed by accepted steps only, and never by a trial.
    """

    @property
    def loops(self) -> Loops:
        """The loops that add forces and tangent, see `isopeel.assembly.loops`."""
        ...

    @property
    def has_potential(self) -> bool:
        """Whether the forces are derivatives of an energy, so that the tangent is symmetric."""
        ...

    def couplings(self) -> tuple[IntArray, ...]:
        """Functions (E, m) of elements, of several sizes: those of one element are coupled."""
        ...

    def data(self, unknowns: IntArray) -> Packed:
        """Return the data of the loops, for functions with the unknowns (size, 2)."""
        ...

    def initial(self) -> FloatArray:
        """The history (n,) of an undeformed body."""
        ...

    def commit(self, displacement: FloatArray, history: FloatArray) -> FloatArray:
        """Return the history (n,) after a step to coefficients (size, 2), from the history before it."""
        ...


class WithoutHistory:
    """The history of a term that has none."""

    def initial(self) -> FloatArray:
        """See `Term`."""
        return frozen([])

    def commit(self, _displacement: FloatArray, history: FloatArray) -> FloatArray:
        """See `Term`."""
        return history
