"""What of a stored run is to be shown: its stages, and the states in them."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from isopeel.case.values import read_quantity
from isopeel.errors import InputError
from isopeel.post.summary import short_unit
from isopeel.stored import StoredStage, stored_stages


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

    Plain numbers are degrees. Raises InputError for --at, also where one lies off all that is stored.
    """
    return list(dict.fromkeys(_nearest(stage, value) for value in written))


def _nearest(stage: StoredStage, written: str) -> float:
    drive, stored = stage.stage.problem.drive, np.array(list(stage.run.fields))
    try:
        plain = drive.parameter_dimension.angle and _is_number(written)
        value = read_quantity(drive.parameter_dimension, f"{written} deg" if plain else written)
    except ValueError as error:
        raise InputError("--at", written, str(error)) from error
    room = stage.run.field_interval / 2
    if not stored.min() - room <= value <= stored.max() + room:
        unit = short_unit(drive.parameter_column)
        reach = f"from {stored.min():g} to {stored.max():g} {unit}"
        raise InputError("--at", written, f"displacements are stored {reach}")
    return float(stored[np.abs(stored - value).argmin()])


def _is_number(written: str) -> bool:
    try:
        float(written)
    except ValueError:
        return False
    return True
