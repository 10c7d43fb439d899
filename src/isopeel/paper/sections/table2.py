"""Table 2: amplitude and steepest slopes of every discretization, ours beside the published."""

from collections.abc import Iterator, Sequence

from isopeel.paper.document import Block, Picture, Table, Text
from isopeel.paper.figures import Amplitude, convergence_figure
from isopeel.paper.published import MISPRINTS, published
from isopeel.paper.reading import WINDOW, Reading, Rows, plateau_mean
from isopeel.paper.results import Results
from isopeel.paper.study import MESHES, SPACES, Run, contact_row_runs, table_runs
from isopeel.paper.wording import ABSENT, UNIT, deviation, deviations, digits, endings, listed, triple

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
        f"{WINDOW[0]:g} and {WINDOW[1]:g} degrees, where {Reading.MEAN.value}; the published window and "
        "definition are not told. Three figures in a cell are dM / steepest rise / steepest fall. A run that "
        "found no equilibrium under plain Newton ends there, and that is its result."
    )
    for mesh in meshes:
        yield _table(results, mesh)
    judged = [mesh for mesh in meshes if mesh != "m1"]
    if judged:
        yield from _agreement(results, judged)
    yield _misprints()
    yield Picture(
        "dm-over-meshes",
        "Amplitude dM over the size of the elements: all rows enriched, contact row only, and published "
        "(Fig. 9 there).",
        lambda: convergence_figure(_amplitudes(results, meshes)),
    )


def _table(results: Results, mesh: str) -> Table:
    theirs = published(mesh)
    rows = []
    for space in SPACES:
        run, contact = Run(space, mesh), Run(Rows.CONTACT.enriched(space), mesh)
        record, row = results.records[run], theirs[space]
        ours, alone = results.figures(run), results.figures(contact)
        rows.append(
            (
                space,
                f"{record.dofs}",
                digits(plateau_mean(record), 7),
                triple(ours) if ours else f"ended at {record.angles_deg[-1]:.1f} degrees",
                triple(alone) if contact != run else ABSENT,
                triple(row.figures) if row.figures else "not converging",
                deviations(ours, row.figures),
                deviations(alone, row.figures) if contact != run else ABSENT,
            )
        )
    nx, ny = MESHES[mesh]
    shown = [results.records[run] for run in runs([mesh])]
    return Table(
        f"table2-{mesh}",
        f"Mesh {mesh}, {nx} x {ny} elements: dM / steepest rise / steepest fall, times 1e3.",
        (
            "space",
            "DOFs",
            "plateau mean",
            "ours, all rows",
            "ours, contact row only",
            "published",
            "all rows: deviation",
            "contact row: deviation",
        ),
        tuple(rows),
        endings(shown),
    )


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
            contact = Run(Rows.CONTACT.enriched(space), mesh)
            alone = results.amplitude(contact) if contact.space != space else None
            entries.append(Amplitude(space, mesh, results.amplitude(Run(space, mesh)), alone, theirs))
    return entries
