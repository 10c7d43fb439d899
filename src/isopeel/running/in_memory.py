"""A run without files: the stages of a case are traced, and their results are returned."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from time import perf_counter

from isopeel.case import Case
from isopeel.common.interrupts import check
from isopeel.results.curve import Curve, DifferentiatedBy, row_of
from isopeel.results.fields import KeptStates, StoredState
from isopeel.results.run_file import Ending, Failure, StoredRun
from isopeel.running.sensitivities import Differentiation
from isopeel.running.stage_run import StageRun, stage_runs
from isopeel.running.stage_summary import Results, results_of
from isopeel.running.stage_trace import attributes_of
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.step import State, Step


def stage_results(case: Case, sensitivities: Sequence[str] = ()) -> Iterator[Results]:
    """Trace the stages of a case, and yield the results of each, up to one that finds no equilibrium.

    With the keys of parameters, the curve of each stage has the derivatives of its reaction by them, see
    `isopeel.results.curve.Curve`.

    The results are those of `isopeel.running.run.run_case`, without files and figures. Raises InputError if a
    stage cannot be computed.
    """
    began = perf_counter()
    for one, run in traced_stages(case, sensitivities):
        yield results_of(one, run, perf_counter() - began)
        began = perf_counter()


def traced_stages(case: Case, sensitivities: Sequence[str] = ()) -> Iterator[tuple[StageRun, StoredRun]]:
    """Trace the stages of a case as `stage_results` does, and yield their runs without reading results."""
    base: State | None = None
    differentiation = Differentiation.of(case, sensitivities)
    for number, begun in enumerate(stage_runs(case, Path())):
        one = replace(begun, base=base)
        run = _traced(one, differentiation.steps(number, one), differentiation.sensitive_to)
        yield one, run
        if run.ending != "completed":
            return
        base = run.last


def _traced(one: StageRun, steps: Iterable[Step], sensitive_to: tuple[DifferentiatedBy, ...]) -> StoredRun:
    """Trace a stage through all its steps."""
    drive, every = one.stage.problem.drive, one.stage.fields_every
    rows: list[Step] = []
    kept, last = KeptStates(every), None
    ending: Ending = "completed"
    failure: Failure | None = None
    try:
        for step in steps:
            check()
            rows.append(row_of(step))
            kept.take(StoredState.of(step, drive)._replace(step=step.number))
            last = step.state if step.resumes else last
    except ConvergenceError as error:
        at = drive.parameter_column.shown(error.parameter)
        ending, failure = "not converged", Failure(at, error.reason, error.iterations, error.cause)
    return StoredRun(
        one.case.text,
        Curve.of(rows, drive, sensitive_to),
        kept.all(),
        attributes_of(one),
        ending,
        failure,
        last,
        None if one.base is None else one.base.displacement,
        every,
    )
