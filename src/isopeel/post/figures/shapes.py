"""The deformed bodies along a run, and their delamination fronts."""

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from isopeel.assembly.spaces import SpaceOfBodies
from isopeel.common.errors import InputError
from isopeel.post.driven import driven_boundaries
from isopeel.post.figures.body import FIELD_LABEL, draw_bodies, draw_substrates, mark_adhering
from isopeel.post.figures.labels import of_interface, plane_axes, shown_parameter
from isopeel.post.laboratory import Laboratory
from isopeel.post.states import (
    DrawnState,
    drawn_state,
    front_names,
    front_window,
    hatched,
    stress_scale,
    substrates,
    whole_window,
)
from isopeel.post.style import DASHES, SHADE, TWO_COLUMNS, VERMILION, style
from isopeel.problem import Problem
from isopeel.results.fields import StoredState

MOST_SHAPES = 6

_CLOSEST_ENDS = 0.03  # of the largest extent: closer shapes and their labels would overlap


def shapes_figure(
    problem: Problem,
    space: SpaceOfBodies,
    states: Sequence[StoredState],
    units: Laboratory | None = None,
    *,
    every: bool = False,
) -> Figure:
    """Draw deformed shapes coloured by I1 = tr(sigma)/E, and below the delamination fronts of the last one.

    The states are in the order of the run. The last one is drawn, and up to MOST_SHAPES - 1 before it, evenly
    spread, whose driven ends are far enough apart to be distinguished; or `every` one. Each interface that
    adheres has a picture of its front; where none does, each has one of the contact. Lengths are in `units`,
    by default in L0. Raises InputError where there are no states, or maximum openings of an irreversible
    joint are missing.
    """
    if not states:
        raise InputError("states", [], "give one state at least")
    drawn = [
        drawn_state(problem, space, state) for state in (states if every else spread(states, MOST_SHAPES))
    ]
    drawn = drawn if every else _apart(drawn)
    last = drawn[-1]
    whole = whole_window(drawn)
    fronts = {name: front_window(problem, last, name) for name in front_names(problem)}
    adheres = any(face.adheres for face in last.faces.values())
    what, marked = ("front", "face that adheres") if adheres else ("contact", "face in contact")
    scale = stress_scale(drawn)
    with style():
        width = TWO_COLUMNS - 1.4  # without labels and colour bar
        windows = [whole, *fronts.values()]
        heights = [min(width / window.aspect, 4.5) for window in windows]
        # of titles, labels of axes and the legend
        around = 0.6 + 0.5 * len(windows)
        figure = Figure(figsize=(TWO_COLUMNS, sum(heights) + around), layout="constrained")
        panels = figure.subplots(len(windows), 1, height_ratios=heights, squeeze=False)[:, 0].tolist()
        for axes, window, name in zip(panels, windows, ["", *fronts], strict=True):
            axes.set(xlim=window.x, ylim=window.y, aspect="equal")
            plane_axes(axes, units)
            draw_substrates(axes, substrates(problem, name), window)
        upper, *lower = panels
        for order, state in enumerate(drawn, start=1):
            mesh = draw_bodies(upper, state, scale, order)
            mark_adhering(upper, state.faces.values(), 1.2, order + 0.4)
            _label_state(upper, problem, state, units)
        at_last = shown_parameter(problem.drive.parameter_column, last.parameter, units)
        for axes, (name, front) in zip(lower, fronts.items(), strict=True):
            corner, size = (front.x[0], front.y[0]), (np.ptp(front.x), np.ptp(front.y))
            upper.add_patch(Rectangle(corner, *size, fill=False, linewidth=0.8, linestyle=DASHES, zorder=9))
            draw_bodies(axes, last, scale, 1, elements=True)
            mark_adhering(axes, last.faces.values(), 1.8, 4)
            axes.set_title(f"{what}{of_interface(problem, name)} at {at_last}", loc="left")
        figure.colorbar(mesh, ax=panels, label=FIELD_LABEL, aspect=40, pad=0.02)
        handles: list[Artist] = [
            Line2D([], [], color=VERMILION, linewidth=1.5, label=marked),
            Line2D([], [], color="black", linewidth=0.8, linestyle=DASHES, label="enlarged below"),
        ]
        if words := hatched(problem):
            shaded = Patch(facecolor=SHADE, edgecolor="black", linewidth=0.5, hatch="/////", label=words)
            handles.insert(1, shaded)
        if fronts:
            figure.legend(handles=handles, loc="outside upper left", ncols=3)
        return figure


def spread(states: Sequence[StoredState], most: int) -> list[StoredState]:
    """Return at most so many of the states, spread evenly, in their order; the last one is included."""
    values = np.array([state.parameter for state in states])
    wanted = np.linspace(values[0], values[-1], most)
    nearest = np.unique(np.abs(values[:, None] - wanted).argmin(axis=0))
    return [states[number] for number in nearest.tolist()]


def _apart(states: list[DrawnState]) -> list[DrawnState]:
    """Return the last state, and those whose driven ends keep a distance from those of all later ones."""
    rest = [fields.reference_position.reshape(-1, 2) for fields in states[-1].bodies.values()]
    closest = _CLOSEST_ENDS * float(np.ptp(np.concatenate(rest), axis=0).max())
    kept: list[DrawnState] = []
    for state in reversed(states):
        if all(np.linalg.norm(state.driven[0, 1] - other.driven[0, 1]) > closest for other in kept):
            kept.insert(0, state)
    return kept


def _label_state(axes: Axes, problem: Problem, state: DrawnState, units: Laboratory | None) -> None:
    """Write the parameter next to the first driven side, on the outside."""
    side, ends = driven_boundaries(problem)[0].side, state.driven[0]
    along = ends[2] - ends[0]
    outwards = np.array([along[1], -along[0]]) / np.linalg.norm(along)
    outwards *= 1 if side in ("right", "bottom") else -1
    x, y = outwards
    # on the left there are the numbers of the axis
    above = x < -0.3
    axes.annotate(
        shown_parameter(problem.drive.parameter_column, state.parameter, units),
        max(ends, key=lambda end: float(end[1])) if above else ends[1],
        (0, 4) if above else 4 * outwards,  # in points
        textcoords="offset points",
        ha="left" if x > 0.3 or above else "center",
        va="bottom" if y > 0.7 or above else "top" if y < -0.7 else "center",
        fontsize=8,
        zorder=10,
    )
