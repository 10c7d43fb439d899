"""The interface of an adhesion law."""

from typing import Protocol

from isopeel.common.arrays import FloatArray
from isopeel.physics.batch import BatchFunction


class AdhesionLaw(Protocol):
    """What the assembly and the evaluation of curves need of an adhesion law."""

    @property
    def parameters(self) -> FloatArray:
        """Numbers handed to the kernel."""
        ...

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of `ADHESION_SIGNATURE`: potential Phi, T = -dPhi/dr (repulsion positive), dT/dr."""
        ...

    @property
    def equilibrium_gap(self) -> float:
        """Gap (length) at which a flat substrate neither pulls nor pushes."""
        ...

    @property
    def work_of_adhesion(self) -> float:
        """Energy per area to take flat surfaces from the equilibrium gap to infinity."""
        ...
