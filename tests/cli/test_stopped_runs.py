"""Runs that are stopped by Ctrl-C or an error, and what becomes of the run that was there before."""

import signal
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_output import SMALL, summary, table, the_error

import isopeel
from isopeel.cli import main
from isopeel.results.run_writer import RunWriter
from isopeel.solve.convergence import ConvergenceError

pytestmark = pytest.mark.usefixtures("in_own_folder", "without_figures")


def test_ctrl_c_ends_with_130_and_stores_the_converged_steps(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    append = RunWriter.append

    def interrupted(self: RunWriter, step: isopeel.Step) -> None:
        append(self, step)
        if step.number == 2:
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(RunWriter, "append", interrupted)
    assert main(["run", "strip", *SMALL]) == 130
    assert "interrupted" in (error := the_error(capsys))
    assert "`isopeel resume out/strip` continues the run" in error
    out = Path("out/strip")
    # figures take longer than one who pressed Ctrl-C should wait
    assert {path.name for path in out.iterdir()} == {"curve.csv", "run.h5", "summary.json"}
    _, rows = table(out / "curve.csv")
    assert rows[:, 0].tolist() == isopeel.read_run(out / "run.h5").curve.parameter.tolist() == [0, 1, 2]
    assert (summary(out)["completed"], summary(out)["failure"]) == (False, None)


def test_ctrl_c_before_the_first_step_ends_with_130(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(_: RunWriter, step: isopeel.Step) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(RunWriter, "append", interrupted)
    assert main(["run", "strip", *SMALL]) == 130
    the_error(capsys)
    assert list(Path("out/strip").iterdir()) == []


def test_an_earlier_run_stays_until_the_new_one_starts(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "strip", *SMALL]) == 0
    before = {path: path.read_bytes() for path in Path("out/strip").iterdir()}
    assert main(["run", "strip", "--mesh", "0x1"]) == 2
    assert {path: path.read_bytes() for path in Path("out/strip").iterdir()} == before
    assert main(["run", "strip", *SMALL, "--to", "4"]) == 0
    assert summary(Path("out/strip"))["theta_deg"] == 4.0


def fail_at(number: int, monkeypatch: pytest.MonkeyPatch, error: BaseException) -> None:
    """Let an error come where the step of this number should."""

    def failing(*arguments: Any, **options: Any) -> Iterator[isopeel.Step]:
        yield from islice(isopeel.trace(*arguments, **options), number)
        raise error

    monkeypatch.setattr("isopeel.running.stage_trace.trace", failing)


@pytest.mark.parametrize("error", [KeyboardInterrupt(), ZeroDivisionError()])
def test_an_earlier_run_stays_until_the_first_step(
    error: BaseException, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert main(["run", "strip", *SMALL]) == 0
    before = {path: path.read_bytes() for path in Path("out/strip").iterdir()}
    fail_at(0, monkeypatch, error)
    if isinstance(error, KeyboardInterrupt):
        assert main(["run", "strip", *SMALL, "--to", "4"]) == 130
    else:
        with pytest.raises(ZeroDivisionError):
            main(["run", "strip", *SMALL, "--to", "4"])
    assert {path: path.read_bytes() for path in Path("out/strip").iterdir()} == before


def test_no_equilibrium_at_first_replaces_an_earlier_run(monkeypatch: pytest.MonkeyPatch) -> None:
    assert main(["run", "strip", *SMALL]) == 0
    fail_at(0, monkeypatch, ConvergenceError("because", (1.0,), np.radians(0.3)))
    assert main(["run", "strip", *SMALL]) == 3
    left = {"run.h5", "curve.csv", "summary.json", "run.earlier.h5"}  # the last one is the finished run
    assert {path.name for path in Path("out/strip").iterdir()} == left
    assert summary(Path("out/strip"))["failure"]["theta_deg"] == 0.3  # as requested, to the last bit
    assert len(table(Path("out/strip/curve.csv"))[1]) == 0


def test_after_an_unexpected_error_the_converged_steps_are_stored(monkeypatch: pytest.MonkeyPatch) -> None:
    assert main(["run", "strip", *SMALL]) == 0
    fail_at(2, monkeypatch, ZeroDivisionError())
    with pytest.raises(ZeroDivisionError):
        main(["run", "strip", *SMALL])
    left = {"run.h5", "curve.csv", "run.earlier.h5"}  # the last one is the finished run
    assert {path.name for path in Path("out/strip").iterdir()} == left
    _, rows = table(Path("out/strip/curve.csv"))
    assert (
        rows[:, 0].tolist() == isopeel.read_run(Path("out/strip/run.h5")).curve.parameter.tolist() == [0, 1]
    )


def test_a_folder_in_place_of_a_file_is_refused_beforehand(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "strip", *SMALL]) == 0
    Path("out/strip/summary.json").unlink()
    Path("out/strip/summary.json").mkdir()
    before = Path("out/strip/run.h5").read_bytes()
    capsys.readouterr()
    assert main(["run", "strip", *SMALL]) == 2
    assert "summary.json" in the_error(capsys)
    assert Path("out/strip/run.h5").read_bytes() == before
    assert Path("out/strip/curve.csv").exists()
