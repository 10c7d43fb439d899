"""Table 2: amplitude and steepest slopes of every discretization, ours beside the published."""

from collections.abc import Iterator, Sequence

from isopeel.paper.document import Block, Picture, Table, Text
from isopeel.paper.figures import Amplitude, convergence_figure
from isopeel.paper.published import MISPRINTS, published
from isopeel.paper.reading import WINDOW, Reading, Rows, plateau_mean
from isopeel.paper.results import Results
from isopeel.paper.study import MESHES, SPACES, Run, contact_row_runs, table_runs
from isopeel.paper.wording import UNIT, deviation, deviations, digits, endings, listed, triple

TITLE = "Table 2: oscillation and slopes"
#: Spaces whose figures should agree with the published ones, and by how much: those without enrichment.
SMOOTH = ("L1", "N2", "N4", "N6", "N8")
AGREEMENT = 0.15


def runs(meshes: Sequence[str]) -> list[Run]:
    """The published discretizations, with all rows and with the contact row alone enriched."""
    return [*table_runs(meshes), *contact_row_runs(meshes)]


def blocks(results: Results, meshes: Sequence[str]) -> Iterator[Block]:
    """Introduce the reading, then a table for each mesh, the agreement, the misprints and dM over meshes."""
    yield Text(
        "dM is the height of the oscillation, peak to peak, and the slopes are the steepest difference "
        f"quotients from one step to the next, per degree; all times 1e3, in {UNIT}. They are read between "
        f"{WINDOW[0]:g} and {WINDOW[1]:g} degrees, with the {Reading.MEAN.value}; the published window and "
        "definition are not told. Three figures in a cell are dM / steepest rise / steepest fall. A run that "
        "found no equilibrium under plain Newton ends there, and that is its result. Below 1e-5, as for L4, "
        "the curvature of the drift is as large as the oscillation, so that dM is an upper bound there."
    )
    for mesh in meshes:
        yield _table(results, mesh)
    yield _finding(results, meshes)
    judged = [mesh for mesh in meshes if mesh != "m1"]
    if judged:
        yield from _agreement(results, judged)
    yield _misprints()
    yield Picture(
        "dm-over-meshes",
        "Amplitude dM over the size of the elements: all rows, contact row only over L1, elevated in the "
        "contact row only, and published (Fig. 9 there).",
        lambda: convergence_figure(_amplitudes(results, meshes)),
    )


def _table(results: Results, mesh: str) -> Table:
    theirs = published(mesh)
    rows = []
    for space in SPACES:
        record, row = results.records[Run(space, mesh)], theirs[space]
        ours = results.figures(record.run)
        rows.append(
            (
                space,
                f"{record.dofs}",
                digits(plateau_mean(record), 7),
                triple(ours) if ours else f"ended at {record.angles_deg[-1]:.1f} degrees",
                _other(results, Rows.CONTACT, space, mesh),
                _other(results, Rows.ELEVATED, space, mesh),
                triple(row.figures) if row.figures else "not converging",
                *(
                    deviations(results.figures(Run(enriched.enriched(space), mesh)), row.figures)
                    for enriched in Rows
                ),
            )
        )
    nx, ny = MESHES[mesh]
    shown = [results.records[run] for run in runs([mesh])]
    return Table(
        f"table2-{mesh}",
        f"Mesh {mesh}, {nx} x {ny} elements: dM / steepest rise / steepest fall, times 1e3; and ours less "
        "published, in percent.",
        (
            "space",
            "DOFs",
            "plateau mean",
            *(f"ours, {enriched.value}" for enriched in Rows),
            "published",
            "all rows: deviation",
            "contact row: deviation",
            "elevated: deviation",
        ),
        tuple(rows),
        endings(shown),
    )


def _other(results: Results, rows: Rows, space: str, mesh: str) -> str:
    """The figures where other rows than all make another space."""
    enriched = rows.enriched(space)
    return "as all rows" if enriched == space else triple(results.figures(Run(enriched, mesh)))


def _finding(results: Results, meshes: Sequence[str]) -> Text:
    """Which column the published figures follow, counted."""
    counts = []
    for enriched in Rows:
        ratios = [
            (space, figures.amplitude / row.figures.amplitude)
            for mesh in meshes
            for space, row in published(mesh).items()
            if row.figures and (figures := results.figures(Run(enriched.enriched(space), mesh)))
        ]
        within = sum(abs(ratio - 1) <= AGREEMENT for _, ratio in ratios)
        others = sorted({space for space, ratio in ratios if abs(ratio - 1) > AGREEMENT}, key=SPACES.index)
        missed = f" (not {listed(others)})" if others else ""
        counts.append(f"{within} of {len(ratios)} with the space in {_WORDS[enriched]}{missed}")
    smaller = max(
        published_like.amplitude / whole.amplitude
        for mesh in meshes
        for space in SPACES
        if (whole := results.figures(Run(space, mesh)))
        and (published_like := results.figures(Run(Rows.ELEVATED.enriched(space), mesh)))
    )
    return Text(
        f"**What the published figures are of.** Within {100 * AGREEMENT:.0f} % of the published dM are "
        f"{listed(counts)}. So the published L2, L4, N2.1 and N4.1 have their order elevated in the row of "
        "control points at the contact alone, over L1, L1, N2 and N4, while the published DOFs count all "
        f"rows. With all rows elevated the oscillation is up to {smaller:.0f} times smaller."
    )


_WORDS = {
    Rows.ALL: "all rows",
    Rows.CONTACT: "the contact row over L1",
    Rows.ELEVATED: "all rows, but elevated in the contact row only",
}


def _agreement(results: Results, meshes: Sequence[str]) -> Iterator[Block]:
    """Row by row, whether the smooth spaces agree with the published dM, and what is known where not."""
    rows, outside = [], []
    for mesh in meshes:
        theirs = published(mesh)
        for space in SMOOTH:
            figures, amplitude = theirs[space].figures, results.amplitude(Run(space, mesh))
            if figures is None:
                continue
            ours = None if amplitude is None else 1e3 * amplitude
            within = ours is not None and abs(ours / figures.amplitude - 1) <= AGREEMENT
            if not within:
                outside.append(f"{space} on {mesh}")
            contact = results.figures(Run(Rows.CONTACT.enriched(space), mesh))
            alone = None if contact is None else contact.amplitude
            rows.append(
                (
                    f"{space}, {mesh}",
                    digits(ours),
                    digits(alone),
                    digits(figures.amplitude),
                    deviation(ours, figures.amplitude),
                    deviation(alone, figures.amplitude),
                    "yes" if within else "no",
                )
            )
    yield Table(
        "agreement",
        f"Do L1 and the smooth spaces agree with the published dM within {100 * AGREEMENT:.0f} %?",
        (
            "space, mesh",
            "all rows",
            "contact row only",
            "published",
            "all rows: deviation",
            "contact row: deviation",
            "all rows within",
        ),
        tuple(rows),
    )
    if outside:
        yield Text(f"Outside are {listed(outside)}; what is known about them stands below.")


def _misprints() -> Text:
    items = (
        f"- Table {m.table}, {m.space} on {m.mesh}, {m.quantity}: printed {m.printed:g}, "
        f"meant {m.meant:g}; {m.reason}."
        for m in MISPRINTS
    )
    return Text("Misprints of the published tables, and how one can tell:\n\n" + "\n".join(items))


def _amplitudes(results: Results, meshes: Sequence[str]) -> list[Amplitude]:
    entries = []
    for mesh in meshes:
        for space, row in published(mesh).items():
            theirs = None if row.figures is None else row.figures.amplitude / 1e3
            alone, elevated = (
                results.amplitude(Run(name, mesh)) if (name := rows.enriched(space)) != space else None
                for rows in (Rows.CONTACT, Rows.ELEVATED)
            )
            entries.append(
                Amplitude(space, mesh, results.amplitude(Run(space, mesh)), alone, elevated, theirs)
            )
    return entries
