"""The peeling fronts of one state: stress, adhesive forces, and tractions in the body."""

from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure, SubFigure
from numpy.typing import NDArray

from isopeel.assembly.spaces import SpaceOfBodies
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.post.figures.body import FIELD_LABEL, draw_bodies, draw_substrates, mark_adhering
from isopeel.post.figures.labels import of_interface, plane_axes, rows_of, scaled_axis, shown_parameter
from isopeel.post.figures.tractions import ALONG, broken, draw_length, least_traction, shade_element
from isopeel.post.front import POINTS, FrontProfile, ProcessZone, front_profile, process_zone
from isopeel.post.laboratory import Laboratory
from isopeel.post.states import DrawnState, Window, adhering_names, drawn_state, front_window, substrates
from isopeel.post.style import BLUE, GREEN, ORANGE, TWO_COLUMNS, style
from isopeel.problem import Problem
from isopeel.results.fields import StoredState

_LONGEST_ARROW = 0.3  # of the height of the window
_ARROWS = 80  # across the window, at most
_ROOM = 0.25  # of the width of the curves, for the label of a process zone
_MARGIN = 0.25  # of a process zone that is wider than the window, beside it


def front_figure(
    problem: Problem, space: SpaceOfBodies, state: StoredState, units: Laboratory | None = None
) -> Figure:
    """Draw the front on each interface that adheres in a state, one below the other; on all if none does.

    The upper panel has the body with I1 on its elements, and arrows for the adhesive force. The lower panel
    has, along the same part of the face, the tension of the adhesion and that in the body, which are equal in
    equilibrium, the traction along the faces if there is a joint law, and the length of the process zone, if
    there is a front. Every other element is shaded. Raises InputError where there is no interface, or maximum
    openings of an irreversible joint are missing.
    """
    if not problem.interfaces:
        raise InputError("interfaces", 0, "a front is that of an interface")
    drawn, openings = drawn_state(problem, space, state), state.maximum_openings
    profiles = {
        name: front_profile(problem, space, state.displacement, POINTS, openings, name)
        for name in adhering_names(problem)
    }
    least = least_traction(list(profiles.values()))
    views = {name: _View.of(problem, drawn, name, profile, least) for name, profile in profiles.items()}
    scale = max(view.scale for view in views.values())
    with style():
        heights = [view.height + 3.3 for view in views.values()]
        figure = Figure(figsize=(TWO_COLUMNS, sum(heights)), layout="constrained")
        parts = rows_of(figure, heights)
        for part, (name, view) in zip(parts, views.items(), strict=True):
            at = shown_parameter(problem.drive.parameter_column, state.parameter, units)
            word = "front" if problem.interface_of(name).adheres else "contact"
            title = f"{word}{of_interface(problem, name)} at {at}"
            _draw(part, problem, drawn, replace(view, scale=scale), title, units)
        return figure


@dataclass(frozen=True, eq=False)
class _View:
    """What is seen of the front on an interface."""

    name: str
    profile: FrontProfile
    window: Window
    arrows: FloatArray
    seen: tuple[float, float]  # of the face
    scale: float  # of I1
    least: float  # traction that is seen

    @classmethod
    def of(cls, problem: Problem, drawn: DrawnState, name: str, profile: FrontProfile, least: float) -> Self:
        fields = drawn.bodies[problem.interface_of(name).boundary.body]
        zone = process_zone(profile)
        window = front_window(problem, drawn, name)
        if zone is not None:
            window = _widened(window, profile, zone)
        arrows = _arrows(profile, window, least)
        window = _fitted(window, arrows, fields.position)
        seen = _seen(profile, window)
        if zone is not None:
            seen = min(seen[0], zone.start), max(seen[1], zone.end)
        # of the visible parts: stresses far from the front would dominate
        stresses = [one.first_invariant[_inside(one.position, window)] for one in drawn.bodies.values()]
        scale = max(1e-6, *(float(np.nanmax(np.abs(one), initial=0.0)) for one in stresses))
        return cls(name, profile, window, arrows, seen, scale, least)

    @property
    def height(self) -> float:
        """Of the picture, without labels, in inches."""
        return min((TWO_COLUMNS - 1.4) / self.window.aspect, 4.5)


def _draw(
    figure: Figure | SubFigure,
    problem: Problem,
    state: DrawnState,
    view: _View,
    title: str,
    units: Laboratory | None,
) -> None:
    window = view.window
    upper, lower = figure.subplots(2, 1, height_ratios=(view.height, 1.9))
    upper.set(xlim=window.x, ylim=window.y, aspect="equal")
    plane_axes(upper, units)
    draw_substrates(upper, substrates(problem, view.name), window)
    mesh = draw_bodies(upper, state, view.scale, 1, elements=True)
    mark_adhering(upper, state.faces.values(), 1.8, 4)
    shafts = LineCollection(list(_evenly(view.arrows, window)), colors=BLUE, linewidths=0.7, zorder=3.5)
    upper.add_collection(shafts, autolim=False)
    upper.plot(*view.arrows[:, 1].T, color=BLUE, linewidth=1.0, zorder=3.5)
    upper.set_title(f"{title}: $I_1$ of the body, and the force of the adhesion on it", loc="left")
    figure.colorbar(mesh, ax=upper, label=FIELD_LABEL, aspect=20, pad=0.02)
    _draw_tensions(lower, view, units)


def _arrows(profile: FrontProfile, window: Window, least: float) -> FloatArray:
    """Return the forces on the face in a window as arrows (n, 2, 2), from the face to the tip."""
    places, normals = profile.deformed.reshape(-1, 2), profile.normal.reshape(-1, 2)
    inside = _inside(places, window)
    start, forces = places[inside], profile.adhesive_traction.reshape(-1, 1)[inside] * normals[inside]
    if profile.shear is not None:
        along = np.stack([normals[:, 1], -normals[:, 0]], axis=1)
        forces += profile.shear.reshape(-1, 1)[inside] * along[inside]
    largest = np.linalg.norm(forces, axis=1).max(initial=max(least, 1e-300))
    size = _LONGEST_ARROW * float(np.ptp(window.y)) / largest
    return np.stack([start, start + size * forces], axis=1)


def _evenly(arrows: FloatArray, window: Window) -> FloatArray:
    """Return those of many arrows along a face that are far enough apart to be distinguished."""
    steps = np.linalg.norm(np.diff(arrows[:, 0], axis=0), axis=1)
    number = np.floor(np.cumsum(np.append(0.0, steps)) * _ARROWS / float(np.ptp(window.x)))
    kept: FloatArray = arrows[np.flatnonzero(np.diff(number, prepend=-1.0))]
    return kept


def _widened(window: Window, profile: FrontProfile, zone: ProcessZone) -> Window:
    """Return a window that contains the whole process zone with a margin; for a thin body it is long."""
    inside = (profile.position >= zone.start) & (profile.position <= zone.end)
    places = profile.deformed[inside]
    if not len(places):
        return window
    margin = _MARGIN * zone.length
    low, high = places.min(axis=0) - margin, places.max(axis=0) + margin
    x, y = (
        (min(start, float(low[k])), max(end, float(high[k])))
        for k, (start, end) in enumerate((window.x, window.y))
    )
    return Window(x, y)


def _fitted(window: Window, arrows: FloatArray, body: FloatArray) -> Window:
    """Return a window that also contains all arrows, and little outside of a body (..., 2)."""
    margin = 0.1 * float(np.ptp(window.y))
    ends = []
    for k, (low, high) in enumerate((window.x, window.y)):
        tips = arrows[:, 1, k]
        low = min(max(low, float(body[..., k].min()) - margin), float(tips.min(initial=high)) - margin / 4)
        high = max(min(high, float(body[..., k].max()) + margin), float(tips.max(initial=low)) + margin / 4)
        ends.append((low, high))
    return Window(*ends)


def _inside(places: FloatArray, window: Window) -> NDArray[np.bool_]:
    low, high = np.transpose([window.x, window.y])
    inside: NDArray[np.bool_] = ((places >= low) & (places <= high)).all(axis=-1)
    return inside


def _seen(profile: FrontProfile, window: Window) -> tuple[float, float]:
    """Return the part of the face, (from, to) along it, that is about what a window shows."""
    places, x = profile.deformed.reshape(-1, 2), profile.position.ravel()
    centre = np.mean([window.x, window.y], axis=1)
    middle = float(x[np.linalg.norm(places - centre, axis=1).argmin()])
    reach = float(np.ptp(window.x)) / 2
    return max(middle - reach, float(x[0])), min(middle + reach, float(x[-1]))


def _draw_tensions(axes: Axes, view: _View, units: Laboratory | None) -> None:
    profile, seen = view.profile, view.seen
    x = profile.position
    axes.axhline(0, color="black", linewidth=0.5, zorder=1)
    curves = [
        (profile.adhesive_traction, BLUE, 1.1, "of the adhesion, $-T$"),
        (profile.body_traction, ORANGE, 2.2, r"in the body, $-n_o \cdot P N$"),
    ]
    if profile.shear is not None:
        curves.append((-profile.shear, GREEN, 1.1, "along the joint, $t$"))
    for order, (traction, color, width, label) in enumerate(curves):
        look: dict[str, Any] = {"color": color, "linewidth": width, "label": label, "zorder": 3 - order / 2}
        axes.plot(*broken(x, -traction), **look)
    for start, end in x[::2, [0, -1]].tolist():
        if start < seen[1] and end > seen[0]:
            shade_element(axes, start, end)
    zone = process_zone(profile)
    if zone is not None and seen[0] <= zone.start and zone.end <= seen[1]:
        draw_length(axes, zone.start, zone.end, zone.peak / 2)
        # beside the arrow, on the left where there is no room on the right, and above where there is none
        room = _ROOM * (seen[1] - seen[0])
        right, left = seen[1] - zone.end > room, zone.start - seen[0] > room
        axes.annotate(
            f"process zone {units.text(zone.length, 'length', 3) if units else f'{zone.length:.3g} $L_0$'}",
            (zone.end if right else zone.start if left else (zone.start + zone.end) / 2, zone.peak / 2),
            (5, 0) if right else (-5, 0) if left else (0, 3),
            textcoords="offset points",
            ha="left" if right else "right" if left else "center",
            va="center" if right or left else "bottom",
            fontsize=8,
        )
    inside = (x >= seen[0]) & (x <= seen[1])
    values = np.concatenate([-traction[inside] for traction, *_ in curves])
    low, high = float(np.nanmin(values, initial=0.0)), float(np.nanmax(values, initial=0.0))
    if max(-low, high) < view.least:
        low, high = -view.least, view.least
    room = 0.08 * (high - low or 1.0)
    axes.set(xlim=seen, ylim=(low - room, high + room))
    scaled_axis(axes.xaxis, ALONG, "length", units)
    scaled_axis(axes.yaxis, "tension", "stress", units, max(-low, high))
    axes.set_title("tension per reference area; every other element is shaded", loc="left")
    axes.legend(loc="best")
