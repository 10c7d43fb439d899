"""The spline spaces of the study, drawn."""

from collections.abc import Iterator, Sequence

from isopeel.paper.figures import bases_figure, refinement_figure
from isopeel.paper.results import Results
from isopeel.paper.study import Run
from isopeel.report.document import Block, Picture, Text

TITLE = "The spaces"


def runs(_meshes: Sequence[str]) -> list[Run]:
    """No runs: the functions alone are drawn."""
    return []


def blocks(_results: Results, _meshes: Sequence[str]) -> Iterator[Block]:
    """Names, functions, and the routes of refinement."""
    yield Text(
        "Lp is of degree p and C0, a Lagrange element; Np is of degree p and C(p-1); Np.q is Np elevated q "
        "times, of degree p + q and still C(p-1). L1+X has the space X in the row of control points at the "
        "contact and L1 above it, as an enriched contact element has; BULK+CONTACT@ROWS in so many rows."
    )
    yield Picture(
        "bases", "Functions of different degree and continuity over the same elements.", bases_figure
    )
    yield Picture(
        "refinement", "Three routes of refinement from one space, all of the same curve.", refinement_figure
    )
