"""Continue a run that was interrupted, from its folder."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.console import Console

from isopeel.case import Case, with_options
from isopeel.common.errors import InputError
from isopeel.results.run_file import StoredRun, read_run
from isopeel.running.checks import check_later_stages
from isopeel.running.folder import FILES, check_overwritten, run_files
from isopeel.running.lock import alone_in
from isopeel.running.run import Result, run_stages
from isopeel.running.sensitivities import Differentiation
from isopeel.running.stage_run import StageRun, stage_runs
from isopeel.solve.step import KINDS


def resume_case(
    folder: Path, console: Console, to: str | None = None, path_control: str | None = None
) -> Result:
    """Continue the run in a folder, with another end `to` or another path control where one is given.

    A complete run is reported as complete, and the files that it lacks are written. A run that found no
    equilibrium stays as it is unless a path control is given. The steps equal those of the uninterrupted run
    to the last bit. Raises the errors of `run_case`, and InputError where the folder holds no run.
    """
    run_files(folder)  # nothing is written to a folder of something else
    with alone_in(folder, "DIR"):
        runs, stored = _found(folder, to, path_control)
        check_later_stages(runs)
        written = [one.place.folder / name for one in runs for name in FILES[1:]]
        check_overwritten("DIR", written, remedy="move it to another folder")
        if path_control is not None:
            stored = {number: replace(run, failure=None) for number, run in stored.items()}
        return run_stages(runs, folder, console, stored, _differentiation(runs, stored, folder))


def _differentiation(
    runs: Sequence[StageRun], stored: Mapping[int, StoredRun], folder: Path
) -> Differentiation:
    """Return the sensitivities of a run, if it has some.

    Raises InputError where they depend on derivatives of earlier steps or stages, which are not stored.
    """
    keys = [one.key for run in stored.values() for one in run.curve.sensitive_to]
    if keys and (len(runs) > 1 or any(one.has_history for one in runs[0].stage.problem.interfaces)):
        allowed = (
            "with sensitivities, a run of several stages or of a joint with damage cannot be continued, as"
            " derivatives of its earlier states are not stored; run the case again"
        )
        if not all(replace(one, stored=stored.get(number)).is_complete for number, one in enumerate(runs)):
            raise InputError("DIR", str(folder), allowed)
        keys = []
    return Differentiation.of(runs[0].case, keys)


def _found(
    folder: Path, to: str | None, path_control: str | None
) -> tuple[list[StageRun], dict[int, StoredRun]]:
    """Return the stages of the run in a folder, and the stored runs of some of them by number."""
    files = run_files(folder)
    # the newest stage holds the case as it was last requested
    newest = files[-1]
    run = read_run(newest)
    try:
        case = Case.parse(run.case_text, str(newest))
    except InputError as error:
        raise InputError("DIR", str(folder), f"the case in it cannot be run any more: {error}") from error
    runs = stage_runs(with_options(case, to=to, path_control=path_control), folder)
    stored = {}
    for number, one in enumerate(runs):
        if one.place.run_file in files:
            # a later stage continues from the end of this one, even if files of earlier stages are lost
            stored[number] = read_run(one.place.run_file, journal=False)
            _check_steps(one, stored[number], folder, to)
        elif stored:
            break
    if not stored:
        raise InputError("DIR", str(folder), f"{newest} is not a stage of the case in this folder")
    return runs, stored


def _check_steps(one: StageRun, run: StoredRun, folder: Path, to: str | None) -> None:
    """Raise InputError where the steps of a stored run are not the first steps of a stage."""
    column = run.curve.parameter_column
    steps = [column.shown(parameter) for parameter in one.stage.parameters]
    requested = run.curve.parameter[run.curve.kind == KINDS.index("requested")]
    if not np.isin(requested, steps).all():
        field, value = ("DIR", str(folder)) if to is None else ("--to", to)
        last = one.laboratory.parameter(column, float(run.curve.parameter[-1]))
        reached = f"{len(run.curve)} to {last}"
        allowed = f"it does not continue the stored steps, {reached}"
        raise InputError(field, value, allowed)
