"""Loads that are held while the drive acts."""

from dataclasses import dataclass

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.quantities import Angle, ForcePerWidth
from isopeel.problem.boundary import Boundary
from isopeel.problem.drives.base import unit_vector


@dataclass(frozen=True)
class HeldLoad:
    """A dead force per width on a boundary, at an angle (radians) from the x axis, which never changes.

    It is a uniform traction, and acts from the first step on.
    """

    boundary: Boundary
    force: ForcePerWidth
    angle: Angle

    def __post_init__(self) -> None:
        """Check the force and the angle."""
        if not np.isfinite(self.force) or self.force == 0:
            raise InputError("load.force", self.force, "it must be finite, and not zero")
        if not np.isfinite(self.angle):
            raise InputError("load.angle", self.angle, "it must be finite")

    @property
    def direction(self) -> FloatArray:
        """Unit vector (2,) of the force."""
        return unit_vector(self.angle)
