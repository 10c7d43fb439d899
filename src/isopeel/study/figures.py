"""The figures of a study: all curves, and each output over the factors."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure

from isopeel.common.arrays import FloatArray
from isopeel.post.style import BLUE, FIELD_MAP, GREY, TWO_COLUMNS, VERMILION, style
from isopeel.study.design import groups_of
from isopeel.study.factors import Factor, Range
from isopeel.study.table import Output, StudyResults, heading_of

#: Panels in one row.
_MOST_PANELS = 3
#: Parts of the range of a sampled factor whose means show its main effect.
_PARTS = 8


class _Scale:
    """The values of a factor as places on an axis: numbers, or one place for each name."""

    def __init__(self, results: StudyResults, factor: Factor) -> None:
        values = results.factor_values(factor)
        self.label = factor.heading
        self.names: list[str] = []
        if isinstance(values[0], str):
            self.names = list(dict.fromkeys(values))
            values = [self.names.index(value) for value in values]
        self.values: FloatArray = np.array(values, dtype=np.float64)
        self.is_logarithmic = isinstance(factor.values, Range) and factor.values.logarithmic

    def set_axis(self, axes: Axes, which: str) -> None:
        """Label an axis, and set its scale or the names on it."""
        getattr(axes, f"set_{which}label")(self.label)
        if self.names:
            getattr(axes, f"set_{which}ticks")(range(len(self.names)), self.names)
        elif self.is_logarithmic:
            getattr(axes, f"set_{which}scale")("log")

    @property
    def norm(self) -> Normalize:
        """The colours of the values."""
        norm = LogNorm if self.is_logarithmic else Normalize
        return norm(self.values.min(), self.values.max())


def curves_figure(results: StudyResults) -> Figure:
    """Draw the curves of the last stage of all runs, in colours by the first factor."""
    first = _Scale(results, results.study.factors[0])
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 3.4), layout="constrained")
        axes = figure.add_subplot()
        colours = ScalarMappable(first.norm, FIELD_MAP)
        for value, outcome in zip(first.values, results.outcomes, strict=True):
            if outcome.lines:
                line = outcome.lines[-1]
                axes.plot(line.parameter, line.reaction, color=colours.to_rgba(value), linewidth=0.8)
                axes.set_xlabel(heading_of(line.names[0], line.units[0]))
                axes.set_ylabel(heading_of(line.names[1], line.units[1]))
        axes.margins(x=0)
        bar = figure.colorbar(colours, ax=axes, label=first.label)
        if first.names:
            bar.set_ticks(range(len(first.names)), labels=first.names)
        return figure


def output_figure(results: StudyResults, output: Output) -> Figure:
    """Draw an output: over one factor, as a map over two, and over each of more with its main effect."""
    groups = groups_of(results.study.factors)
    # factors that change together have one axis, that of the first of them
    scales = [_Scale(results, group[0]) for group in groups]
    if len(scales) == 1:
        return _line_figure(scales[0], output)
    if len(scales) == 2:
        return _map_figure(results, scales, output)
    return _effects_figure(scales, output)


def _line_figure(scale: _Scale, output: Output) -> Figure:
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 3.0), layout="constrained")
        axes = figure.add_subplot()
        order = np.argsort(scale.values, kind="stable")
        line = "none" if scale.names else "-"
        axes.plot(
            scale.values[order], output.values[order], linestyle=line, marker="o", markersize=4, color=BLUE
        )
        scale.set_axis(axes, "x")
        axes.set_ylabel(output.heading)
        return figure


def _map_figure(results: StudyResults, scales: Sequence[_Scale], output: Output) -> Figure:
    first, second = scales
    known = np.isfinite(output.values)
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 3.6), layout="constrained")
        axes = figure.add_subplot()
        is_grid = results.study.method == "grid" and min(len(set(scale.values)) for scale in scales) > 1
        if is_grid and known.all():
            x, y = (np.unique(scale.values) for scale in scales)
            table = np.empty((len(y), len(x)))
            table[np.searchsorted(y, second.values), np.searchsorted(x, first.values)] = output.values
            shown: Any = axes.contourf(x, y, table, levels=16, cmap=FIELD_MAP)
        shown_points = axes.scatter(
            first.values[known],
            second.values[known],
            c=output.values[known],
            cmap=FIELD_MAP,
            edgecolors="white",
            linewidths=0.5,
            s=24,
            clip_on=False,
            zorder=3,
        )
        if not (is_grid and known.all()):
            shown = shown_points
        axes.plot(first.values[~known], second.values[~known], "x", color=GREY, label="no value")
        if not known.all():
            axes.legend()
        first.set_axis(axes, "x")
        second.set_axis(axes, "y")
        if known.any():
            figure.colorbar(shown, ax=axes, label=output.heading)
        return figure


def _effects_figure(scales: Sequence[_Scale], output: Output) -> Figure:
    rows = -(-len(scales) // _MOST_PANELS)
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 2.6 * rows), layout="constrained")
        panels = figure.subplots(rows, _MOST_PANELS, sharey=True, squeeze=False).ravel()
        for axes, scale in zip(panels, scales, strict=False):
            axes.plot(scale.values, output.values, ".", color=BLUE, markersize=3, alpha=0.5)
            places, means = main_effect(scale.values, output.values, scale.is_logarithmic)
            axes.plot(places, means, color=VERMILION, marker="o", markersize=4)
            scale.set_axis(axes, "x")
        for axes in panels[len(scales) :]:
            axes.set_axis_off()
        panels[0].set_ylabel(output.heading)
        return figure


def main_effect(
    factor: FloatArray, output: FloatArray, logarithmic: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Return the values of a factor, and the mean output at each; runs without an output are left out.

    If a factor has more than a few values, they are the centres of equal parts of its range.
    """
    known = np.isfinite(output)
    factor, output = factor[known], output[known]
    levels, numbers = np.unique(factor, return_inverse=True)
    if len(levels) > _PARTS:
        along = np.log(factor) if logarithmic else factor
        edges = np.linspace(along.min(), along.max(), _PARTS + 1)
        numbers = np.clip(np.searchsorted(edges, along, side="right") - 1, 0, _PARTS - 1)
        centres = (edges[1:] + edges[:-1]) / 2
        levels = np.exp(centres) if logarithmic else centres
    counts = np.bincount(numbers, minlength=len(levels))
    sums = np.bincount(numbers, weights=output, minlength=len(levels))
    used = counts > 0
    return levels[used], sums[used] / counts[used]
