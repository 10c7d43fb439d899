"""The amplitude over the window in which it is read."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.paper.figures.amplitudes import AMPLITUDE, by_rows
from isopeel.paper.figures.legend import add_legend, space_handles
from isopeel.post.style import DASHES, GREY, TWO_COLUMNS, space_style, style


def windows_figure(
    starts: FloatArray,
    amplitudes: Mapping[str, FloatArray],
    window: tuple[float, float],
    published: Mapping[str, float],
) -> Figure:
    """Draw dM of each space over the start of the window, in degrees; all windows have the same length.

    `starts` and the amplitudes in E0 L0^3 are (n,); an amplitude that cannot be read is nan. The published
    amplitudes are marked at the right edge. Raises InputError if an array has another shape, or if there is
    no amplitude.
    """
    if not any(np.isfinite(values).any() for values in amplitudes.values()):
        raise InputError("amplitudes", list(amplitudes), "one of them must be read in one window at least")
    for space, values in amplitudes.items():
        if values.shape != starts.shape:
            raise InputError(f"amplitudes of {space}", values.shape, f"there are {starts.size} windows")
    kinds = by_rows(amplitudes)
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 3.8), layout="constrained")
        widths = [8 / len(kinds)] * len(kinds) + [1] * bool(published)
        panels = figure.subplots(
            1, len(widths), squeeze=False, sharey=True, gridspec_kw={"width_ratios": widths, "wspace": 0.02}
        )[0]
        for axes, (title, spaces) in zip(panels, kinds.items(), strict=False):
            for k, space in enumerate(spaces):
                # markers of different spaces at different starts
                sparse = (k * (starts.size // 6) // len(spaces), max(1, starts.size // 6))
                axes.plot(starts, amplitudes[space], **space_style(space).marked, markevery=sparse)
            axes.axvline(window[0], color=GREY, linestyle=DASHES, linewidth=0.8, zorder=0)
            axes.set_title(title, loc="left")
            axes.margins(x=0.02)
        if published:
            _draw_published(panels[-1], published)
        figure.supxlabel(f"start of a window of {window[1] - window[0]:.1f}° / degree", fontsize=9)
        panels[0].set_yscale("log")
        panels[0].set_ylabel(AMPLITUDE)
        used = Line2D([], [], color=GREY, linestyle=DASHES, linewidth=0.8, label="used")
        add_legend(figure, [*space_handles(amplitudes), used])
        return figure


def _draw_published(axes: Axes, published: Mapping[str, float]) -> None:
    """Draw the published amplitudes; close ones are drawn side by side."""
    for k, (space, amplitude) in enumerate(sorted(published.items(), key=lambda item: item[1])):
        axes.plot([k % 3], [amplitude], **space_style(space).marked)
    axes.set_xlim(-1, 3)
    axes.set_xticks([1], ["published"])
    axes.tick_params(axis="x", length=0)
    axes.tick_params(axis="y", which="both", left=False, labelleft=False)
    axes.spines["left"].set_visible(False)
