"""Table 2: amplitude and steepest slopes of every discretization, ours beside the published ones."""

from collections.abc import Iterator, Sequence
from math import log

from isopeel.paper.figures import Amplitude, convergence_figure
from isopeel.paper.published import MISPRINTS, meant, published
from isopeel.paper.reading import Rows, plateau_mean
from isopeel.paper.results import Results
from isopeel.paper.study import MESHES, SPACES, Run, contact_row_runs, table_runs
from isopeel.paper.wording import deviations, endings, triple
from isopeel.report.document import Block, Picture, Table, Text
from isopeel.report.wording import deviation, digits, listed, number

TITLE = "Oscillation and slopes: the published Table 2"
#: Spaces whose values should agree with the published ones, those without elevation; and the largest
#: relative deviation that counts as agreement.
SMOOTH = ("L1", "N2", "N4", "N6", "N8")
AGREEMENT = 0.15
_MISPRINTED = "* misprinted: the table has the value that was probably meant, see the list of misprints."


def runs(meshes: Sequence[str]) -> list[Run]:
    """Return the published discretizations, enriched or elevated in all rows or in the contact row only."""
    return [*table_runs(meshes), *contact_row_runs(meshes)]


def blocks(results: Results, meshes: Sequence[str]) -> Iterator[Block]:
    """Yield two tables for each mesh, the conclusion, the agreement, the misprints, and dM over meshes."""
    yield Text(
        "Three values in a cell are dM / steepest rise / steepest fall, times 1e3. Our values are given for "
        "three meanings of a published name: the space in all rows; the space in the contact row only, over "
        "L1; and the elevation in the contact row only. L2 and L4 are elevations of L1, N2.1 of N2, and N4.1 "
        "of N4."
    )
    for mesh in meshes:
        yield _figures(results, mesh)
        yield _deviations(results, mesh)
    yield from _finding(results, meshes)
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


def _figures(results: Results, mesh: str) -> Table:
    rows = []
    for space, row in published(mesh).items():
        theirs = meant(row)
        mark = "*" if theirs != row.figures else ""
        record = results.records[Run(space, mesh)]
        ours = results.figures(record.run)
        rows.append(
            (
                space,
                triple(theirs) + mark if theirs else "not converging",
                triple(ours) if ours else f"ended at {record.reached_deg:.1f} degrees",
                _other(results, Rows.CONTACT, space, mesh),
                _other(results, Rows.ELEVATED, space, mesh),
            )
        )
    nx, ny = MESHES[mesh]
    marked = (_MISPRINTED,) if any("*" in row[1] for row in rows) else ()
    return Table(
        f"table2-{mesh}",
        f"Mesh {mesh}, {nx} x {ny} elements: dM / steepest rise / steepest fall, times 1e3.",
        ("space", "published", *(f"ours, {rows.value}" for rows in Rows)),
        tuple(rows),
        (*marked, *endings(results.records[run] for run in runs([mesh]))),
    )


def _other(results: Results, rows: Rows, space: str, mesh: str) -> str:
    """Return the values of a space with these rows enriched, or a reference to those of all rows."""
    enriched = rows.enriched(space)
    return "as all rows" if enriched == space else triple(results.figures(Run(enriched, mesh)))


def _deviations(results: Results, mesh: str) -> Table:
    rows = []
    for space, row in published(mesh).items():
        named = [Run(meaning.enriched(space), mesh) for meaning in Rows]
        dofs = " / ".join(dict.fromkeys(f"{results.records[run].dofs}" for run in named))
        rows.append(
            (
                space,
                *(deviations(results.figures(run), meant(row)) for run in named),
                f"{row.dofs_printed}" + ("*" if row.dofs_printed != row.dofs_true else ""),
                dofs,
                digits(plateau_mean(results.records[named[0]]), 7),
            )
        )
    return Table(
        f"table2-{mesh}-deviation",
        f"Mesh {mesh}: deviations of our dM / rise / fall from the published ones in percent; DOFs of the "
        "spaces; and the mean moment of the plateau for all rows.",
        ("space", *(meaning.value for meaning in Rows), "DOFs, published", "DOFs, ours", "plateau mean"),
        tuple(rows),
        ("Our DOFs: all rows / contact row only / elevated, where they differ; * misprinted.",),
    )


def _finding(results: Results, meshes: Sequence[str]) -> Iterator[Block]:
    """Yield the meaning of the names that is closest to the published values, by space."""
    distances = {
        meaning: {space: _distance(results, meshes, meaning, space) for space in SPACES} for meaning in Rows
    }
    total = {
        meaning: sum(known) / len(known)
        for meaning, found in distances.items()
        if (known := [value for value in found.values() if value is not None])
    }
    rows = tuple(
        (space, *(number(distances[meaning][space]) for meaning in Rows), _closest(distances, space))
        for space in SPACES
    )
    yield Table(
        "meanings",
        "Deviation of our values from the published ones for each meaning of a name: mean of "
        f"|ln(ours/published)| of dM, rise and fall on {listed(list(meshes))}.",
        ("space", *(meaning.value for meaning in Rows), "closest"),
        (*rows, ("mean", *(number(total.get(meaning)) for meaning in Rows), "")),
        (
            "If two meanings are the same space, or if their deviations differ by less than 0.02, the last "
            "column is empty.",
        ),
    )
    counts = [f"{_within(results, meshes, meaning)} with {meaning.value}" for meaning in Rows]
    yield Text(
        f"**The spaces of the published values.** Our dM are within {100 * AGREEMENT:.0f} % of the "
        f"published ones for {listed(counts)}. With all rows elevated, L2, L4, N2.1 and N4.1 oscillate far "
        "less than published. The published values of these four spaces are consistent with an elevation in "
        "the contact row only, although the published DOFs are those of all rows. The values of N4.1 show "
        "that the rows above the contact are N4: with L1 in these rows, the deviation is far larger. For "
        "some spaces the result is less clear, and not all are closest to the same meaning: see {meanings}."
    )


def _distance(results: Results, meshes: Sequence[str], meaning: Rows, space: str) -> float | None:
    misprinted = {(m.mesh, m.quantity) for m in MISPRINTS if (m.table, m.space) == (2, space)}
    found = []
    for mesh in meshes:
        theirs, ours = published(mesh)[space].figures, results.figures(Run(meaning.enriched(space), mesh))
        if theirs is not None and ours is not None:
            for name, value in theirs._asdict().items():
                if (mesh, name) not in misprinted:
                    found.append(abs(log(getattr(ours, name) / value)))
    return sum(found) / len(found) if found else None


def _closest(distances: dict[Rows, dict[str, float | None]], space: str) -> str:
    found = sorted(
        (value, meaning.value) for meaning in Rows if (value := distances[meaning][space]) is not None
    )
    clear = len(found) > 1 and found[1][0] - found[0][0] > 0.02
    return found[0][1] if clear else ""


def _within(results: Results, meshes: Sequence[str], meaning: Rows) -> str:
    ratios = [
        figures.amplitude / theirs.amplitude
        for mesh in meshes
        for space, row in published(mesh).items()
        if (theirs := row.figures) and (figures := results.figures(Run(meaning.enriched(space), mesh)))
    ]
    return f"{sum(abs(ratio - 1) <= AGREEMENT for ratio in ratios)} of {len(ratios)}"


def _agreement(results: Results, meshes: Sequence[str]) -> Iterator[Block]:
    """Yield whether each smooth space agrees with the published dM."""
    rows, outside = [], []
    for mesh in meshes:
        theirs = published(mesh)
        for space in SMOOTH:
            figures, ours = theirs[space].figures, results.figures(Run(space, mesh))
            if figures is None:
                continue
            within = ours is not None and abs(ours.amplitude / figures.amplitude - 1) <= AGREEMENT
            if not within:
                outside.append(f"{space} on {mesh}")
            amplitude = None if ours is None else ours.amplitude
            rows.append(
                (
                    f"{space}, {mesh}",
                    digits(figures.amplitude),
                    digits(amplitude),
                    deviation(amplitude, figures.amplitude),
                    "yes" if within else "no",
                )
            )
    yield Table(
        "agreement",
        "Agreement of L1 and the smooth spaces, in all rows, with the published dM within "
        f"{100 * AGREEMENT:.0f} %.",
        ("space, mesh", "published dM x 1e3", "ours", "deviation", "within"),
        tuple(rows),
    )
    if outside:
        yield Text(
            f"These entries are not within this range: {listed(outside)}. The tables above show the effect of"
            " other rows on them."
        )


def _misprints() -> Text:
    items = (
        f"- published Table {m.table}, {m.space} on {m.mesh}, {m.quantity}: printed {m.printed:g}, probably "
        f"meant {m.meant:g}; {m.reason}."
        for m in MISPRINTS
    )
    return Text("Misprints in the published tables, and the evidence for them:\n\n" + "\n".join(items))


def _amplitudes(results: Results, meshes: Sequence[str]) -> list[Amplitude]:
    entries = []
    for mesh in meshes:
        for space, row in published(mesh).items():
            theirs = None if row.figures is None else row.figures.amplitude / 1e3
            alone, elevated = (
                results.amplitude(Run(name, mesh)) if (name := meaning.enriched(space)) != space else None
                for meaning in (Rows.CONTACT, Rows.ELEVATED)
            )
            ours = results.amplitude(Run(space, mesh))
            entries.append(Amplitude(space, mesh, ours, alone, elevated, theirs))
    return entries
