"""Tractions along the side that adheres, at states of a run."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from isopeel.assembly.spaces import SpaceOfBodies
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.post.figures.labels import rows_of, scaled_axis, shown_parameter
from isopeel.post.front import POINTS, FrontProfile, front_profile, process_zone
from isopeel.post.laboratory import Laboratory
from isopeel.post.states import adhering_names
from isopeel.post.style import SHADE, TWO_COLUMNS, line_style, style
from isopeel.problem import Problem
from isopeel.results.fields import StoredState

TENSION = "tension $-T$"
ALONG = "distance along the face"
#: What is shown of a front, seen from its peak, in lengths of the longest process zone.
_AROUND = 3.0
#: Share of the largest traction of all interfaces below which one is drawn as none.
_LEAST = 1e-3


def tractions_figure(
    problem: Problem, space: SpaceOfBodies, states: Sequence[StoredState], units: Laboratory | None = None
) -> Figure:
    """Draw the adhesive tension along the face of each interface for states, one interface below the other.

    Interfaces that do not adhere are left out where others do. Of a joint law it is the size of the traction
    of both modes, without pressure. On the left along all of the face, on the right the fronts laid over each
    other, each seen from its peak, where there is a front. Raises InputError where there are no states, or no
    interface.
    """
    if not states:
        raise InputError("states", [], "give one state at least")
    if not problem.interfaces:
        raise InputError("interfaces", 0, "tractions are those of an interface")
    names = adhering_names(problem)
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 3.2 * len(names)), layout="constrained")
        parts = rows_of(figure, [1.0] * len(names))
        labels = [shown_parameter(problem.drive.parameter_column, one.parameter, units) for one in states]
        found = {
            name: [
                front_profile(problem, space, one.displacement, POINTS, one.maximum_openings, name)
                for one in states
            ]
            for name in names
        }
        least = least_traction([profile for profiles in found.values() for profile in profiles])
        for part, (name, profiles) in zip(parts, found.items(), strict=True):
            _draw(part, profiles, labels, name if len(names) > 1 else "", least, units)
        entries = parts[0].axes[0].get_legend_handles_labels()
        figure.legend(*entries, loc="outside upper left", ncols=min(len(labels), 8))
        return figure


def _draw(
    figure: Figure | SubFigure,
    profiles: Sequence[FrontProfile],
    labels: Sequence[str],
    name: str,
    least: float,
    units: Laboratory | None,
) -> None:
    """Draw one interface, with its name where there are several."""
    zones = [process_zone(profile) for profile in profiles]
    longest = max((zone.length for zone in zones if zone is not None), default=None)
    panels = figure.subplots(1, 1 if longest is None else 2, sharey=True, squeeze=False)[0].tolist()
    for axes in panels:
        axes.axhline(0, color="black", linewidth=0.5, zorder=1)
    scaled_axis(panels[0].xaxis, ALONG, "length", units)
    largest = max(float(np.abs(profile.attraction).max()) for profile in profiles)
    words = TENSION if profiles[0].shear is None else "traction of both modes"
    scaled_axis(panels[0].yaxis, words, "stress", units, max(largest, least))
    if largest < least:
        panels[0].set_ylim(-least, least)
    for number, (profile, zone, label) in enumerate(zip(profiles, zones, labels, strict=True)):
        look = line_style(number) | {"label": label, "linewidth": 1.1}
        # the tension is that of positions, which do not jump between elements
        position, tension = profile.position.ravel(), profile.attraction.ravel()
        panels[0].plot(position, tension, **look)
        if zone is not None:
            panels[1].plot(position - zone.position, tension, **look)
    panels[0].margins(x=0)
    if longest is not None or name:
        title = f"{name}: all of the face" if name else "all of the face that adheres"
        panels[0].set_title(title, loc="left")
    if longest is not None:
        panels[1].set_title("the fronts, laid over each other", loc="left")
        panels[1].set_xlim(-_AROUND * longest, _AROUND * longest)
        scaled_axis(panels[1].xaxis, "distance from the peak", "length", units, longest)


def least_traction(profiles: Sequence[FrontProfile]) -> float:
    """Return the traction below which an interface is drawn as one without any, beside those of others."""
    return _LEAST * max(float(np.abs(profile.attraction).max()) for profile in profiles)


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
