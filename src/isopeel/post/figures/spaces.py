"""The basis functions of a row-wise space."""

from itertools import groupby

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from isopeel.common.arrays import FloatArray, IntArray
from isopeel.post.style import GREY, TWO_COLUMNS, style
from isopeel.splines.rows import RowSpace
from isopeel.splines.space import SplineSpace

SHOWN_ELEMENTS = 6
_POINTS = 40  # per element


def space_figure(space: RowSpace) -> Figure:
    """Draw the B-splines of each kind of row along xi, and those across, over the first few elements.

    Triangles mark the knots, one for each time a knot is repeated.
    """
    kinds = _kinds(space)
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 1.7 * (len(kinds) + 1)), layout="constrained")
        panels = figure.subplots(len(kinds) + 1, 1, squeeze=False)[:, 0]
        for axes, (title, row) in zip(panels, kinds, strict=False):
            draw_functions(axes, row, rf"$N_i(\xi)$, {title}: {_smoothness(row)}", r"$\xi$")
        across = space.across
        panels[0].set_title("▲ a knot", loc="right", color=GREY, fontsize=8)
        draw_functions(panels[-1], across, rf"$M_j(\eta)$, across the rows: {_smoothness(across)}", r"$\eta$")
        return figure


def _kinds(space: RowSpace) -> list[tuple[str, SplineSpace]]:
    """Return the title and the space of each group of equal rows, the first at the contact."""
    kinds, first = [], 1
    for _, group in groupby(space.rows, key=lambda row: (row.degree, row.knot_vector.tobytes())):
        rows = list(group)
        last = first + len(rows) - 1
        if len(rows) == len(space.rows):
            title = "every row"
        elif first == 1:
            title = "contact row" if last == 1 else f"contact rows 1 to {last}"
        else:
            title = f"row {first}" if first == last else f"rows {first} to {last}"
        kinds.append((title, rows[0]))
        first = last + 1
    return kinds


def _smoothness(space: SplineSpace) -> str:
    orders = sorted(set(space.continuities.tolist()))
    smoothness = ", " + " and ".join(f"$C^{order}$" for order in orders) if orders else ""
    return f"degree {space.degree}{smoothness}"


def draw_functions(axes: Axes, space: SplineSpace, title: str, parameter: str) -> list[Line2D]:
    """Draw the B-splines over the first few elements, with their knots; return their lines in order."""
    shown = min(SHOWN_ELEMENTS, space.elements)
    knots, counts = space.breakpoints[: shown + 1], space.multiplicities[: shown + 1]
    points = np.linspace(knots[:-1], knots[1:], _POINTS + 1, axis=1)
    elements = np.repeat(np.arange(shown), _POINTS + 1)
    values, first = space.basis(points.ravel(), 0, elements=elements)
    lines = []
    for function in range(int(first[-1]) + space.degree + 1):
        active = (first <= function) & (function <= first + space.degree)
        column = (function - first)[active]
        lines += axes.plot(points.ravel()[active], values[0, active, column], linewidth=1.1, clip_on=False)
    axes.vlines(knots, 0, 1, color=GREY, linewidth=0.4, clip_on=False)
    _knot_marks(axes, knots, counts)
    axes.set_xlim(knots[0], knots[-1])
    axes.set_xticks(knots, [f"{knot:.4g}" for knot in knots])
    axes.set_yticks([0, 1])
    axes.spines["left"].set_bounds(0, 1)
    axes.spines["bottom"].set_visible(False)
    axes.tick_params("x", length=0)
    axes.set_title(title, loc="left")
    axes.set_xlabel(parameter)
    return lines


def _knot_marks(axes: Axes, knots: FloatArray, counts: IntArray) -> None:
    spacing = 0.09
    x = np.repeat(knots, counts)
    y = -spacing * np.concatenate([1 + np.arange(count) for count in counts])
    axes.plot(x, y, "^", color=GREY, markersize=3, clip_on=False, linewidth=0)
    axes.set_ylim(y.min() - spacing, 1.05)
