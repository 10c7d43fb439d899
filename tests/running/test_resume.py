"""`isopeel resume`: what goes on, what is complete, and what is refused."""

import csv
import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from time import sleep
from typing import Any

import numpy as np
import pytest

import isopeel
from isopeel.cli import main
from isopeel.results.run_file import read_run
from isopeel.results.run_writer import RunWriter
from isopeel.running.folder import FILES
from isopeel.running.lock import alone_in

SMALL = ("--mesh", "20x2", "--space", "L1", "--to", "6", "--step", "1")
OUT = Path("out/strip")

pytestmark = pytest.mark.usefixtures("in_own_folder", "without_figures")


def interrupt_at(number: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Press Ctrl-C, twice, when so many steps have been taken."""

    def interrupted(*arguments: Any, **options: Any) -> Iterator[isopeel.Step]:
        yield from islice(isopeel.trace(*arguments, **options), number)
        for _ in range(2):
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr("isopeel.running.stage_trace.trace", interrupted)


def rows(folder: Path = OUT) -> list[str]:
    """The table of a run, without its times."""
    table = list(csv.reader((folder / "curve.csv").read_text().splitlines()))
    times = next(k for k, name in enumerate(table[0]) if name.startswith("seconds"))
    return [",".join(row[:times] + row[times + 1 :]) for row in table]


@pytest.mark.usefixtures("with_figures")
def test_an_interrupted_run_continues(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", "strip", *SMALL, "--out", "whole"]) == 0
    capsys.readouterr()
    with monkeypatch.context() as patch:
        interrupt_at(3, patch)
        assert main(["run", "strip", *SMALL]) == 130
    message = (
        "interrupted; the converged steps are in out/strip; `isopeel resume out/strip` continues the run"
    )
    assert capsys.readouterr().err == f"isopeel: {message}\n"
    assert rows() == rows(Path("whole"))[:4]
    assert {path.name for path in OUT.iterdir()} == {"run.h5", "curve.csv", "summary.json"}
    assert main(["resume", "out/strip"]) == 0
    assert rows() == rows(Path("whole"))
    assert {path.name for path in OUT.iterdir()} == set(FILES)
    summaries = [json.loads((folder / "summary.json").read_text()) for folder in (OUT, Path("whole"))]
    for summary in summaries:
        for key in ("run", "wall_time_s", "started", "command_line"):
            summary.pop(key, None)
    assert summaries[0] == summaries[1]
    for figure in ("curve.png", "shapes.png"):
        assert (OUT / figure).read_bytes() == (Path("whole") / figure).read_bytes()


def test_a_complete_run_is_reported_as_complete(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "strip", *SMALL]) == 0
    before = {path: path.read_bytes() for path in OUT.iterdir()}
    (OUT / "shapes.png").unlink()
    capsys.readouterr()
    assert main(["resume", "out/strip"]) == 0
    assert capsys.readouterr().out == "strip is complete: 7 steps, to 6 deg\n"
    summary = OUT / "summary.json"  # which holds a time
    assert {path: path.read_bytes() for path in OUT.iterdir() if path != summary} == {
        path: content for path, content in before.items() if path != summary
    }


def test_a_run_is_extended_to_a_later_end(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "strip", *SMALL]) == 0
    assert main(["run", "strip", *SMALL, "--to", "9", "--out", "whole"]) == 0
    assert main(["resume", "out/strip", "--to", "9"]) == 0
    assert rows() == rows(Path("whole"))
    assert isopeel.load_case("strip").drive[0].to != "9.0 deg"
    assert isopeel.Case.parse(isopeel.read_run(OUT / "run.h5").case_text).drive[0].to == "9.0 deg"
    capsys.readouterr()
    assert main(["resume", "out/strip", "--to", "4"]) == 2
    message = "--to: '4' cannot be used; it does not continue the stored steps, 10 to 9 deg"
    assert message in capsys.readouterr().err


def test_a_run_without_an_equilibrium_stays_as_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    coarse = ("--mesh", "10x1", "--space", "L1", "--to", "80", "--step", "20", "--control", "newton")
    assert main(["run", "strip", *coarse]) == 3
    message = capsys.readouterr().err
    before = {path: path.read_bytes() for path in OUT.iterdir()}
    assert main(["resume", "out/strip"]) == 3
    assert capsys.readouterr().err == message
    assert {path: path.read_bytes() for path in OUT.iterdir()} == before


def test_another_path_control_continues_where_one_found_no_equilibrium(
    capsys: pytest.CaptureFixture[str],
) -> None:
    coarse = ("--mesh", "10x1", "--space", "L1", "--to", "80", "--step", "20")
    assert main(["run", "strip", *coarse, "--control", "newton"]) == 3
    assert "`isopeel resume out/strip --control CONTROL` continues it" in capsys.readouterr().err
    failed = read_run(OUT / "run.h5")
    assert main(["resume", "out/strip", "--control", "auto"]) == 0
    found = read_run(OUT / "run.h5")
    assert (found.ending, found.failure) == ("completed", None)
    assert 'path_control = "auto"' in found.case_text
    assert len(found.curve) > len(failed.curve) > 0
    np.testing.assert_array_equal(found.curve.reaction[: len(failed.curve)], failed.curve.reaction)
    assert main(["run", "strip", *coarse, "--control", "auto", "--out", "at once"]) == 0
    at_once = read_run(Path("at once/run.h5"))
    np.testing.assert_array_equal(found.curve.reaction, at_once.curve.reaction)


def test_what_is_no_run_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    Path("empty").mkdir()
    Path("text").mkdir()
    Path("text/run.h5").write_text("no HDF5")
    for folder, message in (
        ("none", "it is not a folder"),
        ("empty", "there is no run.h5 in it"),
        ("text", "the file of a run is needed"),
    ):
        assert main(["resume", folder]) == 2
        error = capsys.readouterr().err
        assert message in error
        assert error.count("\n") == 1
    assert list(Path("empty").iterdir()) == []


def test_two_processes_in_one_folder_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "strip", *SMALL]) == 0
    capsys.readouterr()
    with alone_in(OUT, "--out"):
        for command in (["run", "strip", *SMALL], ["resume", "out/strip"]):
            assert main(command) == 2
            error = capsys.readouterr().err
            assert "'out/strip' cannot be used; another process runs in it" in error
            assert error.count("\n") == 1
    assert main(["resume", "out/strip"]) == 0


def test_a_folder_that_vanishes_is_made_again(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", "strip", *SMALL, "--out", "whole"]) == 0
    append = RunWriter.append
    monkeypatch.setattr("isopeel.results.run_writer._SAVE_SECONDS", 0.0)
    monkeypatch.setattr("isopeel.results.run_writer._SAVE_SHARE", 1e9)

    def vanishing(self: RunWriter, step: isopeel.Step) -> None:
        if step.number == 3:
            shutil.rmtree(OUT)
        append(self, step)

    capsys.readouterr()
    with monkeypatch.context() as patch:
        patch.setattr(RunWriter, "append", vanishing)
        assert main(["run", "strip", *SMALL]) == 2
    error = capsys.readouterr().err
    assert "out/strip/run.h5 cannot be written: its folder vanished; it was made again" in error
    assert error.count("\n") == 1
    assert rows() == rows(Path("whole"))[:5]
    assert main(["resume", "out/strip"]) == 0
    assert rows() == rows(Path("whole"))


def test_a_full_disk_keeps_what_was_saved(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", "strip", *SMALL, "--out", "whole"]) == 0
    append = RunWriter.append

    def fill_up(*_: object) -> int:
        raise OSError(28, "No space left on device")

    def filling(self: RunWriter, step: isopeel.Step) -> None:
        if step.number == 3:
            patch.setattr(Path, "write_bytes", fill_up)
            patch.setattr(os, "writev", fill_up)
        append(self, step)

    capsys.readouterr()
    with monkeypatch.context() as patch:
        patch.setattr(RunWriter, "append", filling)
        assert main(["run", "strip", *SMALL]) == 2
    error = capsys.readouterr().err
    assert "No space left on device; `isopeel resume out/strip` continues from the saved steps" in error
    assert error.count("\n") == 1
    assert len(isopeel.read_run(OUT / "run.h5").curve) == 3
    assert main(["resume", "out/strip"]) == 0
    assert rows() == rows(Path("whole"))


COMMAND = [
    sys.executable,
    "-c",
    # background processes of a shell may have it ignored
    "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler);"
    "from isopeel.cli import main; sys.exit(main())",
    *("run", "strip", "--mesh", "160x8"),
]


@pytest.mark.posix
@pytest.mark.parametrize("again", [None, 0.1])
def test_ctrl_c_ends_with_all_written(again: float | None) -> None:
    """The second Ctrl-C comes while files are written; other tests press it at any time, in forks."""
    process = subprocess.Popen(COMMAND, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    while not (OUT / "run.journal").exists():
        assert process.poll() is None
        sleep(0.01)
    sleep(0.2)
    process.send_signal(signal.SIGINT)
    if again is not None:
        sleep(again)
        process.send_signal(signal.SIGINT)
    _, error = process.communicate(timeout=30)
    assert process.returncode == 130, error
    assert error.startswith(b"isopeel: interrupted; the converged steps are in out/strip; `isopeel resume ")
    assert error.count(b"\n") == 1
    assert {path.name for path in OUT.iterdir()} == {"run.h5", "curve.csv", "summary.json"}
    assert isopeel.read_run(OUT / "run.h5").ending == "interrupted"
