"""A study on one worker, on two, and with its parent, a worker and the scheduler killed: times and tables."""

import csv
import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, sleep
from typing import Annotated, NamedTuple

import h5py
import numpy as np
import typer

import machine
from isopeel.study.table import OF_THE_MACHINE
from printing import plain_table, wide_console

STUDY = """
name = "killed"
case = "tape-angle"

[set]
"discretization.mesh" = "{mesh}"
"drive.to" = "{to}"
"reading" = {{ window = ["{window}", "{to}"] }}

[[factor]]
key = "drive.angle"
from = "50 deg"
to = "110 deg"
count = {angles}

[[factor]]
key = "adhesion.hamaker_constant"
from = "0.5e-19 J"
to = "1e-19 J"
count = {strengths}
"""
#: Angles of the study; each is combined with all constants of Hamaker.
ANGLES = 4
#: The shares of finished runs at which processes are killed, in the order of what is killed.
KILLS = {"the parent": 0.2, "a worker": 0.4, "the scheduler": 0.6}
_LOOK = 0.05  # seconds
_TO_START = 120.0  # seconds, on a busy machine


class Study(NamedTuple):
    """A study that was computed: its folder, and the seconds that its command took."""

    label: str
    folder: Path
    workers: int
    wall: float

    @property
    def solving(self) -> float:
        """The sum of the seconds of all runs."""
        return sum(float(row["seconds"]) for row in rows(self.folder))

    @property
    def overhead(self) -> float:
        """The share of the workers' time in which no run was computed."""
        return 1.0 - self.solving / (self.workers * self.wall)


def rows(folder: Path) -> list[dict[str, str]]:
    """Return the rows of a study's table."""
    with (folder / "tables" / "runs.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def difference(one: Path, other: Path) -> str:
    """Return the first difference between the results of two studies; empty if there is none.

    Compared are the tables, but for times and hosts, and the curves of all runs, bit for bit.
    """
    pairs = zip(rows(one), rows(other), strict=True)
    for number, (row, another) in enumerate(pairs, start=1):
        for name, value in row.items():
            if name not in OF_THE_MACHINE and value != another[name]:
                return f"run {number}: {name} is {value} and {another[name]}"
    with h5py.File(one / "tables" / "curves.h5") as file, h5py.File(other / "tables" / "curves.h5") as second:
        if list(file) != list(second):
            return "other runs have curves"
        for run, curves in file.items():
            for name, values in curves.items():
                if not np.array_equal(values[()], second[run][name][()]):
                    return f"{run}: {name}"
    return ""


def command(study: Path, folder: Path, *words: str) -> list[str]:
    """Return the command of a study."""
    return [sys.executable, "-P", "-m", "isopeel", "study", str(study), "--out", str(folder), *words]


def computed(label: str, study: Path, folder: Path, workers: int) -> Study:
    """Compute a study on a cluster of its own."""
    began = perf_counter()
    subprocess.run(command(study, folder, "--workers", str(workers)), check=True, stdout=subprocess.DEVNULL)
    return Study(label, folder, workers, perf_counter() - began)


class Cluster:
    """A scheduler and two workers, which are started by hand."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._number = folder, 0
        self.scheduler: subprocess.Popen[bytes]
        self.workers: list[subprocess.Popen[bytes]] = []
        self.address = ""

    def begin(self) -> None:
        """Start a scheduler at a new address, and two workers."""
        self._number += 1
        log = self._folder / f"scheduler-{self._number}.txt"
        words = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
        self.scheduler = self._started("dask_scheduler", words, log)
        until = perf_counter() + _TO_START
        while not (found := re.search(r"Scheduler at: +(tcp://\S+)", log.read_text())):
            if perf_counter() > until:
                raise OSError(f"the scheduler did not start: {log.read_text()}")
            sleep(_LOOK)
        self.address = found.group(1)
        self.workers = []
        for _ in range(2):
            self.begin_worker()

    def begin_worker(self) -> None:
        """Start a worker of one thread, without a process that would start it again."""
        words = [self.address, "--no-nanny", "--nthreads", "1", "--no-dashboard"]
        # it ends by itself, should this process be killed
        words += ["--local-directory", str(self._folder), "--death-timeout", "60"]
        self.workers.append(self._started("dask_worker", words, self._folder / "workers.txt"))

    def end(self) -> None:
        """Kill all processes."""
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()

    def _started(self, name: str, words: list[str], log: Path) -> "subprocess.Popen[bytes]":
        with log.open("ab") as file:
            return subprocess.Popen(
                [sys.executable, "-P", "-m", f"distributed.cli.{name}", *words],
                stderr=file,
                stdout=file,
                env=os.environ | {"OMP_NUM_THREADS": "1"},
            )


@contextmanager
def cluster(folder: Path) -> Iterator[Cluster]:
    """Start a scheduler and two workers, and end them with the context."""
    started = Cluster(folder)
    started.begin()
    try:
        yield started
    finally:
        started.end()


def finished(folder: Path) -> int:
    """Return the number of runs that are stored."""
    return len(list((folder / "runs").glob("[!.]*.h5")))


def killed(study: Path, folder: Path, runs: int, tell: Callable[[str], None]) -> Study:
    """Compute a study whose parent, a worker and the scheduler are killed; the same command continues it."""
    began = perf_counter()
    with TemporaryDirectory() as scratch, cluster(Path(scratch)) as one:
        parent = _begun(study, folder, one)
        for victim, share in KILLS.items():
            while finished(folder) < share * runs and parent.poll() is None:
                sleep(_LOOK)
            if parent.poll() is not None:
                raise ValueError(f"the study ended before {victim} was killed; compute more runs")
            stored = finished(folder)
            if victim == "a worker":
                one.workers[0].send_signal(signal.SIGKILL)
                one.workers.pop(0).wait()
                one.begin_worker()
                tell(f"{victim} was killed after {stored} of {runs} runs; the study went on")
                continue
            if victim == "the parent":
                parent.kill()
                _, said = parent.communicate()
            else:
                one.scheduler.kill()
                lost = perf_counter()
                _, said = parent.communicate()
                tell(f"the parent ended {perf_counter() - lost:.1f} s after that: {said.strip()}")
                one.end()
                one.begin()
            parent = _begun(study, folder, one)
            tell(f"{victim} was killed after {stored} of {runs} runs; the command was repeated")
        printed, said = parent.communicate()
        if parent.returncode:
            raise ValueError(f"the study ended with {parent.returncode}: {said}")
        tell(f"then it printed: {printed.splitlines()[0]}")
    return Study("three kills", folder, 2, perf_counter() - began)


def _begun(study: Path, folder: Path, one: Cluster) -> "subprocess.Popen[str]":
    words = command(study, folder, "--scheduler", one.address)
    return subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def main(
    runs: Annotated[int, typer.Option(min=12, help="A multiple of 4.")] = 200,
    mesh: Annotated[str, typer.Option(help="Elements.")] = "80x2",
    to: Annotated[float, typer.Option(min=1.0, help="Last displacement in nm.")] = 40.0,
    out: Annotated[
        Path | None, typer.Option(help="Folder of the studies; a temporary one by default.")
    ] = None,
) -> None:
    """Compute a study three times, and print times, what happened at each kill, and whether tables agree."""
    if runs % ANGLES:
        raise ValueError(f"{runs} runs are no multiple of {ANGLES}")
    console = wide_console()
    with TemporaryDirectory() as scratch:
        folder = out or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        study = folder / "study.toml"
        study.write_text(
            STUDY.format(
                mesh=mesh, to=f"{to} nm", window=f"{0.875 * to} nm", angles=ANGLES, strengths=runs // ANGLES
            )
        )

        def tell(line: str) -> None:
            console.print(line, soft_wrap=True)

        tell(machine.description())
        # kernels are compiled before the clock starts
        first = folder / "first.toml"
        first.write_text(STUDY.format(mesh=mesh, to="1 nm", window="0.9 nm", angles=2, strengths=2))
        computed("first", first, folder / "first", 1)
        studies = [computed("1 worker", study, folder / "one", 1)]
        tell(f"{runs} runs on one worker took {studies[0].wall:.1f} s")
        studies.append(computed("2 workers", study, folder / "two", 2))
        studies.append(killed(study, folder / "killed", runs, tell))
        table = plain_table(
            f"{runs} runs of tape-angle on {mesh}, to {to:g} nm",
            *("study", "wall [s]", "runs [s]", "faster by", "overhead [%]", "difference to the first"),
            labels=1,
            caption="overhead: the share of the time of the workers in which no run was computed",
        )
        for one in studies:
            table.add_row(
                one.label,
                f"{one.wall:.1f}",
                f"{one.solving:.1f}",
                f"{studies[0].wall / one.wall:.2f}",
                f"{100 * one.overhead:.1f}",
                difference(studies[0].folder, one.folder) or "none",
            )
        console.print(table)
        endings = [row["ending"] for row in rows(studies[0].folder)]
        tell(f"{endings.count('completed')} of {runs} runs were completed")
        tell(machine.description())


if __name__ == "__main__":
    try:
        typer.run(main)
    except (ValueError, OSError, subprocess.SubprocessError) as error:
        sys.exit(f"killed_study: {error}")
