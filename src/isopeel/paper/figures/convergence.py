"""The amplitude of the oscillation over the length of the elements, beside the published amplitude."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import NullLocator

from isopeel.common.errors import InputError
from isopeel.paper.figures.amplitudes import AMPLITUDE, in_table_order
from isopeel.paper.figures.legend import add_legend
from isopeel.paper.study import LENGTH, MESHES
from isopeel.post.style import DASHES, GREY, TWO_COLUMNS, space_style, style

_COLUMNS = 3
_PUBLISHED: dict[str, Any] = {
    "color": "black",
    "linestyle": "",
    "marker": "_",
    "markersize": 16,
    "markeredgewidth": 1.4,
}

_ELEVATED: dict[str, Any] = {
    "color": GREY,
    "linestyle": DASHES,
    "linewidth": 0.8,
    "marker": "o",
    "markersize": 11,
    "markerfacecolor": "none",
}


@dataclass(frozen=True)
class Amplitude:
    """dM of a space on a mesh, in E0 L0^3.

    With the space in all rows; in the contact row only, over L1; elevated in the contact row only; and as
    published. None if there is no such number. Raises InputError for an unknown mesh, or a number that is not
    positive.
    """

    space: str
    mesh: str
    ours: float | None
    contact_row: float | None
    elevated: float | None
    published: float | None

    def __post_init__(self) -> None:
        if self.mesh not in MESHES:
            raise InputError("mesh", self.mesh, f"the published meshes are {', '.join(MESHES)}")
        for value in self.values:
            if value is not None and not value > 0:
                raise InputError("amplitude", value, "it must be positive")

    @property
    def values(self) -> tuple[float | None, ...]:
        """All four amplitudes."""
        return self.ours, self.contact_row, self.elevated, self.published

    @property
    def element_length(self) -> float:
        """Length of an element, in L0."""
        return LENGTH / MESHES[self.mesh][0]


def convergence_figure(entries: Sequence[Amplitude]) -> Figure:
    """Draw the amplitudes over the length of the elements, in one panel for each space that has any.

    Panels of a row share a scale. Raises InputError if there is no amplitude.
    """
    with_values = [entry for entry in entries if any(entry.values)]
    if not with_values:
        raise InputError("entries", list(entries), "give one amplitude at least")
    spaces = in_table_order(entry.space for entry in with_values)
    rows = ceil(len(spaces) / _COLUMNS)
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 0.6 + 1.9 * rows), layout="constrained")
        panels = figure.subplots(rows, _COLUMNS, squeeze=False, sharex=True, sharey="row")
        for axes, space in zip(panels.ravel(), spaces, strict=False):
            _draw(axes, [entry for entry in with_values if entry.space == space])
            axes.set_title(space, loc="left")
            axes.set(xscale="log", yscale="log")
        meshes = {entry.element_length: entry.mesh for entry in with_values}
        panels[0, 0].set_xticks(list(meshes), [f"{length:.3g}\n{mesh}" for length, mesh in meshes.items()])
        panels[0, 0].xaxis.set_minor_locator(NullLocator())
        panels[0, 0].margins(x=0.15)
        for axes in panels.ravel()[len(spaces) :]:
            axes.axis("off")
        figure.supxlabel("element length / $L_0$, and mesh", fontsize=9)
        figure.supylabel(AMPLITUDE, fontsize=9)
        ours = space_style("L1")
        handles = [
            Line2D([], [], **ours.marked, label="ours, all rows"),
            Line2D([], [], **replace(ours, hollow=True).marked, label="ours, contact row only, over L1"),
            Line2D([], [], **_ELEVATED, label="ours, elevated in the contact row only"),
            Line2D([], [], **_PUBLISHED, label="published"),
        ]
        add_legend(figure, handles)
        return figure


def _draw(axes: Axes, entries: Sequence[Amplitude]) -> None:
    """Draw the lines of one space."""
    lengths = [entry.element_length for entry in entries]
    ours, contact_row, elevated, published = np.array([entry.values for entry in entries], dtype=np.float64).T
    space = entries[0].space
    # so wide that it is visible around the lines that are drawn over it
    axes.plot(lengths, contact_row, **space_style(f"L1+{space}").marked | {"markersize": 7.5})
    axes.plot(lengths, ours, **space_style(space).marked | {"markersize": 4})
    axes.plot(lengths, elevated, **_ELEVATED)
    axes.plot(lengths, published, **_PUBLISHED)
