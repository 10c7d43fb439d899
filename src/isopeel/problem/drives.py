"""Drives: how one side of a body is moved by one parameter."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from isopeel.arrays import FloatArray
from isopeel.splines.nurbs import Side, check_side


@dataclass(frozen=True)
class Column:
    """How a quantity is tabulated: the name of its column, its unit, and the factor from internal values."""

    name: str
    unit: str
    factor: float = 1.0

    def shown(self, value: float) -> float:
        """The value in the unit of the column, without the round-off of its conversion."""
        return round(value * self.factor, 12)


class Drive(Protocol):
    """A side that moves by a known displacement g(parameter), up to free rigid translations."""

    @property
    def side(self) -> Side:
        """The driven side."""
        ...

    @property
    def parameter_column(self) -> Column:
        """How the parameter is tabulated."""
        ...

    @property
    def reaction_column(self) -> Column:
        """How the reaction is tabulated."""
        ...

    @property
    def free_translations(self) -> tuple[bool, bool]:
        """Per component: is the driven side as a whole free to translate along it?"""
        ...

    def prescribed(self, points: FloatArray, parameter: float) -> FloatArray:
        """Displacement g (n, 2) of reference points (n, 2)."""
        ...

    def rate(self, points: FloatArray, parameter: float) -> FloatArray:
        """dg/dparameter (n, 2), which gives the reaction: force times rate, summed over the points."""
        ...


@dataclass(frozen=True)
class RotatedSide:
    """A side that moves as a rigid line: turned anticlockwise by an angle about its own free centre.

    Parameter: the angle in radians. The centre is free, so that the net force vanishes and the only
    reaction is a pure moment (energy per radian and unit width).
    """

    side: Side

    def __post_init__(self) -> None:
        """Check the side."""
        check_side("drive.side", self.side)

    @property
    def parameter_column(self) -> Column:
        """The angle in degrees."""
        return Column("theta_deg", "degree", 180 / np.pi)

    @property
    def reaction_column(self) -> Column:
        """The moment of a strip of unit width."""
        return Column("moment", "E0 L0^3")

    @property
    def free_translations(self) -> tuple[bool, bool]:
        """Both: the centre is free."""
        return True, True

    def prescribed(self, points: FloatArray, parameter: float) -> FloatArray:
        """(Q(angle) - 1)(X - centre)."""
        # 1 - cos by the half angle, which keeps its digits at small angles
        sine, versine = np.sin(parameter), 2 * np.sin(parameter / 2) ** 2
        turned: FloatArray = self._arms(points) @ np.array([[-versine, -sine], [sine, -versine]]).T
        return turned

    def rate(self, points: FloatArray, parameter: float) -> FloatArray:
        """dQ/dangle (X - centre)."""
        sine, cosine = np.sin(parameter), np.cos(parameter)
        turning: FloatArray = self._arms(points) @ np.array([[-sine, -cosine], [cosine, -sine]]).T
        return turning

    @staticmethod
    def _arms(points: FloatArray) -> FloatArray:
        # any point of the line would do: another one differs by a translation, which is free
        arms: FloatArray = points - points.mean(axis=0)
        return arms
