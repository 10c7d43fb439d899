"""The commands that compute."""

import json
import shlex
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from isopeel.cli import completion
from isopeel.cli.base import (
    BAD_INPUT,
    COMPLETED,
    NOT_CONVERGED,
    command,
    console,
    fail,
    interrupted_message,
    unwritten,
)
from isopeel.cli.messages import JsonOption, QuietOption, VerboseOption, logged
from isopeel.common.errors import InputError
from isopeel.common.interrupts import INTERRUPTED, reporting

if TYPE_CHECKING:
    from isopeel.running.run import Result

_ForceOption = Annotated[
    bool, typer.Option("--force", help="Write to DIR even if it has other files; these remain.")
]
_ControlOption = Annotated[
    str | None,
    typer.Option(
        metavar="auto|newton|continuation|jump",
        help="What to do when a step finds no equilibrium.",
        autocompletion=completion.path_controls,
    ),
]


@command
def run(
    case: Annotated[
        str,
        typer.Argument(
            metavar="CASE",
            help="A TOML file, or a shipped case (see `isopeel cases`).",
            autocompletion=completion.cases,
        ),
    ],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder of the results; out/NAME by default.")
    ] = None,
    assigned: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="KEY=VALUE",
            help="Set a key of the case, such as body.height='12 nm', or body.2.height for the second of "
            "several bodies; KEY= removes the key. Repeatable.",
        ),
    ] = None,
    space: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Spline space, such as N2.1.", autocompletion=completion.spaces),
    ] = None,
    mesh: Annotated[str | None, typer.Option(metavar="NXxNY", help="Elements, such as 200x10.")] = None,
    to: Annotated[
        str | None,
        typer.Option(
            metavar="VALUE",
            help="Last parameter, with its unit, such as '20 nm'; a plain number is in degrees.",
        ),
    ] = None,
    step: Annotated[
        str | None, typer.Option(metavar="VALUE", help="Step of the parameter, in the same format.")
    ] = None,
    traction: Annotated[
        str | None,
        typer.Option(
            metavar="reference|projected",
            help="Area that the adhesive traction acts on.",
            autocompletion=completion.one_of("reference", "projected"),
        ),
    ] = None,
    contact_points: Annotated[
        int | None, typer.Option(metavar="N", help="Gauss points of the adhesive force on an element.")
    ] = None,
    control: _ControlOption = None,
    fields_every: Annotated[
        str | None,
        typer.Option(metavar="VALUE", help="Parameter between stored displacements, in the same format."),
    ] = None,
    sensitivities: Annotated[
        str,
        typer.Option(
            metavar="KEY,KEY,...",
            help="Differentiate the reaction by keys of the case, such as adhesion.strength,body.height.",
        ),
    ] = "",
    strict: Annotated[
        bool,
        typer.Option("--strict", help="Reject overlapping bodies, and a mesh that is too coarse or locks."),
    ] = False,
    force: Annotated[
        bool,
        typer.Option("--force", help="Replace any run in DIR, also a longer one; other files remain."),
    ] = False,
    dry_run: Annotated[
        bool,
        typer.Option(
            "--dry-run", help="Check the case and estimate the size and time of the run; write nothing."
        ),
    ] = False,
    quiet: QuietOption = False,
    as_json: JsonOption = False,
    verbose: VerboseOption = 0,
) -> int:
    """Run CASE, and write its curve, figures, summary and fields to a folder.

    If the folder has a run of the same case that is not longer, it is replaced. Without --force, a folder
    with other content is rejected.
    """
    folder: Path | None = None
    try:
        from isopeel.case import assignment, load_case, with_options

        values = dict(assignment(text) for text in assigned or ())
        read = load_case(case)
        chosen = with_options(
            read.with_values(values) if values else read,
            space=space,
            mesh=mesh,
            to=to,
            step=step,
            traction=traction,
            contact_points=contact_points,
            path_control=control,
            fields_every=fields_every,
        )
        folder = out or Path("out") / chosen.name
        # this import takes a while: errors in the case are reported before it
        from isopeel.running.warm_up import warmed_up_beside

        printed = console(quiet=quiet or as_json)
        if dry_run:
            with reporting("interrupted"), logged(verbose), warmed_up_beside():
                from isopeel.running.preview import preview

                found = preview(chosen, folder, strict=strict, force=force)
            found.print(printed)
            if as_json:
                _print_json(found.as_json())
            return COMPLETED
        message = f"interrupted; {interrupted_message(folder)}"
        with reporting("interrupted", message), logged(verbose), warmed_up_beside():
            from isopeel.running.run import run_case

            keys = [key.strip() for key in sensitivities.split(",")] if sensitivities else []
            result = run_case(chosen, folder, printed, strict, force=force, sensitivities=keys)
    except InputError as error:
        # some errors of options are found by the solver
        for option, value in (("mesh", mesh), ("contact_points", contact_points)):
            if error.field == f"discretization.{option}" and error.value == value:
                raise InputError(f"--{option.replace('_', '-')}", value, error.allowed) from error
        raise
    except OSError as error:
        return fail(BAD_INPUT, unwritten(error, folder))
    return _ended(result, folder, as_json)


@command
def resume(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a run that was interrupted.")],
    to: Annotated[
        str | None,
        typer.Option(metavar="VALUE", help="Another last parameter, in the same format as for `run`."),
    ] = None,
    control: _ControlOption = None,
    quiet: QuietOption = False,
    as_json: JsonOption = False,
    verbose: VerboseOption = 0,
) -> int:
    """Continue a run that was interrupted or killed. The steps equal those of an uninterrupted run."""
    try:
        from isopeel.running.warm_up import warmed_up_beside

        message = f"interrupted; {interrupted_message(folder)}"
        with reporting(message), logged(verbose), warmed_up_beside():
            from isopeel.running.resume import resume_case

            result = resume_case(folder, console(quiet=quiet or as_json), to, control)
    except KeyboardInterrupt:
        return fail(INTERRUPTED, f"interrupted; {interrupted_message(folder)}")
    except OSError as error:
        return fail(BAD_INPUT, unwritten(error, folder))
    return _ended(result, folder, as_json)


def _print_json(found: object) -> None:
    """Print an object as JSON, in ASCII, which each terminal has."""
    typer.echo(json.dumps(found, indent=2, allow_nan=False))


def _ended(result: "Result", folder: Path, as_json: bool) -> int:
    """Print how a run ended, and return the exit code for it."""
    from isopeel.running.failure import failure_message

    if as_json:
        from isopeel.output.run_object import run_object

        _print_json(run_object(result, folder))

    run, stage_folder = result
    if run.ending == "interrupted":
        return fail(INTERRUPTED, f"interrupted; {interrupted_message(folder)}")
    if run.failure is not None:
        return fail(NOT_CONVERGED, failure_message(run.failure, stage_folder, folder))
    return COMPLETED


@command
def paper(
    only: Annotated[
        list[str] | None,
        typer.Option(
            metavar="PART",
            help="A part of the report, such as table2; repeatable.",
            autocompletion=completion.parts,
        ),
    ] = None,
    mesh: Annotated[
        list[str] | None,
        typer.Option(
            metavar="m1|m2|m3",
            help="A mesh of the study; repeatable.",
            autocompletion=completion.one_of("m1", "m2", "m3"),
        ),
    ] = None,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder of the report and its runs.")] = Path(
        "out/paper"
    ),
    force: _ForceOption = False,
    quiet: QuietOption = False,
) -> int:
    """Run the published study, and write a report that compares our results with the published ones.

    Finished runs are stored, so that the same command continues an interrupted study.
    """
    stored = f"finished runs are in {out}; the same command continues the study"
    try:
        from isopeel.common.processes import WorkerLostError
        from isopeel.paper.report import chosen_meshes, chosen_parts, make_report

        try:
            with reporting(f"interrupted; {stored}"):
                parts, meshes = chosen_parts(only or []), chosen_meshes(mesh or [])
                page = make_report(parts, meshes, out, console(quiet=quiet), force=force)
        except WorkerLostError as error:
            return fail(BAD_INPUT, f"{error}; {stored}")
    except KeyboardInterrupt:
        return fail(INTERRUPTED, f"interrupted; {stored}")
    console(quiet=quiet).print(f"the report is {page}", soft_wrap=True)
    return COMPLETED


@command
def study(
    file: Annotated[Path, typer.Argument(metavar="STUDY", help="The TOML file of a study.")],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder of the results; out/NAME by default.")
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="Processes; one for each core by default.")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS|processes",
            help="A scheduler of Dask, such as tcp://host:8786. Default: a cluster of Dask here, or "
            "processes where Dask is not installed.",
        ),
    ] = None,
    force: _ForceOption = False,
    quiet: QuietOption = False,
) -> int:
    """Run a case with other values of its keys, and write a table, figures and a report.

    Finished runs are stored, so that the same command continues an interrupted study, and a study with more
    values computes the new runs only.
    """
    from isopeel.study.study_file import read_study

    chosen = read_study(file)
    folder = out or Path("out") / chosen.name
    stored = f"finished runs are in {folder}; the same command continues the study"
    try:
        from isopeel.common.processes import cores

        with reporting(f"interrupted; {stored}"):
            from isopeel.study.on_dask import executor_of
            from isopeel.study.run import run_study

            show = partial(console(quiet=quiet).print, soft_wrap=True)
            results = run_study(
                chosen,
                folder,
                console(quiet=quiet),
                executor_of(scheduler, workers or cores(), show, "--scheduler"),
                force=force,
                command=f"isopeel study {shlex.quote(str(file))}",
            )
    except KeyboardInterrupt:
        return fail(INTERRUPTED, f"interrupted; {stored}")
    console(quiet=quiet).print(f"the report is {folder / 'report.html'}", soft_wrap=True)
    failed = sum(outcome.ending != "completed" for outcome in results.outcomes)
    if failed:
        message = f"{failed} of {len(results.outcomes)} runs were not completed; the table has the causes"
        return fail(NOT_CONVERGED, message)
    return COMPLETED


@command
def validate(
    only: Annotated[
        list[str] | None,
        typer.Option(
            metavar="CHECK",
            help="A check, such as tapes; repeatable.",
            autocompletion=completion.checks,
        ),
    ] = None,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder of the report.")] = Path("out/validation"),
    force: _ForceOption = False,
    quiet: QuietOption = False,
) -> int:
    """Compare runs with closed forms, and write a report with all deviations."""
    from isopeel.common.processes import WorkerLostError
    from isopeel.validation.report import chosen_checks
    from isopeel.validation.report import validate as run_checks

    try:
        found = run_checks(chosen_checks(only or []), out, console(quiet=quiet), force=force)
    except WorkerLostError as error:
        return fail(BAD_INPUT, str(error))
    console(quiet=quiet).print(f"the report is {found.page}", soft_wrap=True)
    if found.failed:
        return fail(NOT_CONVERGED, f"rows with too large a deviation: {found.failed}; see {found.page}")
    return COMPLETED
