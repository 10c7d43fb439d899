"""The functions of spaces of different degree and continuity."""

import numpy as np
from matplotlib.figure import Figure

from isopeel.post.figures.spaces import SHOWN_ELEMENTS, draw_functions
from isopeel.post.style import TWO_COLUMNS, space_style, style
from isopeel.splines.rows import row_space
from isopeel.splines.space import SplineSpace

#: Lagrange, smooth and elevated spaces from left to right.
SHOWN = (("L2", "N2", "N2.1"), ("L4", "N4", "N4.1"))


def bases_figure() -> Figure:
    """Draw the B-splines of spaces over the same elements, one of them highlighted with its support."""
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 4.4), layout="constrained")
        panels = figure.subplots(len(SHOWN), len(SHOWN[0]))
        for axes, name in zip(panels.ravel(), np.ravel(SHOWN).tolist(), strict=True):
            row = row_space(name, (SHOWN_ELEMENTS, 1)).rows[0]
            # one element has length 1
            space = SplineSpace(row.degree, row.knot_vector * SHOWN_ELEMENTS)
            title = f"{name}: degree {row.degree}, $C^{row.continuities[0]}$, {row.size} functions"
            lines = draw_functions(axes, space, title, "")
            color = space_style(name).color
            for line in lines:
                line.set(color=color, linewidth=0.8)
            middle = int(np.abs(space.greville - SHOWN_ELEMENTS / 2).argmin())
            lines[middle].set(linewidth=2, zorder=3)
            axes.fill_between(*lines[middle].get_data(), color=color, alpha=0.2, linewidth=0)
        lowest = min(axes.get_ylim()[0] for axes in figure.axes)
        for axes in figure.axes:
            axes.set_ylim(bottom=lowest)
        for axes in panels[-1]:
            axes.set_xlabel(r"$\xi$, in elements")
        for axes in panels[:, 0]:
            axes.set_ylabel(r"$N_i(\xi)$")
        knots = figure.axes[0].lines[-1]
        figure.legend([knots], ["a knot, once for each repetition"], loc="outside upper right")
        return figure
