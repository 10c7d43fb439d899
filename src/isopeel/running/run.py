"""A run: trace a case, and write its curve, file, summary and figures to a folder."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from shlex import quote
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from psutil import virtual_memory
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from isopeel.case import Case, Stage, load_case, shipped_cases
from isopeel.common.errors import InputError
from isopeel.common.interrupts import check, deferred, leave_time
from isopeel.post.figures import reaction_figure, save, shapes_figure
from isopeel.post.findings import Findings, find
from isopeel.post.laboratory import Laboratory
from isopeel.post.locking import locking_notes
from isopeel.post.mesh_error import mesh_changes
from isopeel.post.resolution_notes import estimate_notes
from isopeel.post.shown import in_laboratory
from isopeel.post.summary import summarize
from isopeel.post.summary_table import summary_rows
from isopeel.post.table import write_curve
from isopeel.results.curve import Curve
from isopeel.results.files import replacing
from isopeel.results.layout import Layout
from isopeel.results.notes import with_one_remedy
from isopeel.results.provenance import Provenance
from isopeel.results.run_file import Failure, StoredRun, read_run, run_attributes
from isopeel.results.run_writer import RunWriter
from isopeel.running.folder import (
    FILES,
    Place,
    alone_in,
    check_folder,
    clear_parts,
    make_folder,
    places,
)
from isopeel.running.previous_run import check_foreign, check_previous, keep_finished, kept_finished, let_go
from isopeel.running.progress import progress
from isopeel.solve.newton import ConvergenceError, NewtonSettings
from isopeel.solve.step import State, Step
from isopeel.solve.trace import check_stage, trace
from isopeel.splines.rows import RowSpace

#: Spaces of the displacement by names of bodies.
Spaces = Mapping[str, RowSpace]


class Result(NamedTuple):
    """The stored run of a stage, and its place."""

    run: StoredRun
    folder: Path


def run_case(case: Case, out: Path, console: Console, strict: bool = False, *, force: bool = False) -> Result:
    """Run a case and write its files to a folder, in place of those of an earlier run of it.

    A case of several stages has a folder for each stage inside, numbered and named. Returns the last stage
    that was run; the `ending` of its run is whether it was completed, found no equilibrium or was
    interrupted; the files hold all steps that converged before. Doubts about the discretization are printed
    before the first step; they are an error where the run is `strict`. An earlier run stays until the first
    step, and a finished one is kept beside the new one (`run.earlier.h5`) until the new one has finished too.

    Raises InputError where a folder cannot be written, another process runs in it or the run needs more
    memory than there is, OSError where a file cannot be written, and KeyboardInterrupt where there is no step
    yet. Without `force` it also raises InputError where the folder holds anything else than a run of this
    case, or a run that is longer or was interrupted.
    """
    if not force:
        check_foreign(out)
    # the stages are checked before any folder is made
    stages = case.stages()
    check_later_stages(case)
    steps = _steps(case, stages[0], case.spaces(), None, None)
    _say_doubts(case, console, strict)
    where = places(case.name, [stage.name for stage in stages], out)
    make_folder(out)
    with alone_in(out, "--out"):
        if force:
            files = ", ".join(str(place.run_file) for place in where if place.run_file.exists())
            replaced = files and f"replaces {files}"
        else:
            replaced = check_previous(case, stages, out)
        for place in where:
            check_folder(place.folder)
            clear_parts(place.folder)
        if replaced:
            console.print(replaced, soft_wrap=True)
            keep_finished(out)
        try:
            return let_go_when_finished(go_through(case, out, console, {}, steps), case, out, console)
        finally:
            let_go(out, replaced=False)


def let_go_when_finished(result: Result, case: Case, out: Path, console: Console) -> Result:
    """Remove the files kept of an earlier run once this one has finished; otherwise print where they are."""
    if is_complete(result.run, case.stages()[-1]):
        let_go(out)
    elif kept := kept_finished(out):
        names = ", ".join(map(str, kept))
        console.print(f"the finished run that was there before is kept: {names}", soft_wrap=True)
    return result


def _say_doubts(case: Case, console: Console, strict: bool) -> None:
    """Print the doubts about the discretization before the first step; raise InputError where `strict`."""
    spaces, notes = case.spaces(), []
    for stage in case.stages():
        laboratory = _laboratory(case, stage)
        notes += estimate_notes(stage.problem, spaces, laboratory)
        notes += locking_notes(stage.problem, spaces, laboratory)
    for note in with_one_remedy(list(dict.fromkeys(notes))):
        if strict:
            mesh = ", ".join("{}x{}".format(*space.elements) for space in spaces.values())
            raise InputError("discretization.mesh", mesh, f"{note.subject}: {note.text}")
        console.print(f"note: {note.text}", soft_wrap=True)


def check_later_stages(case: Case) -> None:
    """Check the stages after the first one, as far as possible before they begin.

    Raises InputError that names the stage; without this check the error could come after hours.
    """
    spaces = case.spaces()
    for number, stage in enumerate(case.stages()[1:], start=2):
        try:
            check_stage(stage.problem, spaces, NewtonSettings(path_control=stage.path_control))
        except InputError as error:
            named = case.named(error)
            field = named.field.replace("drive.", f"drive.{number}.", 1)
            raise InputError(field, error.value, f"in stage {number}, {error.allowed}") from error
        _check_memory(stage, spaces)


def go_through(
    case: Case,
    out: Path,
    console: Console,
    stored: Mapping[int, StoredRun],
    first_steps: Iterable[Step] | None = None,
) -> Result:
    """Run the stages of a case as `run_case` does, after the `stored` ones, by their numbers from zero.

    The stored runs come without the steps of their journals, and all but the last are complete. Stages before
    the first stored one do not change. The caller keeps other processes out of the folder, and may pass the
    steps of the first stage.
    """
    spaces, stages = case.spaces(), case.stages()
    base: State | None = None
    result: Result | None = None
    try:
        for number, place in enumerate(places(case.name, [stage.name for stage in stages], out)):
            stage, found = stages[number], stored.get(number)
            if number < min(stored, default=0):
                continue
            if base is None and found is not None and found.base is not None:
                base = State(0.0, found.base)
            if found is not None and is_complete(found, stage):
                run = _complete(case, stage, spaces, found, place, console)
            elif found is not None and found.failure is not None:
                run = found
            else:
                steps = first_steps or _steps(case, stage, spaces, base, found)
                first_steps = None
                run = _run_stage(case, stage, spaces, base, found, steps, place, console)
            result = Result(run, place.folder)
            if run.ending != "completed":
                break
            base = run.last
    except KeyboardInterrupt:
        if result is None:
            raise
        return result._replace(run=replace(result.run, ending="interrupted"))
    assert result is not None
    return result


def is_complete(run: StoredRun, stage: Stage) -> bool:
    """Return whether a stored run has completed a stage."""
    return run.ending == "completed" and _met(stage, run) == len(stage.parameters)


def _met(stage: Stage, run: StoredRun | None) -> int:
    """Return how many parameters of a stage a stored run has met, up to the state it continues from."""
    if run is None or run.last is None:
        return 0
    (places,) = np.nonzero(stage.parameters == run.last.parameter)
    return int(places[0]) + 1 if len(places) else 0


def _steps(
    case: Case, stage: Stage, spaces: Spaces, base: State | None, found: StoredRun | None
) -> Iterable[Step]:
    """Return the steps of a stage after the stored ones."""
    last = None if found is None else found.last
    passed, rest = np.split(stage.parameters, [_met(stage, found)])
    try:
        steps = trace(
            stage.problem,
            spaces,
            rest,
            NewtonSettings(path_control=stage.path_control),
            start=() if last is None else [last],
            passed=passed.tolist(),
            base=base,
            contact_points=case.discretization.contact_points,
        )
    except InputError as error:
        raise case.named(error) from error
    _check_memory(stage, spaces)
    return steps


def _check_memory(stage: Stage, spaces: Spaces) -> None:
    """Raise InputError where the displacements to store would fill the memory."""
    column = stage.problem.drive.parameter_column
    kept = min(abs(column.shown(stage.parameters[-1])) / stage.fields_every, len(stage.parameters))
    # they are in memory three times: as they are, in one array, and in the image of the file
    needed, free = 3 * 16 * sum(space.size for space in spaces.values()) * kept, virtual_memory().available
    if needed > free:
        gib = f"{needed / 2**30:.1f} GiB of memory, and {free / 2**30:.1f} GiB are free"
        allowed = f"the displacements at its multiples need {gib}"
        raise InputError("output.fields_every", f"{stage.fields_every:g} {column.unit}", allowed)


def _run_stage(
    case: Case,
    stage: Stage,
    spaces: Spaces,
    base: State | None,
    found: StoredRun | None,
    steps: Iterable[Step],
    place: Place,
    console: Console,
) -> StoredRun:
    began = perf_counter()
    problem, out = stage.problem, place.folder
    attributes: Mapping[str, str | int] = (
        {
            "L0": case.units.length,
            "E0": case.units.stress,
            "stage": stage.name,
            **run_attributes(problem, spaces, Provenance.of_this_process()),
        }
        if found is None
        else found.attributes
    )
    writer = RunWriter(
        place.run_file,
        problem.drive,
        case.text,
        attributes,
        stage.fields_every,
        place.outdated,
        None if base is None else base.displacement,
        found,
        0 if found is None else read_run(place.run_file).journaled,
        Layout.of(problem, spaces, case.discretization.contact_points),
    )
    with deferred():
        try:
            with writer:
                laboratory = _laboratory(case, stage)
                _follow(steps, stage, _met(stage, found), writer, console, laboratory)
        finally:
            _list_removed(writer, console)
            # the table must hold the steps of the file, whatever happens in between
            if writer.saved:
                write_curve(out / "curve.csv", writer.curve, problem, _laboratory(case, stage))
        run = replace(read_run(place.run_file), ending=writer.ending)
        try:
            summary, read = _write_results(case, stage, spaces, run, place, perf_counter() - began)
        except KeyboardInterrupt:
            return replace(run, ending="interrupted")
    if run.ending != "interrupted":
        _print_table(summary, run.curve, read, place, console)
    return run


def _complete(
    case: Case, stage: Stage, spaces: Spaces, run: StoredRun, place: Place, console: Console
) -> StoredRun:
    """Print that a stage is complete, and write the files that it lacks."""
    column, laboratory = run.curve.parameter_column, _laboratory(case, stage)
    reached = laboratory.parameter(column, float(run.curve.parameter[-1]))
    console.print(f"{place.title} is complete: {len(run.curve)} steps, to {reached}", soft_wrap=True)
    if not all((place.folder / name).exists() for name in FILES):
        _write_results(case, stage, spaces, run, place, float(run.curve.seconds.sum()))
    return run


def failure_message(failure: Failure, at: str, out: Path, folder: Path) -> str:
    """Return the message of a run that found no equilibrium `at` a parameter, with reason and iterations.

    `out` is the folder of its stage, and `folder` that of the whole run.
    """
    lines = [
        f"no equilibrium at {at}: {failure.reason}",
        f"cause: {failure.cause}; {failure.hint}",
        *["iteration  energy residual per unknown"][: len(failure.iterations)],
        *(f"{number:9d}  {measure:.3e}" for number, measure in enumerate(failure.iterations, start=1)),
        f"all steps that converged before are in {out}",
        f"`isopeel resume {quote(str(folder))} --control CONTROL` continues it with another path control",
    ]
    return "\n".join(lines)


def cases_table() -> Table:
    """Return a table of the shipped cases, with the first sentence of each."""
    table = Table("case", "what it is", box=SIMPLE_HEAD)
    for name in shipped_cases():
        table.add_row(name, load_case(name).about)
    return table


def _follow(
    steps: Iterable[Step],
    stage: Stage,
    met: int,
    writer: RunWriter,
    console: Console,
    laboratory: Laboratory,
) -> None:
    """Pass the steps to their consumers, and set how the run ends."""
    drive = stage.problem.drive
    try:
        with progress(console, drive, len(stage.parameters), met, laboratory.parameter) as show:
            for step in steps:
                writer.append(step)
                show(step)
                _list_removed(writer, console)
                if writer.saved:
                    leave_time()
                check()
        check()
        writer.end("completed")
    except ConvergenceError as error:
        parameter = drive.parameter_column.shown(error.parameter)
        writer.end("not converged", Failure(parameter, error.reason, error.iterations, error.cause))
    except KeyboardInterrupt:
        if len(writer.curve) == 0:
            raise
        writer.end("interrupted")


def _laboratory(case: Case, stage: Stage) -> Laboratory:
    return Laboratory.of(case.units.system(), stage.problem, case.width)


def _list_removed(writer: RunWriter, console: Console) -> None:
    """Print which files of an earlier run have been removed since the last call."""
    if writer.removed:
        console.print(f"removed {', '.join(map(str, writer.removed))}", soft_wrap=True)
        writer.removed.clear()


def _write_results(
    case: Case,
    stage: Stage,
    spaces: Spaces,
    run: StoredRun,
    place: Place,
    wall_time: float,
) -> tuple[dict[str, Any], Findings]:
    """Write curve, summary and, unless the run was interrupted, figures; return summary and findings."""
    out = place.folder
    found = find(stage.problem, spaces, run, stage.window, _laboratory(case, stage))
    write_curve(out / "curve.csv", run.curve, stage.problem, found.laboratory, found.fronts)
    # after Ctrl-C a finer mesh would take too long
    points = case.discretization.contact_points
    changes = [] if run.ending == "interrupted" else mesh_changes(stage.problem, spaces, run, points)
    summary = summarize(place.title, run, found, wall_time, changes)
    text = json.dumps(summary, indent=2, allow_nan=False)
    with replacing(out / "summary.json") as part:
        part.write_text(text + "\n", encoding="utf-8")
    # after Ctrl-C figures would take too long
    if len(run.curve) and run.ending != "interrupted":
        curve, plateau, closed_form, _ = in_laboratory(run.curve, found)
        for name, figure in (
            ("curve.png", reaction_figure(curve, plateau, closed_form)),
            ("shapes.png", shapes_figure(stage.problem, spaces, run.states, found.laboratory)),
        ):
            check()
            with replacing(out / name) as part:
                save(figure, part)
    return summary, found


def _print_table(
    summary: dict[str, Any], curve: Curve, found: Findings, place: Place, console: Console
) -> None:
    """Print the summary in a few lines, with the closed forms beside the values."""
    rows = summary_rows(summary, curve, found)
    columns = 4 if any(row.theory for row in rows) else 2
    heading = ("", "run", "closed form", "deviation")[:columns]
    table = Table(*heading, title=summary["case"], box=SIMPLE_HEAD)
    for row in rows:
        table.add_row(*row[:columns])
    console.print(table)
    if found.halves:
        console.print(found.halves, soft_wrap=True)
    for note in summary["notes"]:
        console.print(f"note: {note['text']}", soft_wrap=True)
    console.print(found.laboratory.note(), soft_wrap=True)
    console.print(f"files in {place.folder}", soft_wrap=True)
