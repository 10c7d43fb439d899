"""Results and summaries of small runs, for the tests of this folder."""

from typing import Any, NamedTuple

from isopeel.case import Case
from isopeel.post.findings import Findings, find
from isopeel.post.laboratory import Laboratory
from isopeel.post.summary import summarize
from isopeel.post.summary_table import Row, summary_rows
from isopeel.results.curve import Curve
from isopeel.results.fields import KeptStates, StoredState
from isopeel.results.provenance import Provenance
from isopeel.results.run_file import StoredRun, run_attributes
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.trace import trace


class CaseResult(NamedTuple):
    """The result of a run: its curve, its readings, its summary, and the rows of its table."""

    case: Case
    curve: Curve
    found: Findings
    summary: dict[str, Any]
    rows: list[Row]

    def reading(self, quantity: str) -> dict[str, Any]:
        """Return the last reading of a quantity."""
        found: dict[str, Any] = [one for one in self.summary["readings"] if one["quantity"] == quantity][-1]
        return found

    def row(self, name: str) -> Row:
        """Return the row with a name."""
        (row,) = [row for row in self.rows if row.name == name]
        return row

    @property
    def quantities(self) -> list[str]:
        """The quantities that were read."""
        return [one["quantity"] for one in self.summary["readings"]]

    def notes(self, subject: str) -> list[str]:
        """Return the notes on a subject."""
        return [note["text"] for note in self.summary["notes"] if note["subject"] == subject]


def result_of(text: str) -> CaseResult:
    """Run the stages of a case in memory, and return the result of the last one."""
    case = Case.parse(text)
    space, base = case.space(), None
    for stage in case.stages():
        kept = KeptStates(stage.fields_every)
        steps = []
        settings = NewtonSettings(path_control=stage.path_control)
        for step in trace(stage.problem, space, stage.parameters, settings, base=base):
            steps.append(step)
            kept.take(StoredState.of(step, stage.problem.drive))
        before, base = base, steps[-1].state
    attributes = run_attributes(stage.problem, space, Provenance.of_this_process())
    run = StoredRun(
        text,
        Curve.of(steps, stage.problem.drive),
        kept.all(),
        {"L0": case.units.length, "E0": case.units.stress, **attributes},
        "completed",
        base=None if before is None else before.displacement,
    )
    laboratory = Laboratory.of(case.units.system(), stage.problem, case.width)
    found = find(stage.problem, space, run, stage.window, laboratory)
    summary = summarize(case.name, run, found, 1.0, [])
    return CaseResult(case, run.curve, found, summary, summary_rows(summary, run.curve, found))
