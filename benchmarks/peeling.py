"""A strip peeled to its plateau by large steps, and then by small timed steps."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

import isopeel
from isopeel.common.arrays import FloatArray

#: Degrees of a timed step, as in the published study.
STEP = 0.1
#: Number of timed steps: as many as a chord tangent serves at most, so that they include its assembly.
TIMED = 40
#: Number of small steps before the timed ones: those that the predictor uses, and some for the chord tangent.
SETTLING = 10
#: Length of the shipped strip in nm, and of its right end that does not adhere.
LENGTH = 200.0
FREE_LENGTH = 50.0


class Strip(NamedTuple):
    """A strip and its space; `length` in nm."""

    space: str
    mesh: tuple[int, int]
    length: float = LENGTH

    @property
    def problem(self) -> isopeel.Problem:
        """The shipped strip with another length: the free end is the same, and the adhering part longer."""
        return isopeel.strip(length=self.length, adhering_length=self.length - FREE_LENGTH)

    @property
    def row_space(self) -> isopeel.RowSpace:
        """Its space."""
        return isopeel.row_space(self.space, self.mesh)


def peel(strip: Strip, reach: float, coarse: float, steps: int) -> Iterator[isopeel.Step]:
    """Trace up to `reach` degrees by coarse steps and some small ones; return an iterator over `steps` more.

    Coarse steps that fail are cut. Earlier steps are not stored, because each has solver data.
    """
    angles = np.radians(angles_deg(reach, coarse, steps))
    settings = isopeel.NewtonSettings(path_control="auto")
    path = isopeel.trace(strip.problem, strip.row_space, angles, settings)
    last = angles[len(angles) - steps - 1]
    while next(path).parameter != last:
        pass
    return path


def angles_deg(reach: float, coarse: float, steps: int) -> FloatArray:
    """Return the angles in degrees from zero to `reach`, and those of `steps` steps beyond."""
    small = reach + STEP * np.arange(-SETTLING, steps + 1)
    return np.concatenate([np.arange(0, small[0] - STEP / 2, coarse), small])


def left_out(strip: Strip, error: isopeel.ConvergenceError) -> str:
    """Return the reason that a strip is not timed: on a coarse mesh the front jumps between elements."""
    shown = "{} {}x{}".format(strip.space, *strip.mesh)
    return f"{shown} is left out: no equilibrium at {np.degrees(error.parameter):g} degrees"
