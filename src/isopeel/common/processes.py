"""Computation in several processes, which end when the first one ends."""

import os
import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, nullcontext
from multiprocessing import active_children, get_context, parent_process
from threading import Thread
from types import ModuleType
from typing import NamedTuple, ParamSpec, TypeVar

from isopeel.common.interrupts import check, leave_time

P = ParamSpec("P")
O = TypeVar("O")  # noqa: E741 (an outcome)


#: Seconds between two checks for Ctrl-C.
CHECK_SECONDS = 0.2


class WorkerLostError(RuntimeError):
    """A process that computed a task was ended from outside."""


class Done(NamedTuple):
    """What a task returned, and the seconds it took."""

    outcome: object
    seconds: float


@contextmanager
def worker_pool(
    workers: int, begin: Callable[[], None] | None = None, *, imports_script: bool = True
) -> Iterator[ProcessPoolExecutor]:
    """Open a pool whose processes are started when there are tasks; each calls `begin` first.

    If no task is defined in the script of the user, its processes need not import it: then the script may
    use the pool without `if __name__ == "__main__"`.

    The processes end at once if an error or an interrupt leaves the context, and when this process ends in
    any way. Raises WorkerLostError if one of them is ended from outside.
    """
    others = active_children()
    with _no_modules_from_here(), _Pool(workers, get_context("spawn"), _start_worker, (begin,)) as pool:
        pool.imports_script = imports_script
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

    Raises WorkerLostError if a process is ended from outside, and the errors of tasks.
    """
    done: dict[int, Done] = {}
    with worker_pool(workers) as pool:
        futures = {pool.submit(_timed, task): number for number, task in enumerate(tasks)}
        left = set(futures)
        while left:
            ready, left = wait(left, CHECK_SECONDS, return_when=FIRST_COMPLETED)
            check()
            for future in ready:
                done[futures[future]] = future.result()
                finished(futures[future], done[futures[future]])
    return [done[number] for number in range(len(tasks))]


def cores() -> int:
    """Return the number of cores that this process may use; at most 61 processes are possible on Windows."""
    own = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return min(own, 61)


class _Pool(ProcessPoolExecutor):
    """A pool whose processes are started when there are tasks, and ignore Ctrl-C."""

    imports_script = True

    def submit(self, task: Callable[P, O], /, *args: P.args, **kwargs: P.kwargs) -> Future[O]:
        with _interrupts_held(), nullcontext() if self.imports_script else _without_script():
            return super().submit(task, *args, **kwargs)


@contextmanager
def _no_modules_from_here() -> Iterator[None]:
    """In the context, new processes have the module path of this one, without the current folder."""
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
def _without_script() -> Iterator[None]:
    """In the context, new processes do not import the script of this one: `multiprocessing` finds none."""
    script = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        yield
    finally:
        sys.modules["__main__"] = script


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """In the context, new processes ignore Ctrl-C: it is sent to all of a group, but the first handles it.

    A signal in the meantime reaches the first process after the context. Windows has no such mask.
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
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # if it is not inherited
    Thread(target=_end_with_parent, daemon=True).start()
    if begin is not None:
        begin()


def _end_with_parent() -> None:
    """End this process when the first one is killed."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _timed(task: Callable[[], object]) -> Done:
    began = time.perf_counter()
    outcome = task()
    return Done(outcome, time.perf_counter() - began)
