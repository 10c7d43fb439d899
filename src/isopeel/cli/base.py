"""The base of all commands: the application, exit codes, and messages."""

import shlex
from collections.abc import Callable
from errno import EMFILE, ENFILE
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ParamSpec

import typer

import isopeel
from isopeel.common.errors import visible
from isopeel.common.interrupts import INTERRUPTED, deferred, may_report

if TYPE_CHECKING:
    from rich.console import Console

# Commands import their modules when they are called: help must not wait for a compiler.

COMPLETED, BAD_INPUT, NOT_CONVERGED = 0, 2, 3

P = ParamSpec("P")

app = typer.Typer(pretty_exceptions_enable=False, context_settings={"help_option_names": ["-h", "--help"]})


@app.callback(invoke_without_command=True)
def _root(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
) -> None:
    """Simulate peeling of soft solids off adhesive surfaces by isogeometric analysis."""
    if version:
        typer.echo(f"isopeel {isopeel.__version__}")
        raise typer.Exit
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


def command(function: Callable[P, int]) -> Callable[P, int]:
    """Make a command of a function that returns an exit code; Ctrl-C ends it with one line."""

    @wraps(function)
    def run(*arguments: P.args, **options: P.kwargs) -> int:
        code: int | None = None
        try:
            with deferred():
                code = function(*arguments, **options)
        except KeyboardInterrupt:
            # after the end of the command Ctrl-C interrupts nothing
            return fail(INTERRUPTED, "interrupted") if code is None else code
        return code

    return app.command()(run)


def console(*, quiet: bool = False) -> "Console":
    """Return standard output; if `quiet`, nothing is written there."""
    from isopeel.cli.terminal import PlainConsole

    # paths are shown as they are: [b] and :b: in a path are not markup
    return PlainConsole(markup=False, emoji=False, highlight=False, quiet=quiet)


def fail(code: int, message: str) -> int:
    """Write an error message to standard error, and return the exit code."""
    if code != INTERRUPTED or may_report():
        typer.echo(visible(f"isopeel: {message}"), err=True)
    return code


def unwritten(error: OSError, folder: Path | None = None) -> str:
    """Return the message on a file that cannot be written, and the command that continues the run."""
    if error.errno in (EMFILE, ENFILE):
        text = (
            f"{error.filename or 'a file'} cannot be opened: {error.strerror}; `ulimit -n NUMBER` raises the"
            " limit"
        )
    else:
        text = f"{error.filename or 'a file'} cannot be written: {error.strerror or error}"
    if folder is None or not any(folder.glob("**/run.h5")):
        return text
    return f"{text}; `isopeel resume {shlex.quote(str(folder))}` continues from the saved steps"


def interrupted_message(folder: Path) -> str:
    """Return the message on an interrupted run in a folder, with the command that continues it."""
    return (
        f"the converged steps are in {folder}; `isopeel resume {shlex.quote(str(folder))}` continues the run"
    )
