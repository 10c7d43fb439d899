"""The message of a run that found no equilibrium."""

from pathlib import Path
from shlex import quote

from isopeel.results.run_file import Failure
from isopeel.running.run_reader import read_stages


def failure_message(failure: Failure, stage_folder: Path, folder: Path) -> str:
    """Return where and why a run found no equilibrium, the iterations there, and how to continue it.

    The folders are those of its last stage and of the whole run.
    """
    (stored,) = read_stages(stage_folder)
    laboratory = stored.laboratory
    at = laboratory.parameter(stored.run.curve.parameter_column, failure.parameter)
    iterations = [f"{number:9d}  {measure:.3e}" for number, measure in enumerate(failure.iterations, start=1)]
    if iterations:
        iterations.insert(0, "iteration  energy residual per unknown")
    lines = [
        f"no equilibrium at {at}: {laboratory.sentence(failure.reason)}",
        f"cause: {failure.cause}; {failure.hint}",
        *iterations,
        f"all steps that converged before are in {stage_folder}",
        f"`isopeel resume {quote(str(folder))} --control CONTROL` continues it with another path control",
    ]
    return "\n".join(lines)
