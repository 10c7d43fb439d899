"""Going on with a run that was interrupted, from its folder."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.console import Console

from isopeel.case import Case, Stage
from isopeel.common.errors import InputError
from isopeel.post.laboratory import Laboratory
from isopeel.results.run_file import StoredRun, read_run
from isopeel.running.folder import FILES, alone_in, check_overwritten, places, run_files
from isopeel.running.run import Result, check_later_stages, go_through, let_go_when_finished
from isopeel.solve.step import KINDS


def resume_case(folder: Path, console: Console, to: str | None = None, control: str | None = None) -> Result:
    """Go on with the run in a folder, as it was asked for, or to another end, or by another control.

    What is complete is said so, and gets the files that it lacks. A run that found no equilibrium stays as it
    is, unless a control is given that may find one. The steps are those of the uninterrupted run, to the last
    bit. Raises as `run_case` does, and InputError where there is no run in the folder.
    """
    run_files(folder)  # nothing is written to a folder of something else
    with alone_in(folder, "DIR"):
        case, stored = _found(folder, to, control)
        check_later_stages(case)
        where = places(case.name, [stage.name for stage in case.stages()], folder)
        written = [place.folder / name for place in where for name in FILES[1:]]
        check_overwritten("DIR", written, way="move it to another folder")
        if control is not None:
            stored = {number: replace(run, failure=None) for number, run in stored.items()}
        return let_go_when_finished(go_through(case, folder, console, stored), case, folder, console)


def _found(folder: Path, to: str | None, control: str | None) -> tuple[Case, dict[int, StoredRun]]:
    """The case of the run in a folder, and what is stored of its stages, by their numbers."""
    files = run_files(folder)
    # the stage that was begun last has the case as it was asked for last
    newest = files[-1]
    run = read_run(newest)
    try:
        case = Case.of_run(run.case_text, str(newest), run.attributes.get("dofs"))
    except InputError as error:
        raise InputError("DIR", str(folder), f"the case in it cannot be run any more: {error}") from error
    case = case.overridden(to=to, control=control)
    stages = case.stages()
    where = places(case.name, [stage.name for stage in stages], folder)
    stored = {}
    for number, (stage, place) in enumerate(zip(stages, where, strict=True)):
        if place.run_file in files:
            # a later stage goes on from the end of this one, whatever has been lost before
            stored[number] = read_run(place.run_file, journal=False)
            _check_way(case, stored[number], stage, folder, to)
        elif stored:
            break
    if not stored:
        raise InputError("DIR", str(folder), f"{newest} is of another case than its name says")
    return case, stored


def _check_way(case: Case, run: StoredRun, stage: Stage, folder: Path, to: str | None) -> None:
    """Raise InputError where the steps of a stored run are not the first ones of a stage."""
    column = run.curve.parameter_column
    steps = [column.shown(parameter) for parameter in stage.parameters]
    asked_for = run.curve.parameter[run.curve.kind == KINDS.index("requested")]
    if not np.isin(asked_for, steps).all():
        field, value = ("DIR", str(folder)) if to is None else ("--to", to)
        laboratory = Laboratory.of(case.units.system(), stage.problem)
        reached = f"{len(run.curve)} to {laboratory.parameter(column, float(run.curve.parameter[-1]))}"
        allowed = f"the steps so far, {reached}, are not on the way to it"
        raise InputError(field, value, allowed)
