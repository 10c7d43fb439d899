"""Computing in processes of their own, which end where the first one does."""

import os
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process
from threading import Thread
from typing import NamedTuple, ParamSpec, TypeVar

from isopeel.common.interrupts import check, leave_time

P = ParamSpec("P")
O = TypeVar("O")  # noqa: E741 (an outcome)


#: Between two looks at whether Ctrl-C has come.
_CHECK_SECONDS = 0.2


class WorkerLostError(RuntimeError):
    """A process that computed a task was ended from outside."""


class Done(NamedTuple):
    """What a task returned, and the seconds it took."""

    outcome: object
    seconds: float


@contextmanager
def worker_pool(workers: int, begin: Callable[[], None] | None = None) -> Iterator[ProcessPoolExecutor]:
    """Start processes as tasks come, each of which calls `begin` first.

    They end at once where an error or an interrupt leaves the context, and where this process ends, in
    whatever way. Raises WorkerLostError where one of them is ended.
    """
    others = active_children()
    with _no_modules_from_here(), _Pool(workers, get_context("spawn"), _start_worker, (begin,)) as pool:
        leave_time()
        try:
            yield pool
        except BaseException as error:
            for process in active_children():
                if process not in others:
                    process.terminate()
            if isinstance(error, BrokenProcessPool):
                reason = "a process was ended from outside, perhaps for lack of memory"
                raise WorkerLostError(reason) from error
            raise


def compute_all(
    tasks: Sequence[Callable[[], object]], workers: int, finished: Callable[[int, Done], None]
) -> list[Done]:
    """Compute independent tasks, and report when each is finished; return results in their order.

    Raises WorkerLostError where a process is ended, and what a task raises.
    """
    done: dict[int, Done] = {}
    with worker_pool(workers) as pool:
        futures = {pool.submit(_timed, task): number for number, task in enumerate(tasks)}
        left = set(futures)
        while left:
            ready, left = wait(left, _CHECK_SECONDS, return_when=FIRST_COMPLETED)
            check()
            for future in ready:
                done[futures[future]] = future.result()
                finished(futures[future], done[futures[future]])
    return [done[number] for number in range(len(tasks))]


def cores() -> int:
    """Return the cores that this process may use; Windows waits for no more than 61 processes."""
    own = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return min(own, 61)


class _Pool(ProcessPoolExecutor):
    """A pool whose processes, which are started as tasks come, do not heed Ctrl-C."""

    def submit(self, task: Callable[P, O], /, *args: P.args, **kwargs: P.kwargs) -> Future[O]:
        with _interrupts_held():
            return super().submit(task, *args, **kwargs)


@contextmanager
def _no_modules_from_here() -> Iterator[None]:
    """Start processes that look for no module in the folder that this one runs in, but where it does."""
    name = "PYTHONSAFEPATH"
    before = os.environ.get(name)
    os.environ[name] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ[name]
        else:
            os.environ[name] = before


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Start processes that do not heed Ctrl-C: it goes to all of a group, and the first alone should.

    What is held back in the meantime reaches the first process afterwards. Windows has no such mask.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _start_worker(begin: Callable[[], None] | None) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # where it is not inherited
    Thread(target=_end_with_parent, daemon=True).start()
    if begin is not None:
        begin()


def _end_with_parent() -> None:
    """Leave no process behind where the first is killed."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _timed(task: Callable[[], object]) -> Done:
    began = time.perf_counter()
    outcome = task()
    return Done(outcome, time.perf_counter() - began)
