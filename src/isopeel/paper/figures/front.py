"""The adhesive stress at the peeling front, and the stress in the body, which balances it."""

from collections.abc import Mapping
from math import ceil, floor
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from isopeel.common.errors import InputError
from isopeel.common.units import E0
from isopeel.post.figures.tractions import broken, draw_length, shade_element
from isopeel.post.front import FrontProfile, ProcessZone, process_zone
from isopeel.post.style import TWO_COLUMNS, space_style, style

#: The interval of the side that is drawn, relative to the peak, in lengths of the process zone.
SHOWN = (-2.9, 2.4)
#: One E0 in megapascals.
MEGAPASCAL = float(E0) / 1e6


def front_figure(profiles: Mapping[str, FrontProfile], element_size: float) -> Figure:
    """Draw the tension at the front, that of the adhesion and that in the body, for several spaces.

    `profiles` are of one state, in E0 and L0, by the name of their space, from the coarsest to the finest.
    Distances are relative to the peak of the finest space. Its process zone is drawn beside an element, of
    `element_size` along the side. The panels below show differences: of the adhesion from that of the finest
    space, without the coarsest one; and of the body from the adhesion. Raises InputError for less than three
    profiles, or if the finest space has no front.
    """
    if len(profiles) < 3:
        raise InputError("profiles", list(profiles), "give three or more")
    coarsest, *_, last = profiles
    finest = profiles[last]
    zone = process_zone(finest)
    if zone is None:
        raise InputError("profiles", last, "its profile needs a front")
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 4.7), layout="constrained")
        grid = figure.subplots(2, 2, sharex=True, height_ratios=(2.2, 1))
        upper_left, upper_right, lower_left, lower_right = panels = grid.ravel().tolist()
        upper_right.sharey(upper_left)
        for name, profile in profiles.items():
            x, look = profile.position - zone.position, space_style(name).line
            adhesion, body = (
                -MEGAPASCAL * traction for traction in (profile.adhesive_traction, profile.body_traction)
            )
            upper_left.plot(*broken(x, adhesion), label=name, **look)
            upper_right.plot(*broken(x, body), **look)
            if name != coarsest:
                seen = np.interp(profile.position, finest.position.ravel(), finest.adhesive_traction.ravel())
                lower_left.plot(*broken(x, adhesion + MEGAPASCAL * seen), **look)
            lower_right.plot(*broken(x, body - adhesion), **look)
        titles = (
            "(a) of the adhesion, $-T$",
            r"(b) in the body, $-n_o \cdot P N$",
            f"(c) of the adhesion, less that of {last}, without {coarsest}",
            "(d) in the body, less that of the adhesion",
        )
        window = SHOWN[0] * zone.length, SHOWN[1] * zone.length
        for axes, title in zip(panels, titles, strict=True):
            axes.set_title(title, loc="left")
            axes.set_xlim(window)
            axes.axhline(0, color="black", linewidth=0.5, zorder=1)
            _shade_elements(axes, zone.position, window, element_size)
        upper_left.legend(loc="upper left")
        _dimensions(upper_left, zone, element_size)
        figure.supylabel("tension per reference area / MPa, for $E_0 = 2$ GPa", fontsize=9)
        figure.supxlabel(
            f"distance along the face from the peak of {last} / nm; to its right it is peeled off", fontsize=9
        )
        return figure


def _shade_elements(axes: Axes, origin: float, window: tuple[float, float], size: float) -> None:
    """Shade every other element."""
    first, end = (edge((origin + side) / size) for edge, side in zip((floor, ceil), window, strict=True))
    for element in range(first + first % 2, end, 2):
        start = element * size - origin
        shade_element(axes, start, start + size)


def _dimensions(axes: Axes, zone: ProcessZone, element_size: float) -> None:
    """Draw the length of the process zone at half the peak, and below it the element at the peak."""
    half = MEGAPASCAL * zone.peak / 2
    edge = floor(zone.position / element_size) * element_size - zone.position
    start, end = zone.start - zone.position, zone.end - zone.position
    for left, right, level in ((start, end, half), (edge, edge + element_size, half / 2)):
        draw_length(axes, left, right, level)
    right_of: dict[str, Any] = {"va": "center"}
    below: dict[str, Any] = {"ha": "center", "va": "top"}
    for words, place, offset, alignment in (
        (f"process zone\n{zone.length:.2f} nm", (end, half), (5, 0), right_of),
        (f"element\n{element_size:.3g} nm", (edge + element_size / 2, half / 2), (0, -3), below),
    ):
        axes.annotate(words, place, offset, textcoords="offset points", fontsize=8, **alignment)
