"""The report of a study."""

from collections.abc import Iterator, Sequence
from functools import partial

from isopeel.report.document import Block, Document, Picture, Section, Table, Text
from isopeel.report.wording import listed
from isopeel.results.provenance import Provenance
from isopeel.study.figures import curves_figure, output_figure, shares_figure
from isopeel.study.sobol import CONFIDENCE, Index, Shares, variance_shares
from isopeel.study.table import StudyResults, columns_of

#: Rows of the table in the report; the file has all of them.
_MOST_ROWS = 200
#: Runs that are named beside a note.
_MOST_NAMED = 5
#: Outputs that have a figure.
_MOST_FIGURES = 12


def make_document(results: StudyResults, provenance: Provenance, command: str) -> Document:
    """Return the report of a study; its figures are drawn when it is written."""
    study, outcomes = results.study, results.outcomes
    completed = sum(outcome.ending == "completed" for outcome in outcomes)
    abstract = (
        f"The case {study.case.name} was run {len(outcomes)} times, with other values of"
        f" {listed([f'`{factor.key}`' for factor in study.factors])}. {completed} runs were completed."
    )
    sections = [
        Section("Runs", tuple(_runs(results)), command),
        Section(
            "Curves", (Picture("curves", "The reactions of all runs.", partial(curves_figure, results)),)
        ),
        Section("Outputs", tuple(_outputs(results))),
        Section("Where the numbers come from", tuple(_provenance(results, provenance))),
    ]
    return Document(f"Study {study.name}", Text(abstract), tuple(sections))


def _runs(results: StudyResults) -> Iterator[Block]:
    columns = columns_of(results)
    left_out = {"cause", "notes", "host"}
    headings = tuple(name for name in columns if name not in left_out)
    rows = list(zip(*(columns[name] for name in headings), strict=True))
    yield Text("`tables/runs.csv` has all rows and columns, and `tables/curves.h5` all curves.")
    notes = [] if len(rows) <= _MOST_ROWS else [f"The first {_MOST_ROWS} of {len(rows)} runs."]
    notes += [
        f"Run {number}: {outcome.cause}"
        for number, outcome in enumerate(results.outcomes, start=1)
        if outcome.cause
    ][:_MOST_ROWS]
    yield Table(
        "first-runs",
        "The runs: factors, readings and cost.",
        tuple(" ".join(heading.split()) for heading in headings),
        tuple(tuple(map(_cell, row)) for row in rows[:_MOST_ROWS]),
        tuple(" ".join(note.split()) for note in notes),
    )
    doubts: dict[str, list[int]] = {}
    for number, outcome in enumerate(results.outcomes, start=1):
        for note in outcome.notes:
            doubts.setdefault(_cell(note), []).append(number)
    if doubts:
        title = "Notes on readings and discretizations, and the runs that have them."
        lines = tuple((note, _of_runs(numbers)) for note, numbers in doubts.items())
        yield Table("notes", title, ("note", "runs"), lines)


def _of_runs(numbers: Sequence[int]) -> str:
    shown = ", ".join(map(str, numbers[:_MOST_NAMED]))
    return shown + (f" and {len(numbers) - _MOST_NAMED} more" if len(numbers) > _MOST_NAMED else "")


def _outputs(results: StudyResults) -> Iterator[Block]:
    drawn = [output for output in results.outputs if output.name not in results.missing_outputs]
    if not drawn:
        yield Text("No run has a reading.")
    for number, output in enumerate(drawn[:_MOST_FIGURES], start=1):
        yield Picture(f"output-{number}", f"{output.heading}.", partial(output_figure, results, output))
        shares = variance_shares(results, output)
        if shares is not None:
            yield from _shares(shares, number, output.name)
        elif results.study.method == "saltelli":
            yield Text(
                f"No shares of the variance of {output.name}: too few runs have a value, or it is constant."
            )
    if len(drawn) > _MOST_FIGURES:
        others = listed([output.name for output in drawn[_MOST_FIGURES:]])
        yield Text(f"Not drawn: {others}. `outputs` in the file of the study selects readings.")


def _shares(found: Shares, number: int, name: str) -> Iterator[Block]:
    left_out = found.all_points - found.used_points
    notes = (f"{left_out} of {found.all_points} points are left out: one of their runs has no value.",)
    title = (
        f"Shares of the variance of {name} (Sobol's indices), with intervals of {CONFIDENCE:.0%} confidence."
    )
    yield Table(
        f"shares-{number}",
        title,
        ("factor", "alone", "interval", "with interactions", "interval"),
        tuple((one.name, *_index(one.first_order), *_index(one.total_order)) for one in found.shares),
        notes if left_out else (),
    )
    yield Picture(f"shares-of-output-{number}", title, partial(shares_figure, found.shares))


def _index(index: Index) -> tuple[str, str]:
    return f"{index.value:.3f}", f"{index.low:.3f} to {index.high:.3f}"


def _provenance(results: StudyResults, provenance: Provenance) -> Iterator[Block]:
    versions = ", ".join(f"{name} {version}" for name, version in provenance.versions.items())
    hosts = len({outcome.host for outcome in results.outcomes} - {""})
    seconds = sum(outcome.seconds for outcome in results.outcomes)
    revision = f", source revision {provenance.git_revision}" if provenance.git_revision else ""
    yield Text(
        f"Computed by {versions}{revision}, on {hosts} machine{'' if hosts == 1 else 's'}. The runs took"
        f" {seconds:.0f} s in all."
    )


def _cell(value: object) -> str:
    if value is None:
        return ""
    return f"{value:.6g}" if isinstance(value, float) else " ".join(str(value).split())
