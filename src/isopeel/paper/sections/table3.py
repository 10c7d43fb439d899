"""Table 3: the same values on m2, relative to those of L1."""

from collections.abc import Iterator, Sequence

from isopeel.paper.published import Figures, published_relative
from isopeel.paper.reading import Rows
from isopeel.paper.results import Results
from isopeel.paper.study import SPACES, Run, contact_row_runs, table_runs
from isopeel.report.document import Block, Table, Text
from isopeel.report.wording import ABSENT

TITLE = "Relative to L1: the published Table 3"
_MESH = "m2"


def runs(meshes: Sequence[str]) -> list[Run]:
    """Return the runs of Table 2 on m2, whatever meshes are requested."""
    return [*table_runs([_MESH]), *contact_row_runs([_MESH])] if _MESH in meshes else []


def blocks(results: Results, meshes: Sequence[str]) -> Iterator[Block]:
    """Yield one table, in percent; nothing without its mesh."""
    if _MESH not in meshes:
        return
    unit = results.figures(Run("L1", _MESH))
    theirs = published_relative()
    rows = []
    for space in SPACES:
        named = [Run(meaning.enriched(space), _MESH) for meaning in Rows]
        ours = [_relative(results.figures(run), unit) for run in named]
        rows.append(
            (space, _cell(theirs[space]), *map(_cell, ours), *(_points(o, theirs[space]) for o in ours))
        )
    meanings = [meaning.value for meaning in Rows]
    yield Text("Deviations are in percentage points. The published values follow from the published Table 2.")
    yield Table(
        "table3",
        "Mesh m2: dM / steepest rise / steepest fall, in percent of those of L1.",
        ("space", "published", *(f"ours, {meaning}" for meaning in meanings)),
        tuple(row[:5] for row in rows),
    )
    yield Table(
        "table3-deviation",
        "Mesh m2: ours minus published, in percentage points of L1.",
        ("space", *meanings),
        tuple((row[0], *row[5:]) for row in rows),
    )


def _relative(figures: Figures | None, unit: Figures | None) -> Figures | None:
    if figures is None or unit is None:
        return None
    return Figures(*(100 * value / whole for value, whole in zip(figures, unit, strict=True)))


def _cell(figures: Figures | None) -> str:
    return ABSENT if figures is None else " / ".join(f"{value:.2f}" for value in figures)


def _points(ours: Figures | None, theirs: Figures) -> str:
    if ours is None:
        return ABSENT
    return " / ".join(f"{a - b:+z.1f}" for a, b in zip(ours, theirs, strict=True))
