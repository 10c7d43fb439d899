"""The moment of the strip with linear elements on the meshes of the study."""

from collections.abc import Mapping

from matplotlib.figure import Figure

from isopeel.common.errors import InputError
from isopeel.paper.figures.curves import Trace, draw_enlarged, draw_whole, mesh_handles, mesh_line
from isopeel.paper.figures.legend import add_legend
from isopeel.post.style import SHADE, TWO_COLUMNS, style

SPACE = "L1"
#: The interval of the plateau that is enlarged, in degrees.
ENLARGED = (95.0, 105.0)


def linear_figure(curves: Mapping[str, Trace]) -> Figure:
    """Draw the moment of linear elements on each mesh (key), whole and a part of the plateau enlarged.

    Raises InputError if there are no curves.
    """
    if not curves:
        raise InputError("curves", {}, "give one at least")
    looks = {mesh: mesh_line(SPACE, mesh) for mesh in curves}
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 3.0), layout="constrained")
        whole, enlarged = figure.subplots(1, 2)
        whole.axvspan(*ENLARGED, color=SHADE, linewidth=0, zorder=0)
        draw_whole(whole, curves, looks)
        draw_enlarged(enlarged, curves, looks, ENLARGED)
        add_legend(figure, mesh_handles(curves))
        return figure
