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
from isopeel.study.sobol import Share
from isopeel.study.table import Output, StudyResults, heading_of

#: Panels in one row.
_MOST_PANELS = 3
#: Letters on the axis of a panel.
_MOST_LETTERS = 26
#: Listed numbers with at least this ratio have a logarithmic axis.
_DECADES = 100.0
#: Parts of the range of a sampled factor whose means show its main effect.
_PARTS = 8


class _Scale:
    """The values of a factor as places on an axis: numbers, or one place for each name."""

    def __init__(self, results: StudyResults, factor: Factor) -> None:
        values = results.factor_values(factor)
        self.label = factor.heading
        self.names: list[str] = []
        if isinstance(values[0], str):
            order = [str(value) for value in factor.ends]
            self.names = sorted(set(values), key=order.index)
            values = [self.names.index(value) for value in values]
        self.values: FloatArray = np.array(values, dtype=np.float64)
        self.is_logarithmic = _is_logarithmic(factor, self.values)

    def set_axis(self, axes: Axes, which: str, *, narrow: bool = False) -> None:
        """Label an axis, and set its scale or the names on it; a long label of a narrow one has lines."""
        getattr(axes, f"set_{which}label")(_in_lines(self.label) if narrow else self.label)
        if self.names:
            getattr(axes, f"set_{which}ticks")(range(len(self.names)), self.names)
            getattr(axes, f"set_{which}lim")(-0.5, len(self.names) - 0.5)
            if which == "x" and sum(map(len, self.names)) > (_MOST_LETTERS if narrow else 3 * _MOST_LETTERS):
                axes.tick_params("x", labelrotation=90)
        elif self.is_logarithmic:
            getattr(axes, f"set_{which}scale")("log")

    @property
    def norm(self) -> Normalize:
        """The colours of the values."""
        norm = LogNorm if self.is_logarithmic else Normalize
        return norm(self.values.min(), self.values.max())

    @property
    def edges(self) -> FloatArray:
        """The edges of cells around the different values, in the middle between them on the axis."""
        along = np.log(np.unique(self.values)) if self.is_logarithmic else np.unique(self.values)
        middles = (along[1:] + along[:-1]) / 2
        edges = np.concatenate([[2 * along[0] - middles[0]], middles, [2 * along[-1] - middles[-1]]])
        return np.exp(edges) if self.is_logarithmic else edges


def _is_logarithmic(factor: Factor, values: FloatArray) -> bool:
    if isinstance(factor.values, Range):
        return factor.values.logarithmic
    return bool(
        factor.scale.unit is not None and values.min() > 0 and values.max() >= _DECADES * values.min()
    )


def _in_lines(label: str) -> str:
    """Return a label in lines that are as wide as a panel."""
    if len(label) <= _MOST_LETTERS:
        return label
    name, _, unit = label.partition(" [")
    table, dot, key = name.rpartition(".")
    lines = [name] if len(name) <= _MOST_LETTERS else [table + dot, key]
    return "\n".join([*lines, f"[{unit}"] if unit else lines)


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
    # factors that change together have one axis, that of the first of them
    scales = []
    for first, *others in groups_of(results.study.factors):
        scale = _Scale(results, first)
        if others:
            scale.label += f" (with {', '.join(factor.key for factor in others)})"
        scales.append(scale)
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
        if _mark_missing(axes, scale, output):
            _legend(axes)
        axes.set_ylabel(output.heading)
        return figure


def _map_figure(results: StudyResults, scales: Sequence[_Scale], output: Output) -> Figure:
    first, second = scales
    known = np.isfinite(output.values)
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 3.6), layout="constrained")
        axes = figure.add_subplot()
        x, y = (np.unique(scale.values) for scale in scales)
        shown: Any
        if results.study.method == "grid" and min(len(x), len(y)) > 1:
            table = np.empty((len(y), len(x)))
            table[np.searchsorted(y, second.values), np.searchsorted(x, first.values)] = output.values
            # between names, and beside a run without a value, there is nothing to interpolate
            if known.all() and not (first.names or second.names) and min(len(x), len(y)) > 2:
                shown = axes.contourf(x, y, table, levels=16, cmap=FIELD_MAP)
                axes.plot(first.values, second.values, ".", color="white", markersize=2, clip_on=False)
            else:
                shown = axes.pcolormesh(
                    first.edges, second.edges, np.ma.masked_invalid(table), cmap=FIELD_MAP
                )
        else:
            shown = axes.scatter(
                first.values[known], second.values[known], c=output.values[known], cmap=FIELD_MAP, s=24
            )
        first.set_axis(axes, "x")
        second.set_axis(axes, "y")
        if not known.all():
            axes.plot(first.values[~known], second.values[~known], "x", color=GREY, label="no value")
            _legend(axes)
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
            axes.plot(
                places,
                means,
                color=VERMILION,
                linestyle="none" if scale.names else "-",
                marker="o",
                markersize=4,
                label="mean",
            )
            scale.set_axis(axes, "x", narrow=True)
            _mark_missing(axes, scale, output)
        for axes in panels[len(scales) :]:
            axes.set_axis_off()
        for axes in panels[::_MOST_PANELS]:
            axes.set_ylabel(output.heading)
        _legend(panels[0])
        return figure


def shares_figure(shares: Sequence[Share]) -> Figure:
    """Draw the shares of the variance with their confidence intervals: alone, and with interactions."""
    places = np.arange(len(shares))[::-1]
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 0.8 + 0.5 * len(shares)), layout="constrained")
        axes = figure.add_subplot()
        for name, label, shift, colour in (
            ("first_order", "alone", 0.18, BLUE),
            ("total_order", "with interactions", -0.18, VERMILION),
        ):
            found = [getattr(share, name) for share in shares]
            axes.barh(places + shift, [one.value for one in found], 0.34, color=colour, label=label)
            for place, one in zip(places + shift, found, strict=True):
                axes.plot([one.low, one.high], [place, place], color="black", linewidth=1.0)
        axes.axvline(0.0, color=GREY, linewidth=0.6)
        axes.set_yticks(places, [share.name for share in shares])
        axes.set_xlabel("share of the variance")
        _legend(axes)
        return figure


def _mark_missing(axes: Axes, scale: _Scale, output: Output) -> bool:
    """Mark the runs without a value at the lower edge, and return whether there are any."""
    missing = scale.values[~np.isfinite(output.values)]
    if missing.size:
        below = axes.get_xaxis_transform()
        axes.plot(
            missing,
            np.zeros_like(missing),
            "x",
            color=GREY,
            transform=below,
            clip_on=False,
            label="no value",
        )
    return bool(missing.size)


def _legend(axes: Axes) -> None:
    """Draw the legend above the axes, where it hides no point."""
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, borderaxespad=0.2)


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
