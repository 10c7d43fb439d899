"""Ctrl-C at any time: exit code 130 with one line, or 0; no traceback; all that converged is in the files."""

import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import isopeel
import isopeel.running.stage_results
from isopeel.cli import main
from isopeel.common.interrupts import check, deferred, ending_this_process

pytestmark = pytest.mark.posix

SMALL = ("run", "strip", "--mesh", "20x1", "--space", "L2", "--to", "20", "--step", "0.25", "--out")
_DEADLINE = 60.0  # seconds; a run here takes a part of one


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def interrupted_fork(arguments: tuple[str, ...], figures: bool, *seconds: float) -> tuple[int, str]:
    """Exit code, and standard error, of a process that gets Ctrl-C after each of some times.

    Where its figures are of no matter, they are left empty, as they take most of the time.
    """
    read_end, write_end = os.pipe()
    child = os.fork()
    if child == 0:
        code = 99
        try:
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
            os.dup2(os.open("said", os.O_WRONLY | os.O_CREAT | os.O_TRUNC), 2)
            sys.stdout, sys.stderr = sys.__stdout__, sys.__stderr__  # not those of pytest
            signal.signal(signal.SIGINT, signal.default_int_handler)
            sys.argv = ["isopeel", *arguments]
            if not figures:
                vars(isopeel.running.stage_results)["save"] = lambda _, path: path.write_bytes(b"")
            with ending_this_process():
                os.write(write_end, b"!")
                code = main()
        except BaseException as error:
            os.write(2, f"{error!r}\n".encode())
        finally:
            os._exit(code)
    os.close(write_end)
    assert os.read(read_end, 1) == b"!"
    os.close(read_end)
    began = time.perf_counter()
    ended = 0
    for moment in (*seconds, _DEADLINE):
        while not ended and time.perf_counter() < began + moment:
            ended, status = os.waitpid(child, os.WNOHANG)
            time.sleep(0.001)
        if not ended:
            os.kill(child, signal.SIGINT)
    assert ended
    return os.waitstatus_to_exitcode(status), Path("said").read_text()


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[isopeel.StoredRun, float]:
    """The run without an interrupt, and its seconds."""
    folder = tmp_path_factory.mktemp("whole") / "out"
    assert main([*SMALL, str(folder)]) == 0
    run = isopeel.read_run(folder / "run.h5")
    return run, float(run.curve.seconds.sum())


@pytest.mark.parametrize("times", [1, 2, 3])
def test_a_run_may_be_interrupted_at_any_time(times: int, whole: tuple[isopeel.StoredRun, float]) -> None:
    run, seconds = whole
    chance = random.Random(times)
    codes = []
    for number in range(20):
        # before the first step, on the way, and while files are written
        moments = sorted(chance.uniform(0.0, seconds + 0.2) for _ in range(times))
        code, said = interrupted_fork((*SMALL, f"out{number}"), number < 3, *moments)
        codes.append(code)
        assert code in (0, 130), said
        assert said.count("\n") == (code == 130), said
        assert said.startswith("isopeel: interrupted" if code else ""), said
        file = Path(f"out{number}/run.h5")
        if file.exists():
            found = isopeel.read_run(file)
            np.testing.assert_array_equal(found.curve.reaction, run.curve.reaction[: len(found.curve)])
            if code:
                assert "`isopeel resume" in said or "continues the run" not in said
    assert codes.count(130) > 5


@pytest.mark.parametrize("seconds", [0.0, 0.1, 0.4, 1.0])
def test_a_process_that_still_imports_ends_with_one_line(seconds: float) -> None:
    script = (
        "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "from isopeel.common.interrupts import ending_this_process\n"
        "with ending_this_process():\n"
        "    print(flush=True)\n"
        "    from isopeel.__main__ import main; sys.exit(main())\n"
    )
    command = [sys.executable, "-c", script, "run", "strip", "--mesh", "400x10"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert process.stdout is not None
    process.stdout.read(1)
    time.sleep(seconds)
    process.send_signal(signal.SIGINT)
    began = time.perf_counter()
    _, error = process.communicate(timeout=_DEADLINE)
    assert (process.returncode, error) == (130, b"isopeel: interrupted\n")
    assert time.perf_counter() - began < 10.0  # on a machine with much to do


def test_semaphores_that_are_left_behind_are_not_reported() -> None:
    """On a busy machine no safe point comes in time. Then the resource tracker removes the semaphores."""
    script = (
        "import multiprocessing, signal, time\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "from isopeel.common.interrupts import ending_this_process\n"
        "with ending_this_process():\n"
        "    lock = multiprocessing.get_context('spawn').Lock()\n"
        "    print(flush=True)\n"
        "    time.sleep(600)\n"
    )
    process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert process.stdout is not None
    process.stdout.read(1)
    process.send_signal(signal.SIGINT)
    # the tracker holds standard error until it ends
    _, error = process.communicate(timeout=_DEADLINE)
    assert (process.returncode, error) == (130, b"isopeel: interrupted\n")


def test_a_path_of_the_library_raises_nothing_else() -> None:
    """With Python's own handler, 377 of 500 came as SystemError from compiled code."""
    problem, space = isopeel.strip(), isopeel.row_space("L2", (20, 1))
    angles = np.radians(np.arange(0.0, 60.0, 0.05))
    assert len(list(isopeel.trace(problem, space, angles[:3]))) == 3  # imports and compiles
    chance, found = random.Random(7), []
    for _ in range(40):
        seconds = chance.uniform(0.0, 0.1)
        before = signal.setitimer(signal.ITIMER_PROF, 0.0)
        assert before == (0.0, 0.0)
        handler = signal.signal(signal.SIGPROF, lambda *_: signal.raise_signal(signal.SIGINT))
        taken = 0
        try:
            signal.setitimer(signal.ITIMER_PROF, seconds)
            for _ in isopeel.trace(problem, space, angles):
                taken += 1
        except KeyboardInterrupt:
            found.append(taken)
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            signal.signal(signal.SIGPROF, handler)
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    assert len(found) > 30
    assert max(found) > min(found)


def press(times: int) -> None:
    for _ in range(times):
        signal.raise_signal(signal.SIGINT)


def pressed(times: int, passed: list[str], *, checked: bool) -> None:
    with deferred():
        press(times)
        passed.append("after Ctrl-C")
        if checked:
            check()
        passed.append("at the end")


@pytest.mark.parametrize("times", [1, 2])
@pytest.mark.parametrize("checked", [False, True])
def test_an_interrupt_is_raised_once_at_a_check_or_at_the_end(times: int, checked: bool) -> None:
    passed: list[str] = []
    with pytest.raises(KeyboardInterrupt):
        pressed(times, passed, checked=checked)
    assert passed == ["after Ctrl-C"] + ["at the end"] * (not checked)
    check()
    with deferred():
        check()


def test_a_third_ctrl_c_ends_the_process_at_once() -> None:
    passed: list[str] = []
    with pytest.raises(KeyboardInterrupt):
        pressed(3, passed, checked=False)
    assert passed == []
    check()


@pytest.mark.parametrize("handler", [signal.SIG_IGN, lambda *_: None])
def test_another_use_of_ctrl_c_stays(handler: Callable[..., None]) -> None:
    before = signal.signal(signal.SIGINT, handler)
    try:
        with deferred():
            press(1)
            assert signal.getsignal(signal.SIGINT) is handler
            check()
    finally:
        signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("code", [0, 3])
def test_what_is_done_is_not_interrupted(
    code: int, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def ended(*_: object) -> int:
        signal.raise_signal(signal.SIGINT)
        return code

    monkeypatch.setattr("isopeel.cli.compute_commands._ended", ended)
    assert main([*SMALL, "out", "--to", "1"]) == code
    assert capfd.readouterr().err == ""
