"""The spline spaces of the study, drawn."""

from collections.abc import Iterator, Sequence

from isopeel.paper.figures import bases_figure, refinement_figure
from isopeel.paper.results import Results
from isopeel.paper.study import Run
from isopeel.report.document import Block, Picture, Text

TITLE = "The spaces"


def runs(_meshes: Sequence[str]) -> list[Run]:
    """Return no runs: only functions are drawn."""
    return []


def blocks(_results: Results, _meshes: Sequence[str]) -> Iterator[Block]:
    """Yield the names, the functions, and the routes of refinement."""
    yield Text(
        "Lp is a Lagrange element, of degree p and C0. Np has the degree p and C(p-1). Np.q is Np elevated q "
        "times: its degree is p + q, its continuity is still C(p-1). L1+X has the space X in the row of "
        "control points at the contact, and L1 in the rows above it, like an enriched contact element. "
        "BULK+CONTACT@ROWS has CONTACT in the first ROWS rows."
    )
    yield Picture(
        "bases", "Functions of different degree and continuity over the same elements.", bases_figure
    )
    yield Picture(
        "refinement", "Three routes of refinement of one space, all of the same curve.", refinement_figure
    )
