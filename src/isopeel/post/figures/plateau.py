"""The window of a curve from which its plateau, its amplitude and its slopes are read."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from isopeel.post.figures.labels import axis_label, mathematical, power_of_ten, scientific
from isopeel.post.plateau import Oscillation, PlateauReading, oscillation
from isopeel.post.style import BLUE, DASHES, GREY, SHADE, TWO_COLUMNS, VERMILION, style
from isopeel.results.curve import Curve


def plateau_figure(curve: Curve, plateau: PlateauReading, period: float | None = None) -> Figure:
    """Draw the reaction around the window, and its oscillation in the window without mean and drift.

    The steepest steps and the amplitude are marked, as they were read with the same `period`.
    """
    read = oscillation(curve, plateau, period)
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 3.0), layout="constrained")
        left, right = figure.subplots(1, 2)
        _draw_window(left, curve, plateau, read)
        _draw_oscillation(right, curve, plateau, read, period)
        return figure


def _draw_window(axes: Axes, curve: Curve, plateau: PlateauReading, read: Oscillation) -> None:
    start, end = plateau.window
    margin = end - start
    around = (curve.parameter >= start - margin) & (curve.parameter <= end + margin)
    axes.axvspan(start, end, color=SHADE, linewidth=0)
    axes.plot(curve.parameter[around], curve.reaction[around], color=BLUE, linewidth=1.1)
    drift = plateau.mean + read.drift
    axes.plot(read.parameter, drift, color=VERMILION, linestyle=DASHES, linewidth=1.0, label="drift")
    axes.axhline(plateau.mean, color=GREY, linewidth=0.8, label=f"mean {plateau.mean:.6g}")
    axes.margins(x=0)
    axes.set_xlabel(axis_label(curve.parameter_column))
    axes.set_ylabel(axis_label(curve.reaction_column))
    axes.set_title("around the window", loc="left")
    axes.legend(loc="best")


def _draw_oscillation(
    axes: Axes, curve: Curve, plateau: PlateauReading, read: Oscillation, period: float | None
) -> None:
    values = read.values
    exponent = power_of_ten(values, plateau.mean)
    scaled = values / 10.0**exponent
    slopes = np.diff(values) / np.diff(read.parameter)
    axes.axhline(0, color=GREY, linewidth=0.6)
    axes.plot(read.parameter, scaled, color=BLUE, marker=".", markersize=3, linewidth=1.1)
    unit = curve.parameter_column.unit
    for step, word in ((int(slopes.argmax()), "rise"), (int(slopes.argmin()), "fall")):
        label = f"steepest {word} {scientific(float(slopes[step]))} per {unit}"
        look: dict[str, Any] = {"linewidth": 3.0, "color": VERMILION if word == "rise" else "black"}
        axes.plot(read.parameter[step : step + 2], scaled[step : step + 2], label=label, **look)
    low, high = float(scaled.min()), float(scaled.max())
    start, end = plateau.window
    for level in (low, high):
        axes.axhline(level, color=GREY, linestyle=DASHES, linewidth=0.6)
    arrow = {"arrowstyle": "<->", "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (end, low), (end, high), arrowprops=arrow, annotation_clip=False)
    axes.plot([], [], " ", label=f"amplitude {scientific(plateau.amplitude)}")
    if period is not None:
        axes.plot([], [], " ", label=f"period of the elements {period:.4g} {unit}")
    axes.set_xlim(start, end)
    axes.set_ylim(low - 0.05 * (high - low), high + 0.75 * (high - low))  # with room for the words
    axes.set_xlabel(axis_label(curve.parameter_column))
    axes.set_ylabel(f"deviation / $10^{{{exponent}}}$ {mathematical(curve.reaction_column.unit)}")
    axes.set_title("in the window, without mean and drift", loc="left")
    axes.legend(loc="upper left", handlelength=1.5)
