"""The steps of one stage: they are computed, written and shown, until the stage ends."""

import logging
from collections.abc import Iterable
from dataclasses import replace
from time import perf_counter

from rich.console import Console

from isopeel.common.interrupts import check, deferred, leave_time
from isopeel.post.table import write_curve
from isopeel.results.curve import DifferentiatedBy
from isopeel.results.layout import Layout
from isopeel.results.run_file import Failure, StoredRun, read_run
from isopeel.results.run_writer import RunWriter
from isopeel.running.folder import FILES
from isopeel.running.progress import progress
from isopeel.running.stage_results import print_results, write_results
from isopeel.running.stage_run import StageRun
from isopeel.running.stage_trace import attributes_of
from isopeel.solve.convergence import ConvergenceError
from isopeel.solve.step import Step

_LOG = logging.getLogger(__name__)


def run_stage(
    one: StageRun, steps: Iterable[Step], sensitive_to: tuple[DifferentiatedBy, ...], console: Console
) -> StoredRun:
    """Compute the steps of a stage, write all its files, and print its results.

    The steps have sensitivities to the given parameters.
    """
    began = perf_counter()
    stage, place, stored = one.stage, one.place, one.stored
    meshes = ", ".join(f"{name}: {space.name} {space.elements}" for name, space in one.spaces.items())
    _LOG.info("%s begins: %d steps after %d; %s", place.title, len(stage.parameters), one.met, meshes)
    writer = RunWriter(
        place.run_file,
        stage.problem.drive,
        one.case.text,
        attributes_of(one),
        stage.fields_every,
        place.outdated,
        None if one.base is None else one.base.displacement,
        stored,
        0 if stored is None else read_run(place.run_file).journaled,
        Layout.of(stage.problem, one.spaces, one.case.discretization.contact_points),
        sensitive_to,
    )
    with deferred():
        try:
            with writer:
                _follow(one, steps, writer, console)
        finally:
            _list_removed(writer, console)
            # the table must hold the steps of the file, whatever happens in between
            if writer.saved:
                write_curve(place.folder / "curve.csv", writer.curve, stage.problem, one.laboratory)
        run = replace(read_run(place.run_file), ending=writer.ending)
        corrections = int(run.curve.iterations.sum())
        _LOG.info("%s: %s, %d steps, %d corrections", place.title, run.ending, len(run.curve), corrections)
        try:
            results = write_results(one, run, perf_counter() - began)
        except KeyboardInterrupt:
            return replace(run, ending="interrupted")
    if run.ending != "interrupted":
        print_results(one, results, console)
    return run


def complete_stage(one: StageRun, run: StoredRun, console: Console) -> StoredRun:
    """Print that the run of a stage is complete, and write the files that it lacks."""
    reached = one.laboratory.parameter(run.curve.parameter_column, float(run.curve.parameter[-1]))
    console.print(f"{one.place.title} is complete: {len(run.curve)} steps, to {reached}", soft_wrap=True)
    if not all((one.place.folder / name).exists() for name in FILES):
        write_results(one, run, float(run.curve.seconds.sum()))
    return run


def _follow(one: StageRun, steps: Iterable[Step], writer: RunWriter, console: Console) -> None:
    """Pass the steps to their consumers, and set how the run ends."""
    drive, requested = one.stage.problem.drive, len(one.stage.parameters)
    try:
        with progress(console, drive, requested, one.met, one.laboratory.parameter) as show:
            for step in steps:
                writer.append(step)
                show(step)
                _LOG.debug("%s step, parameter %.9g, %s", step.kind, step.parameter, step.iterations)
                _list_removed(writer, console)
                if writer.saved:
                    leave_time()
                check()
        check()
        writer.end("completed")
    except ConvergenceError as error:
        parameter = drive.parameter_column.shown(error.parameter)
        writer.end("not converged", Failure(parameter, error.reason, error.iterations, error.cause))
    except KeyboardInterrupt:
        if len(writer.curve) == 0:
            raise
        writer.end("interrupted")


def _list_removed(writer: RunWriter, console: Console) -> None:
    """Print which files of an earlier run have been removed since the last call."""
    if writer.removed:
        console.print(f"removed {', '.join(map(str, writer.removed))}", soft_wrap=True)
        writer.removed.clear()
