"""A run: trace a case, and leave its curve, file, summary and figures in a folder."""

import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from tempfile import TemporaryFile
from time import perf_counter
from typing import Any, NamedTuple

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from isopeel.case import Case, Stage, load_case, shipped_cases
from isopeel.errors import InputError
from isopeel.post.closed_form import Expected, expected
from isopeel.post.fields import depth_inside
from isopeel.post.figures import reaction_figure, save, shapes_figure
from isopeel.post.reading import read_plateau
from isopeel.post.summary import summarize
from isopeel.problem import Column, Drive
from isopeel.progress import progress
from isopeel.results.curve import Curve
from isopeel.results.provenance import Provenance
from isopeel.results.run_file import Failure, RunWriter, StoredRun, read_run, run_attributes
from isopeel.solve.newton import ConvergenceError, NewtonSettings
from isopeel.solve.step import State, Step
from isopeel.solve.trace import trace
from isopeel.splines.rows import RowSpace

#: Files that a run leaves in its folder.
FILES = ("run.h5", "curve.csv", "summary.json", "curve.png", "shapes.png")


class Result(NamedTuple):
    """What was stored of a stage, and where."""

    run: StoredRun
    folder: Path


class _Place(NamedTuple):
    """Where the files of a stage go, what it is called, and which files it makes outdated."""

    folder: Path
    title: str
    outdated: list[Path]


def run_case(case: Case, out: Path, console: Console) -> Result:
    """Run a case and write its files to a folder, in place of those of an earlier run.

    A case of several stages has a folder for each of them inside, numbered and named. Returns the last
    stage that was run; the `ending` of its run says whether that came to its end, found no equilibrium or
    was interrupted: all that converged before is in the files. Raises InputError where a folder cannot be
    written or the memory does not suffice, OSError where a file cannot be written, and KeyboardInterrupt
    where there is no step yet; an earlier run stays until there is one.
    """
    space, stages = case.space(), case.stages()
    places = _places(case.name, [stage.name for stage in stages], out)
    base: State | None = None
    for stage, place in zip(stages, places, strict=True):
        steps = _steps(case, stage, space, base)
        for folder in (place.folder for place in places if base is None):
            _check_folder(folder)
        run = _run_stage(case, stage, space, base, steps, place, console)
        if run.ending != "completed":
            break
        base = run.last[-1]
    return Result(run, place.folder)


def _places(name: str, stages: Sequence[str], out: Path) -> list[_Place]:
    """The places of the stages of a case: `out` itself for the only one, folders inside for several."""
    folders = [out]
    titles = [name]
    if len(stages) > 1:
        folders = [out / f"{number}-{stage}" for number, stage in enumerate(stages, start=1)]
        titles = [f"{name}, stage {number}: {stage}" for number, stage in enumerate(stages, start=1)]
    earlier = {path.parent for path in out.glob("[0-9]*-*/run.h5")} | {out, *folders}
    return [
        _Place(
            folder,
            title,
            # what later stages and runs with other stages have left
            [path / file for path in earlier - set(folders[: number + 1]) for file in FILES]
            + [folder / file for file in FILES[1:]],
        )
        for number, (folder, title) in enumerate(zip(folders, titles, strict=True))
    ]


def _steps(case: Case, stage: Stage, space: RowSpace, base: State | None) -> Iterable[Step]:
    try:
        return trace(
            stage.problem,
            space,
            stage.parameters,
            NewtonSettings(control=stage.control),
            base=base,
            contact_points=case.discretization.contact_points,
        )
    except InputError as error:
        chosen = error.field in ("mesh", "contact_points")
        field = f"discretization.{error.field}" if chosen else error.field
        raise InputError(field, error.value, error.allowed) from error


def _run_stage(
    case: Case,
    stage: Stage,
    space: RowSpace,
    base: State | None,
    steps: Iterable[Step],
    place: _Place,
    console: Console,
) -> StoredRun:
    began = perf_counter()
    problem, out = stage.problem, place.folder
    attributes: dict[str, str | int] = {
        "L0": case.units.length,
        "E0": case.units.stress,
        "stage": stage.name,
        **run_attributes(problem, space, Provenance.of_this_process()),
    }
    writer = RunWriter(
        out / FILES[0],
        problem.drive,
        case.text,
        attributes,
        stage.fields_every,
        place.outdated,
        None if base is None else base.displacement,
    )
    try:
        with writer:
            _follow(steps, problem.drive, len(stage.parameters), writer, console)
    finally:
        # whatever comes in between, the table holds what the file does
        if writer.saved:
            writer.curve.write_csv(out / "curve.csv")
    run = read_run(out / FILES[0])
    # what theory says is of a body that begins at rest
    closed_form = expected(problem, space) if base is None else None
    summary = _write_results(stage, space, run, closed_form, place, perf_counter() - began)
    if run.ending != "interrupted":
        _print_table(summary, run.curve, place, console)
    return run


def failure_message(failure: Failure, column: Column, out: Path) -> str:
    """Say at which parameter and why a run found no equilibrium, with its iterations."""
    unit = _short(column)
    lines = [
        f"no equilibrium at {failure.parameter:g} {unit}: {failure.reason}",
        f"cause: {failure.cause}; {failure.hint}",
        *["iteration  energy residual per unknown"][: len(failure.iterations)],
        *(f"{number:9d}  {measure:.3e}" for number, measure in enumerate(failure.iterations, start=1)),
        f"everything that converged before is in {out}",
    ]
    return "\n".join(lines)


def cases_table() -> Table:
    """List the shipped cases, with the first sentence of each."""
    table = Table("case", "what it is", box=SIMPLE_HEAD)
    for name in shipped_cases():
        table.add_row(name, load_case(name).about)
    return table


def _check_folder(out: Path) -> None:
    try:
        out.mkdir(parents=True, exist_ok=True)
        TemporaryFile(dir=out).close()
    except OSError as error:
        allowed = f"a folder that can be written is needed: {error.strerror}"
        raise InputError("--out", str(out), allowed) from error
    for name in FILES:
        if (out / name).exists() and not (out / name).is_file():
            raise InputError("--out", str(out), f"{name} in it must be a file, where there is one")


def _follow(steps: Iterable[Step], drive: Drive, count: int, writer: RunWriter, console: Console) -> None:
    """Hand the steps to their consumers, and note how they end."""
    try:
        with progress(console, drive, count) as show:
            for step in steps:
                writer.append(step)
                show(step)
        writer.end("completed")
    except ConvergenceError as error:
        parameter = drive.parameter_column.shown(error.parameter)
        writer.end("not converged", Failure(parameter, error.reason, error.iterations, error.cause))
    except KeyboardInterrupt:
        if not writer.saved:
            raise
        writer.end("interrupted")


def _write_results(
    stage: Stage,
    space: RowSpace,
    run: StoredRun,
    closed_form: Expected | None,
    place: _Place,
    wall_time: float,
) -> dict[str, Any]:
    """Write the figures and the summary, and return the latter."""
    out, window = place.folder, stage.window
    period = closed_form.period if closed_form else None
    plateau = read_plateau(run.curve, window, period) if window else None
    inside = depth_inside(stage.problem, space, run.fields)
    summary = summarize(place.title, run, window, plateau, closed_form, inside, wall_time)
    text = json.dumps(summary, indent=2, allow_nan=False)
    (out / "summary.json").write_text(text + "\n", encoding="utf-8")
    if len(run.curve):
        units = _units(summary)
        save(reaction_figure(run.curve, plateau, closed_form, units), out / "curve.png")
        save(shapes_figure(stage.problem, space, run.fields, units), out / "shapes.png")
    return summary


def _units(summary: dict[str, Any]) -> str:
    return "L0 = {L0}, E0 = {E0}".format(**summary["units"])


def _print_table(summary: dict[str, Any], curve: Curve, place: _Place, console: Console) -> None:
    """Print the summary in a few lines, with the closed form beside what it tells."""
    parameter, reaction = curve.parameter_column, curve.reaction_column
    unit = _short(parameter)
    slopes, window, peak = summary["slopes"], summary["window"], summary["peak"]
    theory = summary["closed_form"] or {}
    table = Table("", "run", theory.get("source", "closed form"), title=summary["case"], box=SIMPLE_HEAD)
    table.add_row("space", f"{summary['space']}, {summary['mesh']}, {summary['dofs']} DOFs")
    table.add_row("reached", _shown(summary[parameter.name], "g", unit))
    if peak is not None:
        at = f" at {peak[parameter.name]:g} {unit}"
        table.add_row(f"largest {reaction.name}", _shown(peak[reaction.name], ".6g", reaction.unit) + at)
    value = theory.get("reaction")
    if summary["plateau"] is not None or value is not None:
        table.add_row(
            "plateau", _shown(summary["plateau"], ".6f", reaction.unit), _shown(value, ".5g", reaction.unit)
        )
    if slopes is not None:
        table.add_row("amplitude", _shown(summary["amplitude"], ".3e", reaction.unit))
        steepest = f"{slopes['rise']:+.3e}, {slopes['fall']:+.3e} {reaction.unit}/{unit}"
        table.add_row("steepest slopes", steepest)
        table.add_row("read between", f"{window[0]:g} and {window[1]:g} {unit}")
    if summary["onset"] is not None or theory.get("onset") is not None:
        table.add_row(
            "onset", _shown(summary["onset"], ".1f", unit), _shown(theory.get("onset"), ".1f", unit)
        )
    if summary["jumps"]:
        released = sum(jump["released_energy"] for jump in summary["jumps"])
        table.add_row("jumps", f"{len(summary['jumps'])}, releasing {released:.4g} E0 L0^3")
    per_step = _shown(summary["corrections_per_step"], ".2f", "per step")
    table.add_row("corrections", f"{summary['corrections']}, {per_step}")
    table.add_row("time", f"{summary['wall_time_s']:.1f} s")
    console.print(table)
    if summary["note"]:
        console.print(f"note: {summary['note']}", soft_wrap=True)
    console.print(f"{_units(summary)}; for a width of L0")
    console.print(f"files in {place.folder}", soft_wrap=True)


def _short(column: Column) -> str:
    return "deg" if column.unit == "degree" else column.unit


def _shown(value: float | None, digits: str, unit: str) -> str:
    return "-" if value is None else f"{value:{digits}} {unit}"
