"""A run: trace a case, and leave its curve, file, summary and figures in a folder."""

import json
from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryFile
from time import perf_counter
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from isopeel.case import Case
from isopeel.errors import InputError
from isopeel.post.closed_form import beam_peeling
from isopeel.post.figures import moment_figure, save, shapes_figure
from isopeel.post.reading import read_plateau
from isopeel.post.summary import summarize
from isopeel.problem import Drive, Problem
from isopeel.progress import progress
from isopeel.results.provenance import Provenance
from isopeel.results.run_file import Failure, RunWriter, StoredRun, read_run, run_attributes
from isopeel.solve.newton import ConvergenceError
from isopeel.solve.trace import Step, trace
from isopeel.splines.rows import RowSpace

#: Files that a run leaves in its folder.
FILES = ("run.h5", "curve.csv", "summary.json", "moment.png", "shapes.png")


def run_case(case: Case, out: Path, console: Console) -> StoredRun:
    """Run a case and write its files to a folder, in place of those of an earlier run.

    Returns what was stored; its `ending` says whether the run came to its end, found no equilibrium or
    was interrupted: all that converged before is in the files. Raises InputError where the folder
    cannot be written or the memory does not suffice, OSError where a file cannot be written, and
    KeyboardInterrupt where there is no step yet; an earlier run stays until there is one.
    """
    began = perf_counter()
    problem, space, angles = case.problem(), case.space(), case.angles()
    try:
        steps = trace(problem, space, angles, contact_points=case.discretization.contact_points)
    except InputError as error:
        chosen = error.field in ("mesh", "contact_points")
        field = f"discretization.{error.field}" if chosen else error.field
        raise InputError(field, error.value, error.allowed) from error
    _check_folder(out)
    file, *others = (out / name for name in FILES)
    attributes = run_attributes(problem, space, Provenance.of_this_process())
    writer = RunWriter(file, problem.drive, case.text, attributes, case.output.fields_every, others)
    try:
        with writer:
            _follow(steps, problem.drive, len(angles), writer, console)
    finally:
        # whatever comes in between, the table holds what the file does
        if writer.saved:
            writer.curve.write_csv(out / "curve.csv")
    run = read_run(file)
    summary = _write_results(case, problem, space, run, out, perf_counter() - began)
    if run.ending != "interrupted":
        _print_table(summary, out, console)
    return run


def failure_message(failure: Failure, out: Path) -> str:
    """Say where and why a run found no equilibrium, with its iterations."""
    lines = [
        f"no equilibrium at {failure.parameter:g} deg: {failure.reason}",
        "iteration  energy residual per unknown",
        *(f"{number:9d}  {measure:.3e}" for number, measure in enumerate(failure.iterations, start=1)),
        f"everything that converged before is in {out}",
    ]
    return "\n".join(lines)


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
        angle = drive.parameter_column.shown(error.parameter)
        writer.end("not converged", Failure(angle, error.reason, error.iterations))
    except KeyboardInterrupt:
        if not writer.saved:
            raise
        writer.end("interrupted")


def _write_results(
    case: Case, problem: Problem, space: RowSpace, run: StoredRun, out: Path, wall_time: float
) -> dict[str, Any]:
    """Write the figures and the summary, and return the latter."""
    closed_form = beam_peeling(problem)
    period = closed_form.period_deg(space.elements[0]) if closed_form else None
    plateau = read_plateau(run.curve, case.reading.window, period) if case.reading else None
    summary = summarize(case, run, plateau, closed_form, period, wall_time)
    text = json.dumps(summary, indent=2, allow_nan=False)
    (out / "summary.json").write_text(text + "\n", encoding="utf-8")
    if len(run.curve):
        save(moment_figure(run.curve, plateau, closed_form), out / "moment.png")
        save(shapes_figure(problem, space, run.fields), out / "shapes.png")
    return summary


def _print_table(summary: dict[str, Any], out: Path, console: Console) -> None:
    """Print the summary in a few lines, with the closed form beside what it tells."""
    moment, slopes, window = summary["units"]["moment"], summary["slopes"], summary["window"]
    closed_form = summary["closed_form"] or {}
    table = Table("", "run", "closed form", title=summary["case"], box=SIMPLE_HEAD)
    table.add_row("space", f"{summary['space']}, {summary['mesh']}, {summary['dofs']} DOFs")
    table.add_row("angle", _shown(summary["angle"], "g", "deg"))
    table.add_row(
        "plateau", _shown(summary["plateau"], ".6f", moment), _shown(closed_form.get("moment"), ".4f", moment)
    )
    if slopes is not None:
        table.add_row("amplitude", _shown(summary["amplitude"], ".3e", moment))
        steepest = f"{slopes['rise']:+.3e}, {slopes['fall']:+.3e} {moment}/deg"
        table.add_row("steepest slopes", steepest)
        table.add_row("read between", f"{window[0]:g} and {window[1]:g} deg")
    table.add_row(
        "onset", _shown(summary["onset"], ".1f", "deg"), _shown(closed_form.get("onset"), ".1f", "deg")
    )
    per_step = _shown(summary["newton_iterations_per_step"], ".2f", "per step")
    table.add_row("Newton iterations", f"{summary['newton_iterations']}, {per_step}")
    table.add_row("time", f"{summary['wall_time_s']:.1f} s")
    console.print(table)
    if summary["note"]:
        console.print(f"not read: {summary['note']}")
    console.print(f"files in {out}", soft_wrap=True)


def _shown(value: float | None, digits: str, unit: str) -> str:
    return "-" if value is None else f"{value:{digits}} {unit}"
