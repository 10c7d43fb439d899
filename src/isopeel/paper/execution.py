"""Compute the runs of the study on all cores; finished runs are stored and not computed again."""

import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import dataclass
from functools import partial
from math import radians
from multiprocessing import get_context
from multiprocessing.queues import SimpleQueue
from pathlib import Path
from statistics import median
from typing import NamedTuple, Protocol

from isopeel.common.errors import InputError
from isopeel.common.interrupts import check
from isopeel.common.processes import worker_pool
from isopeel.paper.study import Run, with_bases
from isopeel.results.layout import Layout
from isopeel.results.provenance import Provenance
from isopeel.results.run_file import Failure, StoredRun, read_run, run_attributes
from isopeel.results.run_writer import RunWriter
from isopeel.running.lock import alone_in
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.step import State, Step
from isopeel.solve.trace import trace

_REPORT_SECONDS = 0.2  # between two reports of a run
#: A timed run is computed this many times: the first one loads functions, and other programs disturb some.
_TIMED_PASSES = 5


class Report(NamedTuple):
    """The progress of a run."""

    run: Run
    steps: int
    of: int


class Watcher(Protocol):
    """An observer of the progress of the runs."""

    def report(self, report: Report) -> None:
        """Receive the progress of a run."""

    def finished(self, run: Run, stored: StoredRun) -> None:
        """Receive a finished run."""

    def skipped(self, run: Run) -> None:
        """Receive a variant that is not computed, since it has no state to start from."""


@dataclass(frozen=True)
class Store:
    """The folder of the finished runs. Each has one file, which is replaced when it is computed again."""

    folder: Path

    def path(self, run: Run) -> Path:
        """Return the path of a run's file."""
        return self.folder / f"{run.name}.h5"

    def finished(self, run: Run) -> StoredRun | None:
        """Return a finished run; None if it is not finished, or was computed by other code."""
        try:
            stored = read_run(self.path(run))
        except InputError:
            return None
        done = stored.ending in ("completed", "not converged")
        return stored if done and stored.attributes.get("key") == run.key else None

    def read(self, run: Run) -> StoredRun:
        """Return a run that is finished; raises InputError if it is not."""
        stored = self.finished(run)
        if stored is None:
            raise InputError("run", run.name, "it is not finished")
        return stored


def execute(runs: Iterable[Run], store: Store, workers: int, watcher: Watcher) -> None:
    """Compute the runs that are not finished, and their bases, in other processes.

    A path that ends early counts as finished. A variant is not computed if its base ended before its start.
    The processes end at once when this one ends. Raises InputError if another process computes runs in the
    same folder, and WorkerLostError if one of the processes is ended from outside.
    """
    waiting = [run for run in with_bases(runs) if store.finished(run) is None]
    if not waiting:
        return
    with alone_in(store.folder, "--out"):
        _execute([run for run in waiting if not run.timed], store, workers, watcher)
        # one after the other, so that they do not slow each other down
        _execute([run for run in waiting if run.timed], store, 1, watcher)


def _execute(waiting: list[Run], store: Store, workers: int, watcher: Watcher) -> None:
    if not waiting:
        return
    reports: SimpleQueue[Report] = get_context("spawn").SimpleQueue()
    with worker_pool(workers, partial(_report_to, reports)) as pool:
        futures: dict[Future[None], Run] = {}

        def submit_ready() -> None:
            """Submit the runs whose bases are finished."""
            for run in list(waiting):
                if run.base in waiting or run.base in futures.values():
                    continue
                waiting.remove(run)
                if run.base is None or _reaches(store.read(run.base), run):
                    futures[pool.submit(_compute, run, run.key, store)] = run
                else:
                    watcher.skipped(run)

        submit_ready()
        while futures:
            done, _ = wait(futures, _REPORT_SECONDS, FIRST_COMPLETED)
            check()
            while not reports.empty():
                watcher.report(reports.get())
            for future in done:
                run = futures.pop(future)
                future.result()
                watcher.finished(run, store.read(run))
            if done:
                submit_ready()


def _reaches(stored: StoredRun, variant: Run) -> bool:
    return any(abs(state.parameter - variant.range_deg[0]) < 1e-6 for state in stored.states)


_reports: "SimpleQueue[Report] | None" = None


def _report_to(reports: "SimpleQueue[Report]") -> None:
    global _reports  # the only way to pass arguments to a worker at its start
    _reports = reports


def _fastest(steps: Callable[[], Iterator[Step]]) -> list[Step]:
    """Compute a path several times, and return the steps of the pass with the least median of seconds."""
    passes = [list(steps()) for _ in range(_TIMED_PASSES)]
    return min(passes, key=lambda one: median(step.seconds for step in one))


def _compute(run: Run, key: str, store: Store) -> None:
    """Trace a run and write its file, under the key that the main process uses for it."""
    case, angles = run.case, run.angles_deg
    problem, space = case.problem(), case.space()
    start: list[State] = []
    if run.base is not None:
        base = read_run(store.path(run.base)).nearest(run.range_deg[0])
        start.append(State(radians(base.parameter), base.displacement))
    attributes = run_attributes(problem, space, Provenance.of_this_process()) | {"key": key}

    def steps() -> Iterator[Step]:
        return trace(
            problem,
            space,
            map(radians, angles),
            NewtonSettings(plain=run.plain),
            start=start,
            contact_points=case.discretization.contact_points,
        )

    last_report = 0.0
    with RunWriter(
        store.path(run),
        problem.drive,
        case.text,
        attributes,
        case.stages()[0].fields_every,
        layout=Layout.of(problem, space, case.discretization.contact_points),
    ) as writer:
        try:
            for step in _fastest(steps) if run.timed else steps():
                writer.append(step)
                now = time.perf_counter()
                if _reports is not None and now > last_report + _REPORT_SECONDS:
                    last_report = now
                    _reports.put(Report(run, step.number + 1, len(angles)))
            writer.end("completed")
        except ConvergenceError as error:
            angle = problem.drive.parameter_column.shown(error.parameter)
            writer.end("not converged", Failure(angle, error.reason, error.iterations, error.cause))
