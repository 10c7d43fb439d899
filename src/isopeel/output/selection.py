"""Select what to show of a stored run: its stages, and their states."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np
from rich.console import Console

from isopeel.case.values import as_written, read_quantity
from isopeel.common.errors import InputError
from isopeel.common.units import measured_in
from isopeel.results.fields import StoredState
from isopeel.running.run_reader import StoredStage, read_stages

#: States are the same where they differ by less than this share of the largest parameter of the path.
_SAME = 1e-9


def shown_stages(folder: Path) -> tuple[StoredStage, ...]:
    """Return the stages with a converged step, in the folder of a run or of a stage.

    Raises InputError if there is none.
    """
    stages = tuple(stage for stage in read_stages(folder) if len(stage.run.curve) and stage.run.states)
    if not stages:
        allowed = "its run has no converged step, so there is nothing to show"
        raise InputError("DIR", str(folder), allowed)
    return stages


def shown_stage(folder: Path) -> StoredStage:
    """Return the only stage in a folder. Raises InputError if there is none, or if there are several."""
    stage, *others = shown_stages(folder)
    if others:
        folders = ", ".join(str(one.folder) for one in (stage, *others))
        allowed = f"it contains several stages; give the folder of one stage: {folders}"
        raise InputError("DIR", str(folder), allowed)
    return stage


def chosen_states(stage: StoredStage, written: Sequence[str], console: Console) -> list[StoredState]:
    """Return the stored states nearest to the parameters that a user wrote, in their order.

    If several states have the same parameter, it is the last of them. If a state has another parameter than
    the written one, a line is printed. Parameters are read in the units of the run's case. Plain numbers are
    degrees, and allowed for angles only. Raises InputError for --at, also for a parameter beyond the path.
    """
    found = [_nearest(stage, value, console) for value in written]
    return list({state.step: state for state in found}.values())


def _nearest(stage: StoredStage, written: str, console: Console) -> StoredState:
    drive = stage.stage.problem.drive
    dimension = drive.parameter_dimension
    try:
        with measured_in(stage.case.units.system()):
            value = read_quantity(dimension, as_written(dimension, written))
    except ValueError as error:
        raise InputError("--at", written, str(error)) from error
    shown = partial(stage.laboratory.parameter, drive.parameter_column)
    path = stage.run.curve.parameter
    same = _SAME * float(np.abs(path).max())
    if not path.min() - same <= value <= path.max() + same:
        reach = f"the path goes from {shown(float(path.min()))} to {shown(float(path.max()))}"
        raise InputError("--at", written, reach)
    nearest = stage.run.nearest(value)
    if abs(nearest.parameter - value) > same:
        note = f"--at {written}: the nearest state that is stored is at {shown(nearest.parameter)}"
        console.print(f"{note}; `isopeel run --fields-every` stores more", soft_wrap=True)
    return nearest
