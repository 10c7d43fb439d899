"""Compute the runs of a study as tasks of Dask, on this machine or on any scheduler."""

import logging
import platform
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from queue import Empty, Queue
from typing import Any

from isopeel.common.errors import InputError
from isopeel.common.fingerprint import code_fingerprint
from isopeel.common.interrupts import check
from isopeel.common.processes import CHECK_SECONDS
from isopeel.study.execution import Executor, InProcesses, lost
from isopeel.study.outcome import Outcome, Task

_CONNECT_SECONDS = 10.0
_SETTINGS = {
    # a worker that is silent for so long is lost: a compiler keeps it silent for some seconds
    "distributed.scheduler.worker-ttl": "60 s",
    # Dask lets workers return memory to the system at once, which makes a run a third slower
    "distributed.nanny.pre-spawn-environ": {"OMP_NUM_THREADS": "1"},
}


def is_installed() -> bool:
    """Return whether Dask's `distributed` can be imported."""
    try:
        import distributed  # noqa: F401
    except ImportError:
        return False
    return True


def executor_of(scheduler: object, workers: int, show: Callable[[str], None], field: str) -> Executor:
    """Return the executor for a scheduler: an address, a client, `processes`, or None for what is installed.

    Raises InputError for a field if a scheduler is given and Dask is not installed.
    """
    if scheduler == "processes" or (scheduler is None and not is_installed()):
        return InProcesses(workers)
    if not is_installed():
        raise InputError(field, str(scheduler), "Dask is not installed: pip install 'isopeel[study]'")
    return OnDask(scheduler, workers, show, field)


@dataclass(frozen=True)
class OnDask:
    """Computes tasks on a scheduler, which is given by its address or by a client that is connected to it.

    Without a scheduler, a cluster of processes is started on this machine. Workers need isopeel, but no disk
    in common with this process. A task whose worker is lost is computed again, up to the `allowed-failures`
    of the scheduler. `show` receives lines for the user, and `field` is the scheduler in error messages.
    """

    scheduler: Any
    workers: int
    show: Callable[[str], None]
    field: str = "--scheduler"

    def __call__(self, tasks: Mapping[int, Task]) -> Iterator[tuple[int, Outcome]]:
        """Yield the outcomes of tasks. Raises InputError if there is no connection to it."""
        if not tasks:
            return
        from distributed.scheduler import KilledWorker

        with self._client() as client:
            workers = len(client.scheduler_info()["workers"])
            waits = "" if workers else "; runs wait for a worker that connects to it"
            self.show(f"dashboard: {client.dashboard_link}, workers: {workers}{waits}")
            done: Queue[Any] = Queue()
            code = code_fingerprint("running")
            # keys are unlike those of other studies on the same scheduler
            futures = {
                client.submit(
                    _computed, task, code, key=f"isopeel-{task.digest}-{number}", pure=False
                ): number
                for number, task in tasks.items()
            }
            for future in futures:
                future.add_done_callback(done.put)
            while futures:
                try:
                    future = done.get(timeout=CHECK_SECONDS)
                except Empty:
                    check()
                    continue
                check()
                number = futures.pop(future)
                if future.status == "cancelled":
                    raise InputError(self.field, self._name, "the connection to it was lost")
                try:
                    outcome = future.result()
                except KilledWorker as error:
                    outcome = lost(error.allowed_failures + 1)
                except Exception as error:
                    # a task returns what is wrong with its run: this one could not be loaded there, or the
                    # code there is another one
                    allowed = f"a worker needs this version of isopeel: {' '.join(str(error).split())}"
                    raise InputError(self.field, self._name, allowed) from error
                yield number, outcome

    @property
    def _name(self) -> str:
        if self.scheduler is None:
            return "local"
        return self.scheduler if isinstance(self.scheduler, str) else self.scheduler.scheduler.address

    @contextmanager
    def _client(self) -> Iterator[Any]:
        import dask
        import distributed

        if isinstance(self.scheduler, distributed.Client):
            with _silent():
                yield self.scheduler
            return
        if self.scheduler is None:
            with (
                dask.config.set(_SETTINGS),
                self._cluster() as cluster,
                distributed.Client(cluster, set_as_default=False) as client,
            ):
                yield client
            return
        try:
            client = distributed.Client(self.scheduler, timeout=_CONNECT_SECONDS, set_as_default=False)
        except (OSError, ValueError) as error:
            allowed = f"no scheduler answers there: {error}"
            raise InputError(self.field, str(self.scheduler), allowed) from error
        # the loss of a connection is an error of ours, with one line
        with _silent(), client:
            yield client

    def _cluster(self) -> Any:
        """Start a cluster on this machine. Raises InputError if that fails."""
        import distributed

        try:
            return distributed.LocalCluster(
                n_workers=self.workers, threads_per_worker=1, processes=True, silence_logs=logging.CRITICAL
            )
        except (RuntimeError, OSError) as error:
            allowed = f"its processes did not start: {error}; --scheduler processes does without Dask"
            raise InputError(self.field, self._name, allowed) from error


def _computed(task: Task, code: str) -> Outcome:
    """Compute a task on a worker. Raises RuntimeError if its code is another one than that of the study."""
    if code_fingerprint("running") != code:
        raise RuntimeError(f"the code of isopeel on {platform.node()} is another one, or its Python is")
    return task()


@contextmanager
def _silent() -> Iterator[None]:
    """In the context, Dask logs nothing."""
    loggers = [logging.getLogger(name) for name in ("distributed", "distributed.client")]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)
