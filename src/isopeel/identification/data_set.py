"""A measured curve beside the case that it is compared with, in SI units."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from isopeel.case import Case
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.identification.measured import Measured
from isopeel.identification.parameters import Noise
from isopeel.identification.units import dimensions_of, in_si
from isopeel.running.stage_run import stage_runs

#: A measured abscissa may lie this part of the path beyond its end, for the round-off of units.
_ROUND_OFF = 1e-9


@dataclass(frozen=True, eq=False)
class DataSet:
    """The points x, y (points,) of a measured curve in SI units, angles in radians, and their case.

    `deviations` (points,) are the standard deviations of y, None if no noise is stated. `stage` is the number
    of the stage whose curve is measured, from zero.
    """

    measured: Measured
    case: Case
    values: Mapping[str, Any]
    stage: int
    x: FloatArray
    y: FloatArray
    deviations: FloatArray | None

    @property
    def name(self) -> str:
        """The name of the measured curve."""
        return Path(self.measured.name).name

    @property
    def size(self) -> float:
        """The largest measured value, in SI units."""
        return float(np.abs(self.y).max())

    def shown(self, values: FloatArray) -> FloatArray:
        """Return values of y in the unit of the measured column."""
        return values / in_si(self.measured.units[1])


def data_set_of(
    field: str,
    base: Case,
    measured: Measured,
    values: Mapping[str, Any],
    stage: str = "",
    noise: Noise | None = None,
) -> DataSet:
    """Return a measured curve beside the base case with other values of keys.

    Raises InputError if the units of the measured columns are not those of the curve of the stage, or if the
    measured range is not inside the path of the stage.
    """
    try:
        case = base.with_values(values)
    except InputError as error:
        raise InputError(f"{field}.set.{error.field}", error.value, error.allowed) from error
    runs = stage_runs(case, Path())
    names = [run.stage.name for run in runs]
    if stage and stage not in names:
        raise InputError(f"{field}.stage", stage, f"the stages are {', '.join(names)}")
    place = names.index(stage) if stage else len(runs) - 1
    run = runs[place]
    drive = run.stage.problem.drive
    sizes = []
    for column, unit, of_curve in zip(
        measured.headings, measured.units, (drive.parameter_column, drive.reaction_column), strict=True
    ):
        shown = run.laboratory.column(of_curve).name
        if dimensions_of(unit) != dimensions_of(shown):
            name = of_curve.name.removesuffix("_deg")
            allowed = f"the curve of the case has the {name} in {shown!r}, and {unit!r} is of another kind"
            if shown == "N/m" and unit == "N":
                allowed += "; the key body.width makes it a force"
            raise InputError(f"{measured.name}, {column}", unit, allowed)
        sizes.append(in_si(unit))
    x, y = measured.x * sizes[0], measured.y * sizes[1]
    parameter = run.laboratory.column(drive.parameter_column)
    path = run.stage.parameters * drive.parameter_column.factor * parameter.factor * in_si(parameter.name)
    slack = _ROUND_OFF * float(np.ptp(path))
    outside = np.flatnonzero((x < path.min() - slack) | (x > path.max() + slack))
    if len(outside):
        first, last = (float(value) / sizes[0] for value in (path.min(), path.max()))
        allowed = (
            f"the path of the case goes from {first:.6g} to {last:.6g} {measured.units[0]};"
            f" {len(outside)} of {len(x)} points are outside, such as this one"
        )
        raise InputError(f"{measured.name}, {measured.headings[0]}", float(measured.x[outside[0]]), allowed)
    deviations = None if measured.deviations is None else measured.deviations * sizes[1]
    if noise is not None:
        size = float(np.abs(y).max()) if noise.is_share else sizes[1]
        deviations = np.full(len(y), noise.value * size)
    if not y.any():
        raise InputError(measured.name, None, f"all values of {measured.headings[1]} are zero")
    return DataSet(measured, case, dict(values), place, x, y, deviations)
