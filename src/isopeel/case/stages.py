"""The stages of a case: one problem after the other, each followed along its own parameter."""

from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction

import numpy as np

from isopeel.arrays import FloatArray
from isopeel.case.values import read_quantity
from isopeel.controls import Control
from isopeel.errors import InputError
from isopeel.problem import Problem
from isopeel.quantities import Dimension
from isopeel.units import UnitSystem, parse_quantity, shown

#: More steps than this are a slip of the pen: a thousandth of a degree up to 100 degrees.
MOST_STEPS = 100_000


@dataclass(frozen=True, eq=False)
class Stage:
    """A problem, whose drive is that of the stage, and the parameters (n,) of its steps, from 0 on.

    Its `control` says how the path goes on where a step finds no equilibrium. The plateau is read in the
    `window`, and fields are kept at multiples of `fields_every`: in degrees, or in L0 and E0.
    """

    name: str
    problem: Problem
    parameters: FloatArray
    control: Control
    fields_every: float
    window: tuple[float, float] | None


def stage_parameters(dimension: Dimension, to: object, step: object) -> FloatArray:
    """Parameters of the steps: 0, the multiples of the step, and the last parameter.

    Both are written with their units; angles come in radians, all else in L0 and E0. Raises InputError.
    """
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
    full_steps = int(np.ceil(abs(last) / size * (1 - 1e-12)))
    # multiples of what was written, 0.3 and not 0.30000000000000004
    written = Decimal(repr(size if last > 0 else -size))
    parameters = np.array([0.0, *(float(k * written) for k in range(1, full_steps)), last])
    return np.radians(parameters) if dimension.angle else parameters


def _least_step(dimension: Dimension, to: object) -> str:
    """The least step to somewhere, with its unit, whatever the case measures in."""
    way = parse_quantity(str(to))
    if dimension.angle:
        return f"{abs(way.value) / MOST_STEPS:g} deg"
    least = float(abs(way.exact) / MOST_STEPS)
    return shown(least, UnitSystem(Fraction(1), Fraction(1)), dimension.stress, dimension.length)


def _read(dimension: Dimension, key: str, written: object) -> float:
    try:
        return read_quantity(dimension, written)
    except ValueError as error:
        raise InputError(f"drive.{key}", written, str(error)) from error
