"""The stages of a case: one problem after the other, each followed along its own parameter."""

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from isopeel.case.values import read_quantity
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.path_control import PathControl
from isopeel.common.quantities import Dimension
from isopeel.common.units import UnitSystem, parse_quantity, shown
from isopeel.problem import Problem

#: More steps than this are a slip of the pen: a thousandth of a degree up to 100 degrees.
MOST_STEPS = 100_000
#: Of all stages. A step takes some milliseconds on a small mesh, so that this is half an hour there and some
#: days on a large one; the table of a run is held in memory, and drawn.
MOST_STEPS_IN_ALL = 200_000
#: Fifty cycles of loading and unloading: each stage has a folder, figures and a start of its own.
MOST_STAGES = 100


@dataclass(frozen=True, eq=False)
class Stage:
    """A problem, whose drive is that of the stage, and the parameters (n,) of its steps, from 0 on.

    Its `path_control` says how the path goes on where a step finds no equilibrium. The plateau is read in the
    `window`, and fields are kept at multiples of `fields_every`: in degrees, or in L0 and E0.
    """

    name: str
    problem: Problem
    parameters: FloatArray
    path_control: PathControl
    fields_every: float
    window: tuple[float, float] | None


class Steps(NamedTuple):
    """How far a stage goes, in degrees or in L0 and E0, and the size and the number of its steps."""

    last: float
    size: float
    number: int


def stage_steps(dimension: Dimension, to: object, step: object) -> Steps:
    """Read how far a stage goes, and in which steps; both are written with their units. Raises InputError."""
    last, size = _read(dimension, "to", to), _read(dimension, "step", step)
    if dimension.angle and not 0 < last <= 180:
        raise InputError("drive.to", to, "it must be above 0 and at most 180 degrees")
    if last == 0:
        raise InputError("drive.to", to, "it must not be zero")
    if not size > 0:
        raise InputError("drive.step", step, "it must be positive")
    if abs(last) / size > MOST_STEPS:
        least = _least_step(dimension, to)
        allowed = f"at most {MOST_STEPS} steps are made, so a step of at least {least} is needed"
        raise InputError("drive.step", step, allowed)
    # a last step of round-off size would be none at all
    return Steps(last, size, int(np.ceil(abs(last) / size * (1 - 1e-12))))


def stage_parameters(dimension: Dimension, to: object, step: object) -> FloatArray:
    """Return parameters of the steps: 0, the multiples of the step, and the last parameter.

    Angles come in radians, all else in L0 and E0. Raises InputError as `stage_steps` does.
    """
    last, size, number = stage_steps(dimension, to, step)
    # multiples of what was written, 0.3 and not 0.30000000000000004
    written = Decimal(repr(size if last > 0 else -size))
    parameters = np.array([0.0, *(float(k * written) for k in range(1, number)), last])
    return np.radians(parameters) if dimension.angle else parameters


def check_work(counts: Sequence[int]) -> None:
    """Raise InputError where stages of these numbers of steps are more work than any run is meant for."""
    if sum(counts) > MOST_STEPS_IN_ALL:
        written = f"{len(counts)} stages of {sum(counts)} steps in all"
        allowed = f"at most {MOST_STEPS_IN_ALL} steps are made; take larger steps or fewer stages"
        raise InputError("drive", written, allowed)


def check_number(stages: object) -> object:
    """Raise InputError where there are too many stages for each of them to be read."""
    if isinstance(stages, list) and len(stages) > MOST_STAGES:
        allowed = f"a case has at most {MOST_STAGES} stages"
        raise InputError("drive", f"{len(stages)} stages", allowed)
    return stages


def _least_step(dimension: Dimension, to: object) -> str:
    """Return the least step to somewhere, with its unit, whatever the case measures in."""
    end = parse_quantity(str(to))
    if dimension.angle:
        return f"{abs(end.value) / MOST_STEPS:g} deg"
    least = float(abs(end.exact) / MOST_STEPS)
    return shown(least, UnitSystem(Fraction(1), Fraction(1)), dimension.stress, dimension.length)


def _read(dimension: Dimension, key: str, written: object) -> float:
    try:
        return read_quantity(dimension, written)
    except ValueError as error:
        raise InputError(f"drive.{key}", written, str(error)) from error
