"""Table 3: the same figures on m2, relative to those of L1."""

from collections.abc import Iterator, Sequence

from isopeel.paper.document import Block, Table, Text
from isopeel.paper.published import Figures, published_relative
from isopeel.paper.reading import Rows
from isopeel.paper.results import Results
from isopeel.paper.study import SPACES, Run, contact_row_runs, table_runs
from isopeel.paper.wording import ABSENT

TITLE = "Table 3: relative to L1"
_MESH = "m2"


def runs(meshes: Sequence[str]) -> list[Run]:
    """Those of Table 2 on m2, whatever meshes are asked for."""
    return [*table_runs([_MESH]), *contact_row_runs([_MESH])] if _MESH in meshes else []


def blocks(results: Results, meshes: Sequence[str]) -> Iterator[Block]:
    """One table, in percent; nothing without its mesh."""
    if _MESH not in meshes:
        return
    unit = results.figures(Run("L1", _MESH))
    theirs = published_relative()
    rows = []
    for space in SPACES:
        run, contact = Run(space, _MESH), Run(Rows.CONTACT.enriched(space), _MESH)
        ours, alone = (_relative(results.figures(shown), unit) for shown in (run, contact))
        rows.append(
            (
                space,
                _cell(ours),
                _cell(alone) if contact != run else ABSENT,
                _cell(theirs[space]),
                _points(ours, theirs[space]),
                _points(alone, theirs[space]) if contact != run else ABSENT,
            )
        )
    yield Text("Deviations are in percentage points. The published figures follow from those of Table 2.")
    yield Table(
        "table3",
        "Mesh m2: dM / steepest rise / steepest fall, in percent of those of L1.",
        (
            "space",
            "ours, all rows",
            "ours, contact row only",
            "published",
            "all rows: deviation",
            "contact row: deviation",
        ),
        tuple(rows),
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
    return " / ".join(f"{a - b:+.1f}" for a, b in zip(ours, theirs, strict=True))
