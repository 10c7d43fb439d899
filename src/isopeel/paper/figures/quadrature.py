"""The amplitude over the number of Gauss points of the adhesive force."""

from collections.abc import Mapping
from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from isopeel.common.errors import InputError
from isopeel.paper.figures.amplitudes import AMPLITUDE, by_rows
from isopeel.paper.figures.legend import add_legend, space_handles
from isopeel.post.style import GREY, TWO_COLUMNS, space_style, style

_RING: dict[str, Any] = {
    "color": GREY,
    "linestyle": "",
    "marker": "o",
    "markersize": 11,
    "markerfacecolor": "none",
}


def quadrature_figure(amplitudes: Mapping[str, Mapping[int, float]], default: Mapping[str, int]) -> Figure:
    """Draw dM of each space, in E0 L0^3, over the Gauss points of the adhesive force per element.

    A ring marks the `default`, the number of points of all other runs. Raises InputError if there are no
    amplitudes, or if a space has no default.
    """
    if not any(amplitudes.values()):
        raise InputError("amplitudes", dict(amplitudes), "give one at least")
    if missing := [space for space in amplitudes if space not in default]:
        raise InputError("default", missing[0], "give its number of points in all other runs")
    kinds = by_rows(amplitudes)
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 3.8), layout="constrained")
        panels = figure.subplots(1, len(kinds), squeeze=False, sharex=True, sharey=True)[0]
        for axes, (title, spaces) in zip(panels, kinds.items(), strict=True):
            for space in spaces:
                points = sorted(amplitudes[space])
                axes.plot(points, [amplitudes[space][k] for k in points], **space_style(space).marked)
                if default[space] in amplitudes[space]:
                    axes.plot(default[space], amplitudes[space][default[space]], **_RING)
            axes.set_title(title, loc="left")
            axes.set_xlabel("Gauss points per element")
            axes.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
        panels[0].set_yscale("log")
        panels[0].set_ylabel(AMPLITUDE)
        ring = Line2D([], [], **_RING, label="in all other runs")
        add_legend(figure, [*space_handles(amplitudes), ring])
        return figure
