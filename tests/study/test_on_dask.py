"""The runs of a study as tasks of Dask."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest
from dying import Dying

from isopeel.common.errors import InputError
from isopeel.common.fingerprint import code_fingerprint
from isopeel.study import on_dask
from isopeel.study.on_dask import OnDask
from isopeel.study.outcome import LOST, REFUSED, Outcome, Task

pytest.importorskip("distributed")
HERE = Path(__file__).parent


def _outcomes(executor: OnDask, tasks: Sequence[Task]) -> dict[int, Outcome]:
    return dict(executor(dict(enumerate(tasks))))


def test_a_run_whose_worker_was_lost_is_computed_again(tmp_path: Path) -> None:
    lines: list[str] = []
    executor = OnDask(None, 1, lines.append)
    found = _outcomes(executor, [Dying("a", {"deaths": str(tmp_path / "run")})])
    assert found[0] == Outcome("completed", steps=1)
    assert lines[0].startswith("dashboard: http://")
    assert lines[0].endswith(", workers: 1")


def test_a_worker_with_other_code_computes_no_run() -> None:
    task = Dying("", {"deaths": "none"})
    assert on_dask._computed(task, code_fingerprint("running")).ending == "completed"
    with pytest.raises(RuntimeError, match=r"^the code of isopeel on .* is another one, or its Python is$"):
        on_dask._computed(task, "other")


@pytest.mark.long
def test_a_run_that_ends_each_worker_is_given_up(tmp_path: Path) -> None:
    deaths = ["", "aaaaaaaaa"]
    tasks = [Dying(text, {"deaths": str(tmp_path / f"run{number}")}) for number, text in enumerate(deaths)]
    found = _outcomes(OnDask(None, 2, lambda _: None), tasks)
    assert [found[number].ending for number in range(2)] == ["completed", LOST]
    assert "ended from outside" in found[1].cause


@pytest.fixture
def scheduler(tmp_path: Path) -> Iterator[tuple[str, subprocess.Popen[bytes]]]:
    """The address of a scheduler with two workers, which are processes of their own, and its process."""
    file = tmp_path / "scheduler.json"

    def begin(name: str, *words: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", f"distributed.cli.{name}", *words, "--scheduler-file", str(file)]
        # they import the tasks of this folder
        path = os.pathsep.join([str(HERE), *sys.path])
        environment = os.environ | {"PYTHONPATH": path}
        return subprocess.Popen(command, stderr=subprocess.DEVNULL, env=environment)

    processes = [begin("dask_scheduler", "--port", "0", "--dashboard-address", ":0", "--host", "127.0.0.1")]
    processes += [
        begin(
            "dask_worker",
            "--no-nanny",
            "--nthreads",
            "1",
            "--no-dashboard",
            "--local-directory",
            str(tmp_path),
        )
        for _ in range(2)
    ]
    try:
        import distributed

        with distributed.Client(scheduler_file=str(file), timeout=60, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=60)
            address = client.scheduler.address
        yield address, processes[0]
    finally:
        for process in processes:
            process.send_signal(signal.SIGKILL)
            process.wait()


@pytest.mark.long
def test_workers_elsewhere_compute_runs_until_their_scheduler_is_lost(
    scheduler: tuple[str, "subprocess.Popen[bytes]"],
) -> None:
    address, process = scheduler
    executor = OnDask(address, 1, lambda _: None)
    # a case that cannot be computed is an outcome, too
    found = _outcomes(executor, [Task("name = 1", {}), Task("nothing", {})])
    assert [found[number].ending for number in range(2)] == [REFUSED, REFUSED]
    assert found[1].cause.startswith("CASE: ")
    process.kill()
    process.wait()
    with pytest.raises(InputError, match=r"--scheduler: .*no scheduler answers"):
        _outcomes(executor, [Task("text", {})])
