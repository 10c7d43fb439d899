"""Tractions along the side that adheres, at states of a run."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.post.figures.labels import scaled_axis, shown_parameter
from isopeel.post.front import FrontProfile, process_zone
from isopeel.post.laboratory import Laboratory
from isopeel.post.style import SHADE, TWO_COLUMNS, line_style, style
from isopeel.problem import Column

TENSION = "tension $-T$"
ALONG = "distance along the face"
#: What is shown of a front, seen from its peak, in lengths of the longest process zone.
_AROUND = 3.0


def tractions_figure(
    profiles: Mapping[float, FrontProfile], column: Column, units: Laboratory | None = None
) -> Figure:
    """Draw the adhesive tension along the face for states, by their parameter in the unit of a column.

    On the left along all of it, on the right the fronts laid over each other, each seen from its peak, where
    there is a front. Raises InputError where there are no states.
    """
    if not profiles:
        raise InputError("profiles", dict(profiles), "give one state at least")
    zones = {value: process_zone(profile) for value, profile in profiles.items()}
    longest = max((zone.length for zone in zones.values() if zone is not None), default=None)
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 3.2), layout="constrained")
        panels = figure.subplots(1, 1 if longest is None else 2, sharey=True, squeeze=False)[0].tolist()
        for axes in panels:
            axes.axhline(0, color="black", linewidth=0.5, zorder=1)
        scaled_axis(panels[0].xaxis, ALONG, "length", units)
        largest = max(float(np.abs(profile.adhesive_traction).max()) for profile in profiles.values())
        scaled_axis(panels[0].yaxis, TENSION, "stress", units, largest)
        for number, (value, profile) in enumerate(profiles.items()):
            look = line_style(number) | {"label": shown_parameter(column, value, units), "linewidth": 1.1}
            # the tension is that of positions, which do not jump between elements
            position, tension = profile.position.ravel(), -profile.adhesive_traction.ravel()
            panels[0].plot(position, tension, **look)
            zone = zones[value]
            if zone is not None:
                panels[1].plot(position - zone.position, tension, **look)
        panels[0].margins(x=0)
        if longest is not None:
            panels[0].set_title("all of the face that adheres", loc="left")
            panels[1].set_title("the fronts, laid over each other", loc="left")
            panels[1].set_xlim(-_AROUND * longest, _AROUND * longest)
            scaled_axis(panels[1].xaxis, "distance from the peak", "length", units, longest)
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper left", ncols=min(len(labels), 8))
        return figure


def broken(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return lines of values (n, k) with a gap after each of n elements, so that jumps are not joined."""
    ends = np.full((len(x), 1), np.nan)
    return np.hstack([x, ends]).ravel(), np.hstack([y, ends]).ravel()


def shade_element(axes: Axes, start: float, end: float) -> None:
    """Shade one of the elements along a face, such as every other one."""
    axes.axvspan(start, end, color=SHADE, linewidth=0, zorder=0)


def draw_length(axes: Axes, start: float, end: float, level: float) -> None:
    """Draw a length as an arrow with two heads."""
    arrow = {"arrowstyle": "<->", "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (start, level), (end, level), arrowprops=arrow)
