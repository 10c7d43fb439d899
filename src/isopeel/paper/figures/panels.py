"""The moment of all spaces on one mesh, whole and enlarged."""

from collections.abc import Mapping

from matplotlib.figure import Figure

from isopeel.common.errors import InputError
from isopeel.paper.figures.curves import Trace, around, draw_deviations, draw_enlarged, draw_whole
from isopeel.paper.figures.legend import add_legend, space_handles
from isopeel.post.style import SHADE, TWO_COLUMNS, space_style, style

#: Spaces that oscillate more than the plateau drifts, with linear elements beside them.
LAGRANGE, SMOOTH = ("L1", "L2", "L4"), ("L1", "N2", "N4", "N6", "N8")
#: Spaces that oscillate less.
SMOOTHEST = ("L4", "N2.1", "N4.1")


def panels_figure(curves: Mapping[str, Trace], window: tuple[float, float]) -> Figure:
    """Draw the curve of each space (key) on one mesh, whole and around the window in which it is read.

    The window is shaded. In the last panel each curve is drawn without its drift, a straight line fitted to
    it in the window. Raises InputError if there are no curves.
    """
    if not curves:
        raise InputError("curves", {}, "give one at least")
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 5.4), layout="constrained")
        panels = figure.subplots(2, 2).ravel()
        titles = ("(a) whole", "(b) Lagrange", "(c) smooth", "(d) the smallest oscillations, without drift")
        for axes, title in zip(panels, titles, strict=True):
            axes.axvspan(*window, color=SHADE, linewidth=0, zorder=0)
            axes.set_title(title, loc="left")
        draw_whole(panels[0], curves, {space: space_style(space).line for space in curves})
        looks = {space: space_style(space).marked | {"markersize": 4} for space in curves}
        for axes, spaces in zip(panels[1:], (LAGRANGE, SMOOTH, SMOOTHEST), strict=True):
            shown = {space: curves[space] for space in spaces if space in curves}
            # the markers of each curve are at other steps, so that they do not overlap
            sparse = {space: looks[space] | {"markevery": (k, 6)} for k, space in enumerate(shown)}
            if spaces == SMOOTHEST:
                draw_deviations(axes, shown, sparse, window)
            else:
                draw_enlarged(axes, shown, sparse, around(window))
        add_legend(figure, space_handles(curves))
        return figure
