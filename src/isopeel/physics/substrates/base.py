"""The interface of a substrate."""

from typing import Protocol, Self

from isopeel.common.arrays import FloatArray
from isopeel.physics.batch import BatchFunction


class Substrate(Protocol):
    """A rigid body that points are projected onto."""

    @property
    def parameters(self) -> FloatArray:
        """Numbers handed to the kernel."""
        ...

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of `SUBSTRATE_SIGNATURE`: gap, outward normal and curvature (convex positive)."""
        ...

    @property
    def constant_curvature(self) -> bool:
        """Whether the curvature is the same all along the substrate, as `VanDerWaals` assumes."""
        ...

    def receded(self, gap: float) -> Self:
        """The substrate moved away from the body by a gap (length)."""
        ...
