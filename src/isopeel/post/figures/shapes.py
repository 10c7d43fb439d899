"""The deformed body along a run, and its delamination front."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.post.figures.body import (
    FIELD_LABEL,
    draw_elements,
    draw_field,
    draw_outline,
    draw_substrate,
    mark_adhering,
)
from isopeel.post.figures.labels import plane_axes, shown_parameter
from isopeel.post.laboratory import Laboratory
from isopeel.post.states import BodyState, adheres_to, body_state, front_window, stress_scale, whole_window
from isopeel.post.style import DASHES, SHADE, TWO_COLUMNS, VERMILION, style
from isopeel.problem import Problem
from isopeel.splines.rows import RowSpace

MOST_SHAPES = 6

_CLOSEST_ENDS = 0.03  # of the largest extent: closer shapes and their labels would overlap


def shapes_figure(
    problem: Problem,
    space: RowSpace,
    fields: Mapping[float, FloatArray],
    units: Laboratory | None = None,
    at: Sequence[float] = (),
    maximum_openings: Mapping[float, FloatArray] | None = None,
) -> Figure:
    """Draw deformed shapes coloured by I1 = tr(sigma)/E, and below the delamination front of the last one.

    `fields` maps values of the drive's parameter, in the unit of its column, to displacement coefficients
    (size, 2), in the order of the run. The last one is drawn, and up to MOST_SHAPES - 1 before it, evenly
    spread, whose driven ends are far enough apart to be distinguished; or all states `at` given parameters.
    Lengths are in `units`, by default in L0. An irreversible joint needs its
    `maximum_openings` in each state. Raises InputError where there are no fields, or openings are
    missing.
    """
    if not fields:
        raise InputError("fields", dict(fields), "give the displacement of at least one state")
    shown = at or spread(list(fields), MOST_SHAPES)
    history = maximum_openings or {}
    states = [
        body_state(problem, space, value, fields[value], maximum_openings=history.get(value))
        for value in shown
    ]
    states = states if at else _apart(states)
    last = states[-1]
    whole, front = whole_window(states), front_window(problem, last)
    scale = stress_scale(states)
    with style():
        width = TWO_COLUMNS - 1.4  # without labels and colour bar
        heights = [min(width / window.aspect, 4.5) for window in (whole, front)]
        figure = Figure(figsize=(TWO_COLUMNS, sum(heights) + 1.6), layout="constrained")
        upper, lower = figure.subplots(2, 1, height_ratios=heights)
        for axes, window in ((upper, whole), (lower, front)):
            axes.set(xlim=window.x, ylim=window.y, aspect="equal")
            plane_axes(axes, units)
            draw_substrate(axes, problem.adhesion.substrate, window)
        for order, state in enumerate(states, start=1):
            draw_field(upper, state.fields, scale, order)
            draw_outline(upper, state.fields, order + 0.2)
            mark_adhering(upper, state, 1.2, order + 0.4)
            _label_state(upper, problem, state, units)
        corner, size = (front.x[0], front.y[0]), (np.ptp(front.x), np.ptp(front.y))
        upper.add_patch(Rectangle(corner, *size, fill=False, linewidth=0.8, linestyle=DASHES, zorder=9))
        mesh = draw_field(lower, last.fields, scale, 1)
        draw_elements(lower, last.fields, 2)
        draw_outline(lower, last.fields, 3)
        mark_adhering(lower, last, 1.8, 4)
        at_last = shown_parameter(problem.drive.parameter_column, last.parameter, units)
        lower.set_title(f"front at {at_last}", loc="left")
        figure.colorbar(mesh, ax=[upper, lower], label=FIELD_LABEL, aspect=40, pad=0.02)
        handles = [
            Line2D([], [], color=VERMILION, linewidth=1.5, label="face that adheres"),
            Patch(
                facecolor=SHADE, edgecolor="black", linewidth=0.5, hatch="/////", label=adheres_to(problem)
            ),
            Line2D([], [], color="black", linewidth=0.8, linestyle=DASHES, label="enlarged below"),
        ]
        figure.legend(handles=handles, loc="outside upper left", ncols=3)
        return figure


def spread(parameters: Sequence[float], most: int) -> list[float]:
    """Return at most so many of the values, spread evenly, in their order; the last one is included."""
    values = np.array(parameters)
    wanted = np.linspace(values[0], values[-1], most)
    nearest = np.unique(np.abs(values[:, None] - wanted).argmin(axis=0))
    return [float(value) for value in values[nearest]]


def _apart(states: list[BodyState]) -> list[BodyState]:
    """Return the last state, and those whose driven ends keep a distance from those of all later ones."""
    closest = _CLOSEST_ENDS * float(np.ptp(states[-1].fields.reference_position.reshape(-1, 2), axis=0).max())
    kept: list[BodyState] = []
    for state in reversed(states):
        if all(np.linalg.norm(state.driven[1] - other.driven[1]) > closest for other in kept):
            kept.insert(0, state)
    return kept


def _label_state(axes: Axes, problem: Problem, state: BodyState, units: Laboratory | None) -> None:
    """Write the parameter next to the driven side, on the outside."""
    side = problem.drive.side
    along = state.driven[2] - state.driven[0]
    outwards = np.array([along[1], -along[0]]) / np.linalg.norm(along)
    outwards *= 1 if side in ("right", "bottom") else -1
    x, y = outwards
    axes.annotate(
        shown_parameter(problem.drive.parameter_column, state.parameter, units),
        state.driven[1],
        4 * outwards,  # in points
        textcoords="offset points",
        ha="left" if x > 0.3 else "right" if x < -0.3 else "center",
        va="bottom" if y > 0.7 else "top" if y < -0.7 else "center",
        fontsize=8,
        zorder=10,
    )
