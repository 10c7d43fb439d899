"""`isopeel paper`: input that it refuses, and how a study and its processes end."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from time import sleep

import pytest
from command_output import the_error
from filelock import FileLock
from psutil import Process

from isopeel.cli import main
from isopeel.common.processes import WorkerLostError, cores

pytestmark = pytest.mark.usefixtures("in_own_folder")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--only", "table9"], ["--only", "'table9'", "table2, table3, literature"]),
        (["--mesh", "m4"], ["--mesh", "'m4'", "m1, m2, m3"]),
        (["--out", "file"], ["--out", "'file'", "folder"]),
        (["--out", "file/x"], ["--out", "'file/x'", "folder"]),
    ],
)
def test_the_paper_refuses_what_makes_no_sense(
    arguments: list[str], message: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    Path("file").write_text("no folder")
    assert main(["paper", *arguments]) == 2
    error = the_error(capsys)
    for words in message:
        assert words in error


def test_the_paper_without_runs_is_quick(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["paper", "--only", "spaces"]) == 0
    assert capsys.readouterr().out == "the report is out/paper/spaces/report.html\n"
    assert {path.name for path in Path("out/paper/spaces/figures").iterdir()} == {
        f"{name}.{suffix}" for name in ("bases", "refinement") for suffix in ("png", "pdf")
    }


PAPER = [
    sys.executable,
    "-c",
    "import sys; from isopeel.cli import main; sys.exit(main())",
    *("paper", "--only", "table2", "--mesh", "m1"),
]


@pytest.fixture
def paper() -> Iterator[subprocess.Popen[bytes]]:
    """A study under way, with all its workers, and alone in its group of processes."""
    process = subprocess.Popen(
        PAPER, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, start_new_session=True
    )
    try:
        # workers, and a keeper of resources
        while len(Process(process.pid).children()) <= cores():
            assert process.poll() is None
            sleep(0.05)
        yield process
    finally:
        process.kill()
        if process.stderr is not None:
            process.stderr.close()
        process.wait()


# its pending runs are minutes; a loaded machine may take a while to end processes
PATIENCE = 30


@pytest.mark.posix
def test_ctrl_c_ends_the_paper_at_once(paper: subprocess.Popen[bytes]) -> None:
    sleep(2.0)  # while runs are computed; tests of the processes themselves interrupt them at their start
    os.killpg(paper.pid, signal.SIGINT)
    _, error = paper.communicate(timeout=PATIENCE)
    assert paper.returncode == 130
    assert (
        error
        == b"isopeel: interrupted; finished runs are in out/paper; the same command continues the study\n"
    )


def test_a_killed_worker_ends_the_paper_with_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def killed(*_: object) -> None:
        raise WorkerLostError("a process was ended from outside")

    monkeypatch.setattr("isopeel.paper.report.execute", killed)
    assert main(["paper", "--only", "table2", "--mesh", "m1"]) == 2
    error = the_error(capsys)
    assert error.startswith("isopeel: a process was ended from outside; finished runs are in out/paper; ")


def test_two_papers_in_one_folder_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    Path("out/paper/runs").mkdir(parents=True)
    with FileLock("out/paper/runs/.lock"):
        assert main(["paper", "--only", "table2", "--mesh", "m1"]) == 2
    assert "another process" in the_error(capsys)
