"""A run: trace the stages of a case, and write their curves, files, summaries and figures to a folder."""

import logging
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from rich.console import Console

from isopeel.case import Case
from isopeel.results.run_file import StoredRun
from isopeel.running.checks import check_later_stages, early_notes
from isopeel.running.folder import check_folder, clear_parts, make_folder
from isopeel.running.lock import alone_in
from isopeel.running.previous_run import (
    check_foreign,
    check_previous,
    keep_finished,
    kept_runs,
    remove_kept,
)
from isopeel.running.sensitivities import Differentiation
from isopeel.running.stage_run import StageRun, stage_runs
from isopeel.running.stage_steps import complete_stage, run_stage
from isopeel.solve.step import State, Step

_LOG = logging.getLogger(__name__)


class Result(NamedTuple):
    """The stored run of a stage, and its folder."""

    run: StoredRun
    folder: Path


def run_case(
    case: Case,
    out: Path,
    console: Console,
    strict: bool = False,
    *,
    force: bool = False,
    sensitivities: Sequence[str] = (),
) -> Result:
    """Run a case and write its files to a folder, in place of those of an earlier run of it.

    A case of several stages has a folder for each stage inside, numbered and named. Returns the last stage
    that was run; the `ending` of its run is whether it was completed, found no equilibrium or was
    interrupted; the files hold all steps that converged before. Doubts about bodies and discretization are
    printed before the first step; they are an error where the run is `strict`. An earlier run stays until the
    first step, and a finished one is kept beside the new one (`run.earlier.h5`) until the new one has
    finished too. The steps have the derivatives of the reaction by the parameters with the keys of
    `sensitivities`.

    Raises InputError where a folder cannot be written, another process runs in it or the run needs more
    memory than there is, OSError where a file cannot be written, and KeyboardInterrupt where there is no step
    yet. Without `force` it also raises InputError where the folder holds anything else than a run of this
    case, or a run that is longer or was interrupted.
    """
    if not force:
        check_foreign(out)
    # the stages are checked before any folder is made
    runs = stage_runs(case, out)
    check_later_stages(runs)
    differentiation = Differentiation.of(case, sensitivities)
    steps = differentiation.steps(0, runs[0])
    for note in early_notes(runs, strict=strict):
        console.print(f"note: {note.text}", soft_wrap=True)
    make_folder(out)
    _LOG.info("case %s: stages: %d, folder: %s", case.name, len(runs), out)
    with alone_in(out, "--out"):
        if force:
            files = ", ".join(str(one.place.run_file) for one in runs if one.place.run_file.exists())
            replaced = files and f"replaces {files}"
        else:
            replaced = check_previous(case, [one.stage for one in runs], out)
        for one in runs:
            check_folder(one.place.folder)
            clear_parts(one.place.folder)
        if replaced:
            console.print(replaced, soft_wrap=True)
            keep_finished(out)
        try:
            return run_stages(runs, out, console, {}, differentiation, steps)
        finally:
            remove_kept(out, replaced=False)


def run_stages(
    runs: Sequence[StageRun],
    out: Path,
    console: Console,
    stored: Mapping[int, StoredRun],
    differentiation: Differentiation,
    first_steps: Iterable[Step] | None = None,
) -> Result:
    """Run stages in a folder as `run_case` does, after the `stored` ones, by their numbers from zero.

    The stored runs come without the steps of their journals, and all but the last are complete. Stages before
    the first stored one do not change. The caller keeps other processes out of the folder, and may pass the
    steps of the first stage. The kept files of an earlier run are removed once this one has finished.
    """
    result = _run_stages(runs, console, stored, differentiation, first_steps)
    if replace(runs[-1], stored=result.run).is_complete:
        remove_kept(out)
    elif kept := kept_runs(out):
        names = ", ".join(map(str, kept))
        console.print(f"the earlier finished run is kept: {names}", soft_wrap=True)
    return result


def _run_stages(
    runs: Sequence[StageRun],
    console: Console,
    stored: Mapping[int, StoredRun],
    differentiation: Differentiation,
    first_steps: Iterable[Step] | None,
) -> Result:
    base: State | None = None
    result: Result | None = None
    first = min(stored, default=0)
    try:
        for number, begun in enumerate(runs[first:], start=first):
            found = stored.get(number)
            if base is None and found is not None and found.base is not None:
                base = State(0.0, found.base)
            one = replace(begun, base=base, stored=found)
            if found is not None and one.is_complete:
                run = complete_stage(one, found, console)
            elif found is not None and found.failure is not None:
                run = found
            else:
                run = run_stage(
                    one,
                    first_steps or differentiation.steps(number, one),
                    differentiation.sensitive_to,
                    console,
                )
                first_steps = None
            result = Result(run, one.place.folder)
            if run.ending != "completed":
                break
            base = run.last
    except KeyboardInterrupt:
        if result is None:
            raise
        return result._replace(run=replace(result.run, ending="interrupted"))
    assert result is not None
    return result
