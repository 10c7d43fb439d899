"""The command line."""

import shlex
import signal
import sys
from collections.abc import Sequence
from io import TextIOWrapper
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from typer.exceptions import TyperException

import isopeel
from isopeel.errors import InputError

if TYPE_CHECKING:
    from rich.console import Console

    from isopeel.run import Result

# The commands import what they need themselves: help should not wait for a compiler.

COMPLETED, BAD_INPUT, NOT_CONVERGED, INTERRUPTED = 0, 2, 3, 130

app = typer.Typer(pretty_exceptions_enable=False)


_ControlOption = Annotated[
    str | None,
    typer.Option(
        metavar="auto|newton|continuation|jump", help="What to do where a step finds no equilibrium."
    ),
]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line, by default the process's own, and return its exit code.

    0: done; 2: bad input, or a file that cannot be written; 3: no equilibrium; 130: interrupted. What went
    wrong is on standard error.
    """
    if isinstance(sys.stdout, TextIOWrapper):
        # a name that the terminal's encoding lacks should not end a run
        sys.stdout.reconfigure(errors="replace")
    try:
        code = int(app(arguments, standalone_mode=False) or COMPLETED)
        if code == INTERRUPTED and arguments is None:
            # another Ctrl-C while the process goes down has nothing left to end
            signal.signal(signal.SIGINT, signal.SIG_IGN)
        return code
    except InputError as error:
        return _fail(BAD_INPUT, str(error))
    except TyperException as error:
        return _fail(BAD_INPUT, " ".join(error.format_message().split()))
    except OSError as error:
        return _fail(BAD_INPUT, _unwritten(error))
    except MemoryError:
        return _fail(BAD_INPUT, "there is not enough memory; give a coarser --mesh")


def _fail(code: int, message: str) -> int:
    typer.echo(f"isopeel: {message}", err=True)
    return code


def _console() -> "Console":
    from rich.console import Console

    # paths are shown as they are: [b] and :b: mean nothing in them
    return Console(markup=False, emoji=False, highlight=False)


@app.callback(invoke_without_command=True)
def _root(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Tell the version.")] = False,
) -> None:
    """Simulate peeling of soft solids off adhesive surfaces by isogeometric analysis."""
    if version:
        typer.echo(f"isopeel {isopeel.__version__}")
        raise typer.Exit
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


@app.command()
def run(
    case: Annotated[
        str, typer.Argument(metavar="CASE", help="A TOML file, or a shipped case (see `isopeel cases`).")
    ],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder of the results; out/NAME when left out.")
    ] = None,
    space: Annotated[str | None, typer.Option(metavar="NAME", help="Spline space, such as N2.1.")] = None,
    mesh: Annotated[str | None, typer.Option(metavar="NXxNY", help="Elements, such as 200x10.")] = None,
    to: Annotated[
        str | None,
        typer.Option(metavar="VALUE", help="Last parameter, such as '20 nm'; a number means degrees."),
    ] = None,
    step: Annotated[
        str | None, typer.Option(metavar="VALUE", help="Step of the parameter, written likewise.")
    ] = None,
    traction: Annotated[
        str | None,
        typer.Option(metavar="reference|projected", help="Area that the adhesive traction acts on."),
    ] = None,
    contact_points: Annotated[
        int | None, typer.Option(metavar="N", help="Gauss points of the adhesive force on an element.")
    ] = None,
    control: _ControlOption = None,
    fields_every: Annotated[
        str | None,
        typer.Option(metavar="VALUE", help="Parameter between stored displacements, written likewise."),
    ] = None,
) -> int:
    """Run CASE and leave its curve, figures, summary and fields in a folder."""
    try:
        from isopeel.case import load_case
        from isopeel.run import run_case

        chosen = load_case(case).overridden(
            space=space,
            mesh=mesh,
            to=to,
            step=step,
            traction=traction,
            contact_points=contact_points,
            control=control,
            fields_every=fields_every,
        )
        folder = out or Path("out") / chosen.name
        result = run_case(chosen, folder, _console())
    except InputError as error:
        # what only the solver can tell of an option
        for option, value in (("mesh", mesh), ("contact_points", contact_points)):
            if error.field == f"discretization.{option}" and error.value == value:
                raise InputError(f"--{option.replace('_', '-')}", value, error.allowed) from error
        raise
    except KeyboardInterrupt:
        return _fail(INTERRUPTED, "interrupted")
    except OSError as error:
        return _fail(BAD_INPUT, _unwritten(error, folder))
    return _ended(result, folder)


@app.command()
def resume(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a run that was interrupted.")],
    to: Annotated[
        str | None,
        typer.Option(metavar="VALUE", help="Last parameter, if it is to go further than was asked for."),
    ] = None,
    control: _ControlOption = None,
) -> int:
    """Go on with a run that was interrupted or killed; its steps are those of an uninterrupted one."""
    try:
        from isopeel.resume import resume_case

        result = resume_case(folder, _console(), to, control)
    except KeyboardInterrupt:
        return _fail(INTERRUPTED, f"interrupted; {_goes_on(folder)}")
    except OSError as error:
        return _fail(BAD_INPUT, _unwritten(error, folder))
    return _ended(result, folder)


def _ended(result: "Result", folder: Path) -> int:
    """Tell how a run ended, and return the exit code for it."""
    from isopeel.run import failure_message

    run, stage_folder = result
    if run.ending == "interrupted":
        return _fail(INTERRUPTED, f"interrupted; {_goes_on(folder)}")
    if run.failure is not None:
        column = run.curve.parameter_column
        return _fail(NOT_CONVERGED, failure_message(run.failure, column, stage_folder, folder))
    return COMPLETED


def _unwritten(error: OSError, folder: Path | None = None) -> str:
    told = f"{error.filename or 'a file'} cannot be written: {error.strerror}"
    if folder is None or not any(folder.glob("**/run.h5")):
        return told
    return f"{told}; `isopeel resume {shlex.quote(str(folder))}` goes on with what is saved"


def _goes_on(folder: Path) -> str:
    return f"what converged before is in {folder}, and `isopeel resume {shlex.quote(str(folder))}` goes on"


@app.command()
def cases() -> None:
    """List the shipped cases."""
    from isopeel.run import cases_table

    _console().print(cases_table())


@app.command()
def paper(
    only: Annotated[
        list[str] | None,
        typer.Option(metavar="PART", help="A part of the report, such as table2; repeatable."),
    ] = None,
    mesh: Annotated[
        list[str] | None, typer.Option(metavar="m1|m2|m3", help="A mesh of the study; repeatable.")
    ] = None,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder of the report and its runs.")] = Path(
        "out/paper"
    ),
) -> int:
    """Run the published study, and report on it beside the published figures.

    Runs that are finished are kept, so that the same command goes on where it was interrupted.
    """
    goes_on = f"finished runs are in {out}, and the same command goes on"
    try:
        from isopeel.paper.report import chosen_meshes, chosen_parts, make_report
        from isopeel.processes import WorkerLostError

        console = _console()
        try:
            page = make_report(chosen_parts(only or []), chosen_meshes(mesh or []), out, console)
        except WorkerLostError as error:
            return _fail(BAD_INPUT, f"{error}; {goes_on}")
    except KeyboardInterrupt:
        return _fail(INTERRUPTED, f"interrupted; {goes_on}")
    console.print(f"the report is {page}", soft_wrap=True)
    return COMPLETED


@app.command()
def spaces(
    name: Annotated[str, typer.Argument(metavar="NAME", help="A spline space, such as N2.1 or L1+N2@2.")],
    mesh: Annotated[str, typer.Option(metavar="NXxNY", help="Elements that DOFs are told for.")] = "200x10",
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="File of the figure; out/NAME.png when left out.")
    ] = None,
) -> int:
    """Draw the functions of a spline space, and tell its degrees, continuities, supports and DOFs."""
    from isopeel.spaces import show_space

    show_space(name, mesh, out, _console())
    return COMPLETED


@app.command()
def law(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help="A law, such as exponential, or a case whose law is shown.")
    ],
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="File of the figure; out/NAME.png when left out.")
    ] = None,
) -> int:
    """Draw a law of adhesion, and tell its strength, work of adhesion and stiffness."""
    from isopeel.law import show_law

    show_law(name, out, _console())
    return COMPLETED


@app.command()
def validate(
    only: Annotated[
        list[str] | None, typer.Option(metavar="CHECK", help="A check, such as tapes; repeatable.")
    ] = None,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder of the report.")] = Path("out/validation"),
) -> int:
    """Hold runs against closed forms, and report on all deviations."""
    try:
        from isopeel.processes import WorkerLostError
        from isopeel.validation.report import chosen_checks
        from isopeel.validation.report import validate as run_checks

        console = _console()
        try:
            found = run_checks(chosen_checks(only or []), out, console)
        except WorkerLostError as error:
            return _fail(BAD_INPUT, str(error))
    except KeyboardInterrupt:
        return _fail(INTERRUPTED, "interrupted")
    console.print(f"the report is {found.page}", soft_wrap=True)
    if found.failed:
        return _fail(NOT_CONVERGED, f"numbers beyond what is allowed: {found.failed}, see {found.page}")
    return COMPLETED


@app.command()
def report(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a run, or of a stage of one.")],
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="File of the page; DIR/report.html when left out.")
    ] = None,
) -> int:
    """Write a run as one HTML page, with its curve, shapes, front and tractions, that opens anywhere."""
    from isopeel.page.write import write_page

    _console().print(f"the report is {write_page(folder, out)}", soft_wrap=True)
    return COMPLETED


@app.command()
def plot(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a run, or of one of its stages.")],
    only: Annotated[
        list[str] | None,
        typer.Option(
            metavar="PART", help="Figure: curve, plateau, shapes, front or tractions; repeatable, else all."
        ),
    ] = None,
    at: Annotated[
        list[str] | None,
        typer.Option(
            metavar="VALUE",
            help="Parameter of a state to show, such as '20 nm'; a number means degrees; repeatable.",
        ),
    ] = None,
    suffix: Annotated[str, typer.Option("--format", metavar="png|svg|pdf", help="Kind of file.")] = "png",
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder of the figures; DIR/figures when left out.")
    ] = None,
) -> int:
    """Draw the figures of a stored run: its curve and plateau, deformed shapes, front and tractions."""
    from isopeel.plot import plot_run

    plot_run(folder, only or [], at or [], suffix, out, _console())
    return COMPLETED


@app.command()
def export(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a run.")],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder of the files; DIR/paraview when left out.")
    ] = None,
    linear: Annotated[
        int | None,
        typer.Option(metavar="N", help="Cut each element into N x N straight cells, not into Bezier cells."),
    ] = None,
) -> int:
    """Write the fields of a run for ParaView, as Bezier cells that hold curved shapes exactly."""
    try:
        from isopeel.export import export_run

        export_run(folder, out, linear, _console())
    except KeyboardInterrupt:
        return _fail(INTERRUPTED, "interrupted; the same command writes all files anew")
    return COMPLETED


@app.command()
def compare(
    folders: Annotated[
        list[Path], typer.Argument(metavar="DIR...", help="Folders of two runs or more, or of stages.")
    ],
    suffix: Annotated[str, typer.Option("--format", metavar="png|svg|pdf", help="Kind of figure.")] = "png",
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder of the table and the figure.")] = Path(
        "out/compare"
    ),
) -> int:
    """Lay the curves of stored runs over each other, and tabulate what was read from them."""
    from isopeel.compare import compare_runs

    compare_runs(folders, suffix, out, _console())
    return COMPLETED


@app.command()
def animate(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a run, or of one of its stages.")],
    suffix: Annotated[str, typer.Option("--format", metavar="mp4|gif", help="Kind of file.")] = "mp4",
    fps: Annotated[
        float | None,
        typer.Option(metavar="N", help="Stored states per second; a few seconds in all when left out."),
    ] = None,
    size: Annotated[str, typer.Option(metavar="WxH", help="Width and height in pixels.")] = "1280x600",
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder of the file; DIR/figures when left out.")
    ] = None,
) -> int:
    """Animate a stored run: the deformed body, and beside it the curve with a mark that moves along it."""
    try:
        from isopeel.animate import animate_run

        animate_run(folder, suffix, fps, size, out, _console())
    except KeyboardInterrupt:
        return _fail(INTERRUPTED, "interrupted")
    return COMPLETED


@app.command()
def view(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a run, or of one of its stages.")],
    at: Annotated[
        str | None,
        typer.Option(metavar="VALUE", help="Parameter of the state to begin with; a number means degrees."),
    ] = None,
    screenshot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write a PNG picture instead of opening a window.")
    ] = None,
) -> int:
    """Show the deformed body of a stored run in a window, with a slider (needs isopeel[view])."""
    from isopeel.view import view_run

    view_run(folder, at, screenshot, _console())
    return COMPLETED
