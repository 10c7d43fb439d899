"""Further discretizations of the literature, and the cost of accuracy."""

from collections.abc import Iterator, Sequence

from isopeel.paper.figures import Cost, cost_figure
from isopeel.paper.published import quoted
from isopeel.paper.results import Results
from isopeel.paper.study import (
    LITERATURE,
    VARIED_SPACES,
    Run,
    contact_row_runs,
    literature_runs,
    table_runs,
    timed_runs,
)
from isopeel.paper.wording import endings
from isopeel.report.document import Block, Picture, Table, Text
from isopeel.report.wording import ABSENT, deviation, digits

TITLE = "Enriched contact elements, and the cost of accuracy"
#: Their names in the literature.
_SCHEMES = {
    "L1+L2": "Q1C2, Lagrange-enriched (Sauer, 2011)",
    "L1+L4": "Q1C4, Lagrange-enriched (Sauer, 2011)",
    "L1+N2.1": "Q1CH, Hermite-enriched (Sauer, 2011), and Q1N2.1 (Corbett and Sauer, 2014)",
    "L1+N3.2": "Hermite-enriched, degree 5 (Agrawal and Gautam)",
    "L1+N4.3": "Hermite-enriched, degree 7 (Agrawal and Gautam)",
    "L1+N4.1": "Q1N4.1, NURBS-enriched (Corbett and Sauer, 2014)",
    "N2+N4": "varying order, 1 row (Agrawal and Gautam, 2020)",
    "N2+N4@2": "varying order, 2 rows",
    "N2+N4@3": "varying order, 3 rows",
    "L2+N2@2": "hybrid, NURBS in 2 rows over Lagrange (Maleki-Jebeli et al., 2018)",
}


def runs(meshes: Sequence[str]) -> list[Run]:
    """Return all spaces, and their timed runs."""
    spaces = [*table_runs(meshes), *contact_row_runs(meshes), *literature_runs(meshes)]
    return [*spaces, *timed_runs(spaces)]


def blocks(results: Results, meshes: Sequence[str]) -> Iterator[Block]:
    """Yield a table of the schemes, a table of costs, and a picture of both."""
    yield Text(
        "Every enrichment is a choice of one spline space per row of control points. The published values "
        "of Q1N2.1 are the smallest ones of this scheme, which the study quotes from Corbett and Sauer "
        "(2014). The percentages in brackets are our deviations from them."
    )
    yield _schemes(results, meshes)
    yield Text(
        "A user needs a given accuracy at the lowest cost. The table has the median time and the mean number "
        "of corrections of 20 steps on the plateau. These steps were computed five times, one run after the "
        "other, on one core; the least of the five medians counts. A space is best for its DOFs if no other "
        "space on these meshes has both a smaller dM and fewer DOFs. It is best for its time if no other has "
        "both a smaller dM and a shorter time."
    )
    costs = _costs(results, meshes)
    yield _cost_table(results, costs)
    yield Picture(
        "cost-figure", "Amplitude dM over DOFs, and over the time of a step.", lambda: cost_figure(costs)
    )


def _schemes(results: Results, meshes: Sequence[str]) -> Table:
    theirs = {(row.space, row.mesh): row for row in quoted()}
    rows = []
    for space, scheme in _SCHEMES.items():
        cells = []
        for mesh in meshes:
            amplitude = results.amplitude(Run(space, mesh))
            published = theirs.get(("Q1N2.1", mesh)) if space == "L1+N2.1" else None
            cells += [
                f"{results.records[Run(space, mesh)].dofs}",
                digits(None if amplitude is None else 1e3 * amplitude),
                ABSENT if published is None else _published(published.amplitude, amplitude),
            ]
        rows.append((space, scheme, *cells))
    headings = [f"{mesh}: {what}" for mesh in meshes for what in ("DOFs", "dM x 1e3", "published")]
    return Table(
        "literature",
        "Enriched, varying-order and hybrid discretizations: dM, times 1e3, in E0 L0^3.",
        ("space", "scheme", *headings),
        tuple(rows),
        endings(results.records[Run(space, mesh)] for mesh in meshes for space in _SCHEMES),
    )


def _published(theirs: float, ours: float | None) -> str:
    return f"{digits(theirs)} ({deviation(None if ours is None else 1e3 * ours, theirs)})"


def _costs(results: Results, meshes: Sequence[str]) -> list[Cost]:
    costs = []
    for mesh in meshes:
        for space in (*VARIED_SPACES, *LITERATURE):
            amplitude = results.amplitude(Run(space, mesh))
            timed = results.records.get(Run(space, mesh, timed=True))  # None if the run ended before
            if amplitude is not None and timed is not None:
                costs.append(Cost(space, mesh, timed.dofs, timed.step_seconds, amplitude))
    return costs


def _cost_table(results: Results, costs: Sequence[Cost]) -> Table:
    rows = []
    for cost in sorted(costs, key=lambda cost: cost.amplitude):
        record = results.records[Run(cost.space, cost.mesh, timed=True)]
        better = [other for other in costs if other.amplitude < cost.amplitude]
        rows.append(
            (
                f"{cost.space}, {cost.mesh}",
                digits(1e3 * cost.amplitude),
                f"{cost.dofs}",
                f"{record.step_corrections:.2f}",
                f"{1e3 * cost.seconds:.1f}",
                "yes" if all(other.dofs >= cost.dofs for other in better) else "",
                "yes" if all(other.seconds >= cost.seconds for other in better) else "",
            )
        )
    return Table(
        "cost",
        "Accuracy and cost, the most accurate space first.",
        (
            "space, mesh",
            "dM x 1e3",
            "DOFs",
            "corrections per step",
            "ms, median step",
            "best for its DOFs",
            "best for its time",
        ),
        tuple(rows),
    )
