"""How long a command takes from start to end, and how long the first one after an installation."""

import os
import subprocess
import sys
import sysconfig
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Annotated, NamedTuple

import typer
from rich.table import Table

import machine
from printing import plain_table, wide_console


class Command(NamedTuple):
    """What is started, and how often."""

    label: str
    arguments: Sequence[str]
    repeats: int
    first: bool = False  # as after an installation: with empty caches


def commands(repeats: int, long: int, case: Sequence[str]) -> list[Command]:
    """All commands, the whole run of a case `long` times each."""
    script = Path(sysconfig.get_path("scripts")) / "isopeel"
    run = [str(script), "run", *case]
    short = [*run, "--to", "1"]
    shown = " ".join(("isopeel run", *case))
    return [
        Command('python -c "import isopeel"', [sys.executable, "-c", "import isopeel"], repeats),
        Command("isopeel --help", [str(script), "--help"], repeats),
        Command(f"{shown} --to 1", short, repeats),
        Command(f"{shown} --to 1, the first", short, long, first=True),
        Command(shown, run, long),
        Command(f"{shown}, the first", run, long, first=True),
    ]


def seconds(command: Command) -> list[float]:
    """Time a command, each time in an empty folder."""
    times = []
    for number in range(-1, command.repeats):
        # one run before fills the caches that the others find
        if number < 0 and command.first:
            continue
        with TemporaryDirectory() as folder:
            environment = os.environ | _empty_caches(folder) if command.first else None
            began = perf_counter()
            subprocess.run(command.arguments, cwd=folder, env=environment, check=True, capture_output=True)
            if number >= 0:
                times.append(perf_counter() - began)
    return times


def _empty_caches(folder: str) -> dict[str, str]:
    """Where Numba keeps its kernels, and Matplotlib what it found out about fonts."""
    return {"NUMBA_CACHE_DIR": f"{folder}/kernels", "MPLCONFIGDIR": f"{folder}/fonts"}


def start_up_table(found: Sequence[tuple[Command, list[float]]]) -> Table:
    """Tabulate the seconds of all commands."""
    table = plain_table(
        "seconds from start to end",
        *("command", "repeats", "least", "median"),
        caption="the first: with empty caches, as after an installation",
        labels=1,
    )
    for command, times in found:
        table.add_row(command.label, str(len(times)), f"{min(times):.2f}", f"{median(times):.2f}")
    return table


def main(
    repeats: Annotated[int, typer.Option(min=1, help="Of short commands.")] = 5,
    long: Annotated[int, typer.Option(min=1, help="Repeats of first and whole runs.")] = 2,
    case: Annotated[str, typer.Option(help="What to run, with options of `isopeel run`.")] = "strip",
) -> None:
    """Time the start of isopeel, in a process of its own each time."""
    found = [(command, seconds(command)) for command in commands(repeats, long, case.split())]
    console = wide_console()
    console.print(start_up_table(found))
    console.print(machine.description(), soft_wrap=True)


if __name__ == "__main__":
    try:
        typer.run(main)
    except subprocess.CalledProcessError as error:
        sys.exit(f"start_up: {error.stderr.decode()}")
