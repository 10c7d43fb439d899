"""Sides that are rotated by a pure moment."""

from dataclasses import dataclass
from math import cos, sin
from typing import ClassVar

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.quantities import ANGLE, Dimension
from isopeel.problem.boundary import Place, driven_boundaries
from isopeel.problem.drives.base import Column, Freedom


@dataclass(frozen=True)
class RotatedSide:
    """A side, or boundaries by factors: each rotates as a rigid line by an angle about its own free centre.

    It rotates anticlockwise. Parameter: the angle in radians. The centre is free, so that the net force
    vanishes and the only reaction is a pure moment (energy per radian and unit width).
    """

    name: ClassVar[str] = "rotation"
    on: Place = "right"

    def __post_init__(self) -> None:
        """Check the boundaries."""
        driven_boundaries(self.on)

    @property
    def parameter_dimension(self) -> Dimension:
        """An angle."""
        return ANGLE

    @property
    def parameter_column(self) -> Column:
        """The angle in degrees."""
        return Column("theta_deg", "degree", 180 / np.pi, "rotation of the driven face")

    @property
    def reaction_column(self) -> Column:
        """The moment of a strip of unit width."""
        return Column("moment", "E0 L0^3", words="moment $M$")

    @property
    def freedoms(self) -> tuple[Freedom, Freedom]:
        """Both tied: the centre is free."""
        return "tied", "tied"

    def prescribed(self, points: FloatArray, parameter: float) -> FloatArray:
        """Return (Q(angle) - 1)(x - centre)."""
        # 1 - cos by the half angle, which is exact at small angles too
        return _turned(points, complex(-2 * sin(parameter / 2) ** 2, sin(parameter)))

    def rate(self, points: FloatArray, parameter: float) -> FloatArray:
        """Return dQ/dangle (x - centre)."""
        return _turned(points, complex(-sin(parameter), cos(parameter)))


def _turned(points: FloatArray, factor: complex) -> FloatArray:
    """Return points (n, 2) of a line, from its centre on, as complex numbers x + i y times a factor."""
    line = np.ascontiguousarray(points).view(np.complex128)
    # any point of the line would do: another one differs by a translation, which is free
    turned: FloatArray = (factor * (line - (line[0] + line[-1]) / 2)).view(np.float64)
    return turned
