"""Curves of several runs in one figure, and their differences."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from isopeel.common.errors import InputError
from isopeel.post.comparison import Compared, difference
from isopeel.post.figures.labels import axis_label, mathematical, power_of_ten
from isopeel.post.figures.reaction import draw_branches
from isopeel.post.plateau import oscillation
from isopeel.post.style import TWO_COLUMNS, line_style, style

_MOST_COLUMNS = 4


def comparison_figure(runs: Sequence[Compared]) -> Figure:
    """Draw the curves of runs, their differences from the first, and the oscillations of their plateaus.

    Differences are drawn at the parameters that a run shares with the first one, oscillations where a plateau
    was read, without its mean and its drift. Raises InputError for less than two runs.
    """
    if len(runs) < 2:
        raise InputError("runs", [compared.name for compared in runs], "give two or more")
    read = [compared for compared in runs if compared.found.plateau is not None]
    looks = {compared.name: line_style(number) for number, compared in enumerate(runs)}
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 5.2), layout="constrained")
        panels = figure.subplot_mosaic("wwww;aabb" if read else "wwww;aaaa")
        for compared in runs:
            draw_branches(panels["w"], compared.run.curve, **looks[compared.name])
        curve = runs[0].run.curve
        panels["w"].margins(x=0)
        panels["w"].set_xlabel(axis_label(curve.parameter_column))
        panels["w"].set_ylabel(axis_label(curve.reaction_column))
        # marks on several curves have one entry in the legend
        handles, labels = panels["w"].get_legend_handles_labels()
        marks = dict(zip(labels, handles, strict=True))
        if marks:
            panels["w"].legend(list(marks.values()), list(marks), loc="lower right", fontsize=7)
        _draw_differences(panels["a"], runs, looks)
        if read:
            _draw_oscillations(panels["b"], read, looks)
        names = [Line2D([], [], **look, label=name) for name, look in looks.items()]
        figure.legend(handles=names, loc="outside upper left", ncols=min(len(names), _MOST_COLUMNS))
        return figure


def _draw_differences(axes: Axes, runs: Sequence[Compared], looks: dict[str, dict[str, Any]]) -> None:
    first, *others = runs
    apart = {other.name: difference(other.run.curve, first.run.curve) for other in others}
    everything = np.concatenate([one.reaction for one in apart.values()])
    exponent = power_of_ten(everything, float(np.abs(first.run.curve.reaction).max()))
    axes.axhline(0, **looks[first.name] | {"linewidth": 0.8})
    for name, (parameter, reaction) in apart.items():
        marker = "." if len(parameter) == 1 else ""
        axes.plot(parameter, reaction / 10.0**exponent, marker=marker, linewidth=0.8, **looks[name])
    if not everything.size:
        axes.text(0.5, 0.55, "no parameter in common", transform=axes.transAxes, ha="center")
        axes.set_yticks([])
    axes.margins(x=0)
    axes.set_title(f"less that of {first.name}", loc="left")
    _label(axes, first, "difference", exponent)


def _draw_oscillations(axes: Axes, runs: Sequence[Compared], looks: dict[str, dict[str, Any]]) -> None:
    waves = {}
    for compared in runs:
        plateau = compared.found.plateau
        assert plateau is not None  # those that have one are given
        waves[compared.name] = oscillation(compared.run.curve, plateau, compared.found.period)
    everything = np.concatenate([wave.values for wave in waves.values()])
    exponent = power_of_ten(everything, float(np.abs(runs[0].run.curve.reaction).max()))
    for name, wave in waves.items():
        axes.plot(wave.parameter, wave.values / 10.0**exponent, linewidth=1.1, **looks[name])
    axes.margins(x=0)
    axes.set_title("oscillation of the plateau", loc="left")
    _label(axes, runs[0], "deviation", exponent)


def _label(axes: Axes, compared: Compared, what: str, exponent: int) -> None:
    curve = compared.run.curve
    axes.set_xlabel(axis_label(curve.parameter_column))
    axes.set_ylabel(f"{what} / $10^{{{exponent}}}$ {mathematical(curve.reaction_column.unit)}")
