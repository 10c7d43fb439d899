"""Sides that a force pulls."""

from dataclasses import dataclass
from typing import Annotated, ClassVar, get_args

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.quantities import Angle, Dimension, Meaning
from isopeel.problem.boundary import Place, driven_boundaries
from isopeel.problem.drives.base import (
    DISPLACEMENT,
    FORCE,
    Column,
    LoadControl,
    dimension_of,
    unit_vector,
)


@dataclass(frozen=True)
class PulledSide:
    """A force on a side or a part of it, or forces on boundaries, at an angle (radians) from the x axis.

    It is a dead traction, or one that `follows` the surface; the side deforms freely. Under `displacement`
    control the parameter is the mean displacement along the angle (length). The force per unit width is an
    unknown, and the reaction. This pulls a tape at a fixed angle past an instability of the force. On several
    boundaries the force on each is its factor times this force, and the parameter is the sum of factor times
    mean displacement: with the factors 1 and -1, by how much two arms are pulled apart. Under `force` control
    the parameter is the force, which begins with zero, and the reaction is the displacement. A load that
    follows keeps its angle to the surface at each point.
    """

    name: ClassVar[str] = "force"
    on: Place
    angle: Annotated[Angle, Meaning("angle of the force from the x axis", "60 deg")]
    follows: Annotated[bool, Meaning("whether the force rotates with the surface", True)] = False
    control: Annotated[
        LoadControl,
        Meaning("what the steps prescribe: the displacement along the force, or the force", "displacement"),
    ] = "displacement"

    def __post_init__(self) -> None:
        """Check the boundaries, the angle and the control."""
        driven_boundaries(self.on)
        if not np.isfinite(self.angle):
            raise InputError("drive.angle", self.angle, "it must be finite")
        if self.control not in get_args(LoadControl):
            raise InputError(
                "drive.control", self.control, f"it must be {' or '.join(get_args(LoadControl))}"
            )

    @property
    def parameter_dimension(self) -> Dimension:
        """A length under displacement control, a force per width under force control."""
        return dimension_of(self.control)

    @property
    def parameter_column(self) -> Column:
        """The displacement or the force, by the control."""
        return DISPLACEMENT if self.control == "displacement" else FORCE

    @property
    def reaction_column(self) -> Column:
        """The other one of displacement and force."""
        return FORCE if self.control == "displacement" else DISPLACEMENT

    @property
    def direction(self) -> FloatArray:
        """Along the angle."""
        return unit_vector(self.angle)
