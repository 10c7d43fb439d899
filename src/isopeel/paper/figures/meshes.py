"""The oscillation of a space on each mesh."""

from collections.abc import Mapping

from matplotlib.figure import Figure

from isopeel.common.errors import InputError
from isopeel.paper.figures.curves import Trace, draw_deviations, mesh_handles, mesh_line
from isopeel.paper.figures.legend import add_legend
from isopeel.post.style import SHADE, TWO_COLUMNS, style


def meshes_figure(curves: Mapping[tuple[str, str], Trace], window: tuple[float, float]) -> Figure:
    """Draw the plateau of each (space, mesh), in one panel for each space, without its drift.

    The drift is a straight line fitted to each curve in the shaded window. Raises InputError if there are no
    curves.
    """
    if not curves:
        raise InputError("curves", {}, "give one at least")
    spaces = list(dict.fromkeys(space for space, _ in curves))
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 3.0), layout="constrained")
        panels = figure.subplots(1, len(spaces), squeeze=False)[0]
        for axes, space in zip(panels, spaces, strict=True):
            meshes = {mesh: curve for (name, mesh), curve in curves.items() if name == space}
            axes.axvspan(*window, color=SHADE, linewidth=0, zorder=0)
            draw_deviations(axes, meshes, {mesh: mesh_line(space, mesh) for mesh in meshes}, window)
            axes.set_title(space, loc="left")
        add_legend(figure, mesh_handles(mesh for _, mesh in curves))
        return figure
