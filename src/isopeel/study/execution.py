"""Compute the runs of a study that are not stored yet, in several processes."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from isopeel.common.interrupts import check
from isopeel.common.processes import CHECK_SECONDS, WorkerLostError, worker_pool
from isopeel.running.lock import alone_in
from isopeel.study.outcome import LOST, Outcome, Task, read_outcome, write_outcome

#: A run whose process was lost as many times is not computed again.
_MOST_LOSSES = 3
#: Tasks that wait in the queue of a pool, for each process: the next one is there when one is done.
_QUEUED = 2

#: Receives each finished run: its number from zero, and its outcome.
Finished = Callable[[int, Outcome], None]


class Executor(Protocol):
    """Computes tasks somewhere, and reports each as soon as it is finished, in any order."""

    def __call__(self, tasks: Mapping[int, Task]) -> Iterator[tuple[int, Outcome]]:
        """Yield the outcomes of tasks, by their numbers. A task whose process is lost is computed again."""


@dataclass(frozen=True)
class Store:
    """The folder of finished runs: one file each, by the digest of its task."""

    folder: Path

    def path(self, task: Task) -> Path:
        """Return the path of a run's file."""
        return self.folder / f"{task.digest}.h5"

    def read(self, task: Task) -> Outcome | None:
        """Return the outcome of a task; None if it is not finished."""
        return read_outcome(self.path(task))


def compute(
    tasks: Sequence[Task], store: Store | None, executor: Executor, finished: Finished
) -> list[Outcome]:
    """Return the outcomes of tasks in their order; those that the store has are not computed again.

    Each outcome is stored when it is finished, so that an interrupted study continues. A run whose process
    was lost is not stored: the same command computes it again. Without a store nothing is written. Raises
    InputError for --out if another process computes runs in the folder, and OSError if an outcome cannot be
    written.
    """
    outcomes: dict[int, Outcome] = {}
    with nullcontext() if store is None else alone_in(store.folder, "--out"):
        waiting: dict[int, Task] = {}
        # the order of digests is random: runs that are done are a sample of all, also in their time
        for number, task in sorted(enumerate(tasks), key=lambda pair: pair[1].digest):
            stored = None if store is None else store.read(task)
            if stored is None:
                waiting[number] = task
            else:
                outcomes[number] = stored
        for number, outcome in executor(waiting):
            if store is not None and outcome.ending != LOST:
                write_outcome(outcome, store.path(tasks[number]))
            outcomes[number] = outcome
            finished(number, outcome)
    return [outcomes[number] for number in range(len(tasks))]


@dataclass(frozen=True)
class InProcesses:
    """Computes tasks in processes of this machine, one thread each."""

    workers: int

    def __call__(self, tasks: Mapping[int, Task]) -> Iterator[tuple[int, Outcome]]:
        """Yield the outcomes of tasks. After the loss of a process its tasks are computed one by one."""
        losses: dict[int, int] = {}
        left = dict(tasks)
        while left:
            # the run that ends its process is found by computing those that were lost alone
            suspect = next(({number: left[number]} for number in losses if number in left), None)
            try:
                for number, outcome in self._computed(suspect or left):
                    del left[number]
                    yield number, outcome
            except _LostError as error:
                for number in error.numbers:
                    losses[number] = losses.get(number, 0) + 1
                    if losses[number] >= _MOST_LOSSES:
                        del left[number]
                        yield number, lost(losses[number])

    def _computed(self, tasks: Mapping[int, Task]) -> Iterator[tuple[int, Outcome]]:
        """Yield the outcomes of tasks. Raises _LostError if a process is ended from outside."""
        waiting = iter(list(tasks.items()))  # the caller removes what is done
        futures: dict[Future[Outcome], int] = {}
        try:
            with worker_pool(min(self.workers, len(tasks)), imports_script=False) as pool:
                while True:
                    for number, task in waiting:
                        futures[pool.submit(task)] = number
                        if len(futures) >= _QUEUED * self.workers:
                            break
                    if not futures:
                        return
                    done, _ = wait(futures, CHECK_SECONDS, FIRST_COMPLETED)
                    check()
                    for future in done:
                        outcome = future.result()
                        yield futures.pop(future), outcome
        except WorkerLostError as error:
            raise _LostError(list(futures.values())) from error


class _LostError(RuntimeError):
    """Runs whose processes were ended from outside, or waited for them."""

    def __init__(self, numbers: Sequence[int]) -> None:
        super().__init__(numbers)
        self.numbers = numbers


def lost(times: int) -> Outcome:
    """Return the outcome of a run whose process was ended from outside."""
    return Outcome(LOST, f"its process was ended from outside {times} times, perhaps for lack of memory")
