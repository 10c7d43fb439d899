"""What of a stored run is to be shown: its stages, and the states in them."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from isopeel.case.values import as_written, read_quantity
from isopeel.errors import InputError
from isopeel.stored import StoredStage, stored_stages
from isopeel.units import measured_in


def shown_stages(folder: Path) -> tuple[StoredStage, ...]:
    """The stages in the folder of a run, or the one in that of a stage, in which a step converged.

    Raises InputError where there is none, or where numbers of one are not finite.
    """
    stages = tuple(stage for stage in stored_stages(folder) if len(stage.run.curve) and stage.run.fields)
    if not stages:
        allowed = "no step of the run in it converged, so that there is nothing to show"
        raise InputError("DIR", str(folder), allowed)
    for stage in stages:
        run = stage.run
        arrays = run.curve.parameter, run.curve.reaction, np.array(list(run.fields)), *run.fields.values()
        if not all(np.isfinite(values).all() for values in arrays):
            raise InputError("DIR", str(stage.folder), "its curve or its fields hold numbers without a value")
    return stages


def shown_stage(folder: Path) -> StoredStage:
    """The same where there must be one stage alone."""
    stage, *others = shown_stages(folder)
    if others:
        folders = ", ".join(str(one.folder) for one in (stage, *others))
        raise InputError("DIR", str(folder), f"it holds several stages; give the folder of one: {folders}")
    return stage


def stored_parameters(stage: StoredStage, written: Sequence[str]) -> list[float]:
    """The parameters of the stored displacements that are nearest to those that a user writes, in turn.

    They are read in the units of the run's case. Plain numbers are degrees of an angle, and nothing else.
    Raises InputError for --at, also where one lies off all that is stored.
    """
    return list(dict.fromkeys(_nearest(stage, value) for value in written))


def _nearest(stage: StoredStage, written: str) -> float:
    drive, stored = stage.stage.problem.drive, np.array(list(stage.run.fields))
    dimension = drive.parameter_dimension
    try:
        with measured_in(stage.case.units.system()):
            value = read_quantity(dimension, as_written(dimension, written))
    except ValueError as error:
        raise InputError("--at", written, str(error)) from error
    room = stage.run.field_interval / 2
    if not stored.min() - room <= value <= stored.max() + room:
        ends = (
            stage.laboratory.parameter(drive.parameter_column, float(end))
            for end in (stored.min(), stored.max())
        )
        reach = "from {} to {}".format(*ends)
        raise InputError("--at", written, f"displacements are stored {reach}")
    return float(stored[np.abs(stored - value).argmin()])
