"""The time of a command from start to end, also for the first command after an installation."""

import os
import re
import resource
import subprocess
import sys
import sysconfig
from collections import Counter
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
    """A command and the number of its repeats."""

    label: str
    arguments: Sequence[str]
    repeats: int
    first: bool = False  # as after an installation: with empty caches


class Times(NamedTuple):
    """Seconds of one command."""

    wall: float
    processor: float  # of the command and of the processes that it starts


#: A line of `python -X importtime`: microseconds in a module itself, and its name.
_IMPORTED = re.compile(r"import time:\s+(\d+) \|\s+\d+ \|\s+(\w+)")
#: Packages that take less of the imports are summed up.
_SMALL = 0.03


def commands(repeats: int, long: int, case: Sequence[str]) -> list[Command]:
    """Return all commands; those of a whole run are repeated `long` times."""
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


def timed(command: Command) -> list[Times]:
    """Return the times of a command, each time in an empty folder."""
    times = []
    for number in range(-1, command.repeats):
        # one run before fills the caches
        if number < 0 and command.first:
            continue
        with TemporaryDirectory() as folder:
            environment = _environment() | (_empty_caches(folder) if command.first else {})
            began, before = perf_counter(), _processor_seconds()
            subprocess.run(command.arguments, cwd=folder, env=environment, check=True, capture_output=True)
            if number >= 0:
                times.append(Times(perf_counter() - began, _processor_seconds() - before))
    return times


def _environment() -> dict[str, str]:
    """Return the environment of this process, with Python's cache of compiled modules, as by default."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}


def _processor_seconds() -> float:
    """Return the user and system time of all child processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _empty_caches(folder: str) -> dict[str, str]:
    """Return variables for the folders of Numba's compiled kernels and of Matplotlib's font list."""
    return {"NUMBA_CACHE_DIR": f"{folder}/kernels", "MPLCONFIGDIR": f"{folder}/fonts"}


def start_up_table(found: Sequence[tuple[Command, list[Times]]]) -> Table:
    """Return the table of the seconds of all commands."""
    table = plain_table(
        "seconds from start to end, and of processor time",
        *("command", "repeats", "least", "median", "processor"),
        caption="the first: with empty caches, as after an installation; processor: the least",
        labels=1,
    )
    for command, times in found:
        wall = [time.wall for time in times]
        least = min(time.processor for time in times)
        table.add_row(
            command.label, str(len(times)), f"{min(wall):.2f}", f"{median(wall):.2f}", f"{least:.2f}"
        )
    return table


def imports(case: Sequence[str], repeats: int) -> Counter[str]:
    """Return the seconds to import the modules of each package in a short run, the least of several runs."""
    least: dict[str, list[float]] = {}
    for _ in range(repeats):
        with TemporaryDirectory() as folder:
            command = [sys.executable, "-X", "importtime", "-m", "isopeel", "run", *case, "--to", "1"]
            ran = subprocess.run(
                command, cwd=folder, env=_environment(), check=True, capture_output=True, text=True
            )
        totals: Counter[str] = Counter()
        for microseconds, package in _IMPORTED.findall(ran.stderr):
            totals[package] += int(microseconds)
        for package, total in totals.items():
            least.setdefault(package, []).append(total / 1e6)
    return Counter({package: min(times) for package, times in least.items()})


def imports_table(found: Counter[str]) -> Table:
    """Return the table of the seconds and shares of packages, the slowest first."""
    table = plain_table("imports of the short run", "package", "seconds", "share", labels=1)
    whole = found.total()
    large = [(package, took) for package, took in found.most_common() if took >= _SMALL * whole]
    rest = whole - sum(took for _, took in large)
    for package, took in (*large, ("others", rest), ("all", whole)):
        table.add_row(package, f"{took:.2f}", f"{100 * took / whole:.0f} %")
    return table


def main(
    repeats: Annotated[int, typer.Option(min=1, help="Of short commands.")] = 5,
    long: Annotated[int, typer.Option(min=1, help="Repeats of first and whole runs.")] = 2,
    case: Annotated[str, typer.Option(help="What to run, with options of `isopeel run`.")] = "strip",
) -> None:
    """Time the start of isopeel, each time in a new process."""
    found = [(command, timed(command)) for command in commands(repeats, long, case.split())]
    console = wide_console()
    console.print(start_up_table(found))
    console.print(imports_table(imports(case.split(), repeats)))
    console.print(machine.description(), soft_wrap=True)


if __name__ == "__main__":
    try:
        typer.run(main)
    except subprocess.CalledProcessError as error:
        sys.exit(f"start_up: {error.stderr.decode()}")
