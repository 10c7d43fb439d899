"""Runs in processes of their own that are killed: forked from this one, which has compiled all already."""

import csv
import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np

import isopeel
from isopeel.cli import main
from isopeel.results import run_writer
from isopeel.results.journal import journal_path
from isopeel.results.run_writer import RunWriter
from isopeel.running.folder import FILES, stage_files

_DEADLINE = 120.0  # seconds; a run here takes a few


class Outcome(NamedTuple):
    """How a process ended: exit code, or minus the signal; steps that it took, by file; its words."""

    code: int
    taken: dict[str, int]
    said: str


def in_a_fork(
    arguments: list[str],
    scratch: Path,
    until: Callable[[float], bool] = lambda _: False,
    stop: int = signal.SIGKILL,
    save_seconds: float = 1.0,
    figures: bool = True,
) -> Outcome:
    """Run the command line in a fork, and stop it once `until` is true of the seconds since its start."""
    reports, said = scratch / "reports", scratch / "said"
    child = os.fork()
    if child == 0:
        code = 99
        try:
            words = os.open(said, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(words, 1)
            os.dup2(words, 2)
            # background processes of a shell may have it ignored
            signal.signal(signal.SIGINT, signal.default_int_handler)
            _report_to(os.open(reports, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_APPEND))
            run_writer._SAVE_SECONDS = save_seconds
            if not figures:
                import isopeel.running.stage_results

                vars(isopeel.running.stage_results)["save"] = lambda _, path: path.write_bytes(
                    b"Creator\0isopeel"
                )
            code = main(arguments)
            sys.stdout.flush()
        finally:
            os._exit(code)
    began = time.perf_counter()
    while os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT) is None:
        if until(time.perf_counter() - began):
            os.kill(child, stop)
            break
        time.sleep(0.0005)  # which leaves the processor to the run
        assert time.perf_counter() < began + _DEADLINE, said.read_text(errors="replace")
    _, status = os.waitpid(child, 0)
    taken: dict[str, int] = {}
    for line in reports.read_text().splitlines() if reports.exists() else ():
        taken[line] = taken.get(line, 0) + 1
    return Outcome(os.waitstatus_to_exitcode(status), taken, said.read_text(errors="replace"))


def _report_to(reports: int) -> None:
    """Write a line for each step that was taken, with its file."""
    append = RunWriter.append

    def reporting(self: RunWriter, step: isopeel.Step) -> None:
        append(self, step)
        os.write(reports, f"{self._path}\n".encode())

    RunWriter.append = reporting  # type: ignore[method-assign]


def run_files(folder: Path) -> list[Path]:
    """The files of the runs in a folder."""
    return [path for path in (folder / FILES[0], *sorted(stage_files(folder))) if path.exists()]


def stored_bits(path: Path) -> dict[str, bytes]:
    """All numbers of the file of a run but the times, bit for bit; and the curve as a table."""
    bits: dict[str, bytes] = {}

    def visit(name: str, item: h5py.Group | h5py.Dataset) -> None:
        if name in ("curve/seconds", "case"):
            return
        for key, value in item.attrs.items():
            bits[f"{name}@{key}"] = (
                np.asarray(value).tobytes() if not isinstance(value, str) else value.encode()
            )
        if isinstance(item, h5py.Dataset):
            bits[name] = item[()].tobytes()

    with h5py.File(path) as file:
        file.visititems(visit)
        bits["ending"] = str(file.attrs["ending"]).encode()
    table = list(csv.reader(path.with_name("curve.csv").read_text().splitlines()))
    times = next(k for k, name in enumerate(table[0]) if name.startswith("seconds"))
    bits["curve.csv"] = repr([row[:times] + row[times + 1 :] for row in table]).encode()
    return bits


def is_prefix(run: isopeel.StoredRun, whole: isopeel.StoredRun) -> bool:
    """Whether a run's curve is the beginning of another, bit for bit."""
    count = len(run.curve)
    return all(
        getattr(run.curve, name).tobytes() == getattr(whole.curve, name)[:count].tobytes()
        for name in ("parameter", "reaction", "iterations", "stored_energy", "released_energy")
    )


def leftovers(folder: Path) -> set[str]:
    """Names of the files in a folder that a complete run does not leave."""
    return {path.name for path in folder.rglob("*") if path.is_file() and path.name not in FILES}


def is_being_written(folder: Path) -> Callable[[float], bool]:
    """True as soon as a file of a run is being replaced."""

    def check(_: float) -> bool:
        return any((place / ".run.part.h5").exists() for place in (folder, *folder.glob("[0-9]-*")))

    return check


def has_journal(folder: Path, size: int) -> Callable[[float], bool]:
    """True as soon as the journal of a run has so many bytes."""

    def check(_: float) -> bool:
        for place in (folder, *folder.glob("[0-9]-*")):
            path = journal_path(place / FILES[0])
            try:
                if path.stat().st_size >= size:
                    return True
            except FileNotFoundError:
                continue
        return False

    return check
