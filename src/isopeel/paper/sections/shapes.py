"""Deformed shapes during the peeling."""

from collections.abc import Iterator, Sequence

from matplotlib.figure import Figure

from isopeel.paper.results import Results
from isopeel.paper.study import Run
from isopeel.post.figures import shapes_figure
from isopeel.report.document import Block, Picture

TITLE = "Deformed shapes"
_SPACE, _MESH = "L4", "m2"


def runs(meshes: Sequence[str]) -> list[Run]:
    """Return one run, on m2 or on the first requested mesh."""
    return [_shown(meshes)]


def blocks(results: Results, meshes: Sequence[str]) -> Iterator[Block]:
    """Yield one picture."""
    run = _shown(meshes)

    def draw() -> Figure:
        case = run.case
        return shapes_figure(case.problem(), case.space(), results.stored(run).states)

    yield Picture(
        "shapes",
        "The strip in steps of the rotation, coloured by I1 = tr(sigma)/E, and its front enlarged; "
        f"{run.name}.",
        draw,
    )


def _shown(meshes: Sequence[str]) -> Run:
    return Run(_SPACE, _MESH if _MESH in meshes else meshes[0])
