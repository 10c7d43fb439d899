"""The results of a stage that was run: its findings and its summary, without files."""

from typing import Any, NamedTuple

from isopeel.post.findings import Findings, find
from isopeel.post.mesh_error import mesh_changes
from isopeel.post.summary import summarize
from isopeel.results.run_file import StoredRun
from isopeel.running.stage_run import StageRun


class Results(NamedTuple):
    """The results of a stage, beside its stored run."""

    run: StoredRun
    findings: Findings
    summary: dict[str, Any]


def results_of(one: StageRun, run: StoredRun, wall_time: float) -> Results:
    """Return the findings and the summary of a run."""
    problem, points = one.stage.problem, one.case.discretization.contact_points
    found = find(problem, one.spaces, run, one.stage.window, one.laboratory, points)
    # after Ctrl-C a finer mesh would take too long
    changes = [] if run.ending == "interrupted" else mesh_changes(problem, one.spaces, run, points)
    return Results(run, found, summarize(one.place.title, run, found, wall_time, changes))
