"""Processes compute what they are given, heed no Ctrl-C, and end with the first one."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial
from multiprocessing import active_children
from pathlib import Path
from time import sleep

import pytest
from psutil import Process, wait_procs

from isopeel.common.processes import WorkerLostError, compute_all, cores, worker_pool

PATIENCE = 30  # a loaded machine may take a while to end processes


def test_tasks_are_computed_in_processes_of_their_own() -> None:
    message: list[tuple[int, object]] = []
    tasks: list[Callable[[], object]] = [partial(pow, 2, 5), os.getpid, partial(pow, 3, 2)]
    done = compute_all(tasks, 1, lambda number, finished: message.append((number, finished.outcome)))
    assert [done[0].outcome, done[2].outcome] == [32, 9]
    assert done[1].outcome != os.getpid()
    assert dict(message) == {number: finished.outcome for number, finished in enumerate(done)}
    assert active_children() == []


def test_each_process_begins_as_it_is_reported() -> None:
    with worker_pool(1, partial(os.putenv, "BEGUN", "yes")) as pool:
        # what a process puts is seen by those that it starts
        shown = pool.submit(subprocess.check_output, ["env"]).result()
    assert b"BEGUN=yes" in shown.splitlines()
    assert b"BEGUN=yes" not in subprocess.check_output(["env"]).splitlines()


@pytest.mark.parametrize(
    ("task", "error"), [(partial(os._exit, 1), WorkerLostError), (partial(int, "x"), ValueError)]
)
def test_what_ends_a_task_ends_them_all(task: Callable[[], object], error: type[Exception]) -> None:
    with pytest.raises(error):
        compute_all([task, partial(sleep, 60.0)], 1, lambda *_: None)
    assert active_children() == []


def test_others_children_are_left_alone() -> None:
    with worker_pool(1) as outer:
        other = outer.submit(os.getpid).result()
        with pytest.raises(ValueError, match="x"):
            compute_all([partial(int, "x")], 1, lambda *_: None)
        assert outer.submit(os.getpid).result() == other


def test_cores_are_those_that_the_process_may_use() -> None:
    assert 1 <= cores() <= min(os.cpu_count() or 1, 61)


UNGUARDED = """
import os
from isopeel.common.processes import worker_pool
print("begun")
with worker_pool(1, imports_script=False) as pool:
    print(pool.submit(os.getpid).result() != os.getpid())
"""


def test_a_script_without_a_guard_begins_once(tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text(UNGUARDED)
    printed = subprocess.run(
        [sys.executable, tmp_path / "script.py"], capture_output=True, text=True, check=True
    )
    assert printed.stdout == "begun\nTrue\n"


SLEEPING = """
import sys, time
from functools import partial
from isopeel.common.processes import compute_all
try:
    compute_all([partial(time.sleep, 60.0)] * 2, 2, print)
except KeyboardInterrupt:
    sys.exit(130)
"""


@pytest.fixture
def sleeping() -> Iterator[subprocess.Popen[bytes]]:
    """Two tasks of a minute under way, alone in their group of processes."""
    process = subprocess.Popen(
        [sys.executable, "-c", SLEEPING], stderr=subprocess.PIPE, start_new_session=True
    )
    try:
        # two workers, and a keeper of resources
        while len(Process(process.pid).children()) < 3:
            sleep(0.02)
        yield process
    finally:
        process.kill()
        if process.stderr is not None:
            process.stderr.close()
        process.wait()


@pytest.mark.posix
@pytest.mark.parametrize("wait", [0.0, 1.0])  # while workers start, and later
def test_ctrl_c_ends_all_processes_at_once_and_only_the_first_handles_it(
    sleeping: subprocess.Popen[bytes], wait: float
) -> None:
    sleep(wait)
    children = Process(sleeping.pid).children()
    os.killpg(sleeping.pid, signal.SIGINT)
    _, error = sleeping.communicate(timeout=PATIENCE)
    assert (sleeping.returncode, error) == (130, b"")
    assert wait_procs(children, timeout=PATIENCE)[1] == []


def test_a_killed_process_leaves_none_behind(sleeping: subprocess.Popen[bytes]) -> None:
    sleep(1.0)  # until the workers know their parent
    children = Process(sleeping.pid).children()
    sleeping.kill()
    assert wait_procs(children, timeout=PATIENCE)[1] == []
