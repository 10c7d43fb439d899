"""Tasks in separate processes, each with a limit of its processor time.

A process that takes longer is ended and replaced: compiled code cannot be interrupted otherwise.
"""

import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from threading import Event, Thread

#: Status of a process that was out of time.
OUT_OF_TIME = 75


class Lost:
    """What is there of a task whose process is gone: whether it was out of time."""

    def __init__(self, *, out_of_time: bool) -> None:
        self.out_of_time = out_of_time


class _Worker:
    """A process, and the task that it works on."""

    def __init__(self, limit: float) -> None:
        context = get_context("spawn")
        self.connection, theirs = context.Pipe()
        self.process: SpawnProcess = context.Process(target=_work, args=(theirs, limit), daemon=True)
        self.process.start()
        theirs.close()
        self.task: int | None = None

    def begin(self, number: int, task: Callable[[], object]) -> None:
        self.task = number
        self.connection.send(task)

    def end(self) -> None:
        self.process.kill()
        self.process.join()
        self.connection.close()


def run_all(
    tasks: Sequence[Callable[[], object]],
    processes: int,
    limit: float,
    finished: Callable[[int, object], None],
) -> list[object]:
    """Run tasks, each in `limit` seconds of the processor; report each end, return results in order."""
    done: dict[int, object] = {}
    waiting = list(reversed(range(len(tasks))))
    with _workers(min(processes, len(tasks)), limit) as workers:
        while len(done) < len(tasks):
            for worker in workers:
                if worker.task is None and waiting:
                    worker.begin(waiting[-1], tasks[waiting.pop()])
            ready = wait([worker.connection for worker in workers if worker.task is not None])
            for place, worker in enumerate(workers):
                if worker.task is None or worker.connection not in ready:
                    continue
                number, worker.task = worker.task, None
                try:
                    done[number] = worker.connection.recv()
                except EOFError:
                    worker.process.join()
                    done[number] = Lost(out_of_time=worker.process.exitcode == OUT_OF_TIME)
                    worker.end()
                    workers[place] = _Worker(limit)
                finished(number, done[number])
    return [done[number] for number in range(len(tasks))]


@contextmanager
def _workers(count: int, limit: float) -> Iterator[list[_Worker]]:
    workers: list[_Worker] = [_Worker(limit) for _ in range(count)]
    try:
        yield workers
    finally:
        for worker in workers:
            worker.end()


def _work(connection: Connection, limit: float) -> None:
    while True:
        try:
            task = connection.recv()
        except EOFError:
            return
        over = Event()
        Thread(target=_watch, args=(over, limit), daemon=True).start()
        outcome = task()
        over.set()
        connection.send(outcome)


def _watch(over: Event, limit: float) -> None:
    began = time.process_time()
    while not over.wait(0.25):
        if time.process_time() - began > limit:
            os._exit(OUT_OF_TIME)
