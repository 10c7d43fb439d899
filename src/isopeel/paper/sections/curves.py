"""The moment over the rotation: whole curves, and their oscillation on the plateau."""

from collections.abc import Iterator, Sequence

from isopeel.paper.figures import Trace, linear_figure, meshes_figure, panels_figure
from isopeel.paper.reading import WINDOW, period_deg, plateau_mean
from isopeel.paper.results import Results
from isopeel.paper.study import SPACES, Run, table_runs
from isopeel.post.closed_form import beam_peeling
from isopeel.problem import strip
from isopeel.report.document import Block, Picture, Table, Text
from isopeel.report.wording import digits

TITLE = "Moment over rotation"
_OVER_MESHES = ("L4", "N2.1")


def runs(meshes: Sequence[str]) -> list[Run]:
    """Return the published discretizations."""
    return table_runs(meshes)


def blocks(results: Results, meshes: Sequence[str]) -> Iterator[Block]:
    """Yield the plateau beside its closed form, then the published Figs. 6 to 8."""
    closed_form = beam_peeling(strip())
    assert closed_form is not None  # it is a strip
    panel_mesh = "m2" if "m2" in meshes else meshes[0]
    finest = Run("L4", meshes[-1])
    yield Text(
        "In beam theory, the moment is constant from the onset at "
        f"{closed_form.onset_deg:.1f} degrees on: M = sqrt(2 E' I W) = {closed_form.moment:.4f}. The peeled "
        f"part then has the radius {closed_form.radius:.1f} nm. The mean moment of {finest.name} in the "
        f"window is {digits(plateau_mean(results.records[finest]), 7)}. On the plateau the moment oscillates "
        "once while the front passes an element: {periods}."
    )
    yield Table(
        "periods",
        "Rotation during which the front passes one element, by the closed form.",
        ("mesh", "period / degree"),
        tuple((mesh, f"{period_deg(mesh):.4f}") for mesh in meshes),
    )
    yield Picture(
        "linear",
        "Moment over rotation of L1 on all meshes, and the plateau enlarged (Fig. 6 there).",
        lambda: linear_figure({mesh: _trace(results, Run("L1", mesh)) for mesh in meshes}),
    )
    yield Picture(
        "panels",
        f"All spaces on {panel_mesh}, and their oscillation (Fig. 7 there).",
        lambda: panels_figure({s: _trace(results, Run(s, panel_mesh)) for s in SPACES}, WINDOW),
    )
    yield Picture(
        "meshes",
        f"{' and '.join(_OVER_MESHES)} over the meshes (Fig. 8 there).",
        lambda: meshes_figure(
            {(s, mesh): _trace(results, Run(s, mesh)) for s in _OVER_MESHES for mesh in meshes}, WINDOW
        ),
    )


def _trace(results: Results, run: Run) -> Trace:
    record = results.records[run]
    return Trace(record.angles_deg, record.moments)
