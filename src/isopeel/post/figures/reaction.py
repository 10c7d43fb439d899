"""The reaction curve of a run, with its plateau enlarged."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from isopeel.common.arrays import FloatArray
from isopeel.post.closed_form import Expected
from isopeel.post.figures.labels import axis_label, mathematical, power_of_ten, scientific
from isopeel.post.plateau import PlateauReading
from isopeel.post.style import BLUE, DASHES, DOTS, GREY, ONE_COLUMN, SHADE, TWO_COLUMNS, style
from isopeel.results.curve import Curve
from isopeel.solve.step import KINDS


def reaction_figure(
    curve: Curve,
    plateau: PlateauReading | None = None,
    closed_form: Expected | None = None,
) -> Figure:
    """Draw the reaction over the drive's parameter, and in further panels the plateau, if one was read, and
    the widest snap-back of a curve that turns back.

    The closed form is drawn where the run reaches its onset of peeling.
    """
    with style():
        turn = widest_turn(curve)
        panels = 1 + (plateau is not None) + (turn is not None)
        width = ONE_COLUMN if panels == 1 else TWO_COLUMNS
        figure = Figure(figsize=(width, 2.6), layout="constrained")
        first, *others = figure.subplots(1, panels, squeeze=False)[0]
        _whole(first, curve, closed_form)
        if plateau:
            first.axvspan(*plateau.window, color=SHADE, linewidth=0)
            _enlarged(others[0], curve, plateau)
        if turn is not None:
            _turned(others[-1], curve, turn)
        return figure


def _whole(axes: Axes, curve: Curve, closed_form: Expected | None) -> None:
    _branches(axes, curve)
    axes.set_xlabel(axis_label(curve.parameter_column))
    axes.set_ylabel(axis_label(curve.reaction_column))
    last = curve.parameter[-1]
    axes.margins(x=0)
    if closed_form is None or not is_reached(closed_form, curve):
        return
    reaction, onset = closed_form.reaction, closed_form.onset
    degree = "°" if curve.parameter_column.unit == "degree" else ""
    axes.plot([curve.parameter[0], last], [reaction, reaction], color=GREY, linestyle=DASHES, linewidth=0.8)
    words = f"{closed_form.source} {reaction:.5g}"
    look: dict[str, Any] = {"textcoords": "offset points", "fontsize": 8, "color": GREY}
    if onset is None:
        # the curve falls to its steady value, or rises over a peak: below it there is space
        axes.annotate(words, (last, reaction), (-3, -4), ha="right", va="top", **look)
    else:
        # the curve rises from the lower left to the upper right, so that two corners are free for labels
        axes.annotate(words, (curve.parameter[0], reaction), (3, 3), **look)
        axes.plot([onset, onset], [0.0, reaction], color=GREY, linestyle=DASHES, linewidth=0.8)
        axes.annotate(f"onset {onset:.1f}{degree}", (onset, 0.0), (4, 3), **look)
    axes.set_ylim(min(0.0, curve.reaction.min()), 1.12 * max(reaction, curve.reaction.max()))


def is_reached(closed_form: Expected, curve: Curve) -> bool:
    """Return whether a curve reaches the range of the closed form, and can be compared with it."""
    # the curve of a path that turns back has no first and last parameter to draw the theory between
    turns_back = len(curve) > 1 and np.ptp(np.sign(np.diff(curve.parameter))) > 0
    return not turns_back and len(curve) > 0 and bool(curve.parameter[-1] >= (closed_form.onset or 0.0))


def widest_turn(curve: Curve) -> tuple[int, int] | None:
    """Return the steps of two limit points between which the parameter turns back the most, or None."""
    limits = np.flatnonzero(curve.kind == KINDS.index("limit point"))
    back = np.abs(np.diff(curve.parameter[limits]))
    # on a path that jumps, no part between two limit points is unstable
    back[curve.negative_eigenvalues[limits[:-1] + 1] < 1] = 0.0
    if not back.any():
        return None
    k = int(np.argmax(back))
    return int(limits[k]), int(limits[k + 1])


def _turned(axes: Axes, curve: Curve, turn: tuple[int, int]) -> None:
    """Draw a snap-back enlarged, with margins of its own width."""
    _branches(axes, curve)
    parameter, reaction = curve.parameter[list(turn)], curve.reaction[list(turn)]
    width = np.ptp(parameter)
    axes.set_xlim(parameter.min() - width, parameter.max() + width)
    axes.set_ylim(reaction.min() - 0.8 * np.ptp(reaction), reaction.max() + 0.5 * np.ptp(reaction))
    axes.set_xlabel(axis_label(curve.parameter_column))


def unstable_pieces(curve: Curve) -> NDArray[np.bool_]:
    """Return which pieces (n - 1,) between one step and the next are unstable."""
    unstable = curve.negative_eigenvalues > 0
    # a piece has the stability of its end that is not a limit point; a jump is not a piece
    pieces: NDArray[np.bool_] = np.where(
        curve.kind[1:] == KINDS.index("limit point"), unstable[:-1], unstable[1:]
    )
    return pieces


def draw_branches(axes: Axes, curve: Curve, **look: Any) -> None:
    """Draw stable states as a line, by default solid and blue, unstable ones dashed and thin, jumps dotted.

    Limit points and results of jumps are marked.
    """
    jump, limit = KINDS.index("jump"), KINDS.index("limit point")
    # a line through one step could not be seen
    look = {"color": BLUE, "linestyle": "-", "marker": "." if len(curve) == 1 else ""} | look
    unstable, jumps = unstable_pieces(curve), curve.kind[1:] == jump
    (line,) = axes.plot(*_pieces(curve, ~unstable & ~jumps), **look)
    thin: dict[str, Any] = {"color": line.get_color(), "linewidth": 0.6}
    if unstable.any():
        axes.plot(*_pieces(curve, unstable & ~jumps), linestyle=DASHES, label="unstable", **thin)
    if jumps.any():
        axes.plot(*_pieces(curve, jumps), linestyle=DOTS, **thin)
    for kind, marker, label in ((limit, "o", "limit points"), (jump, "v", "after a jump")):
        at = curve.kind == kind
        if at.any():
            axes.plot(curve.parameter[at], curve.reaction[at], marker, color=GREY, markersize=2, label=label)


def _pieces(curve: Curve, drawn: NDArray[np.bool_]) -> tuple[FloatArray, FloatArray]:
    """Return parameter and reaction of a line, with gaps where a piece (n - 1,) is not drawn."""
    breaks = np.flatnonzero(~drawn) + 1
    return np.insert(curve.parameter, breaks, np.nan), np.insert(curve.reaction, breaks, np.nan)


def _branches(axes: Axes, curve: Curve) -> None:
    draw_branches(axes, curve)
    if axes.get_legend_handles_labels()[1]:
        axes.legend(loc="lower right", fontsize=7)


def _enlarged(axes: Axes, curve: Curve, plateau: PlateauReading) -> None:
    start, end = plateau.window
    margin = 0.15 * (end - start)
    inside = (curve.parameter >= start - margin) & (curve.parameter <= end + margin)
    deviation = curve.reaction[inside] - plateau.mean
    exponent = power_of_ten(deviation, plateau.mean)
    deviation = deviation / 10.0**exponent
    axes.axvspan(start, end, color=SHADE, linewidth=0)
    drift = plateau.drift * (end - start) / 2 / 10.0**exponent
    axes.plot([start, end], [-drift, drift], color=GREY, linestyle=DASHES, linewidth=0.8)
    axes.plot(curve.parameter[inside], deviation, color=BLUE, marker=".", markersize=3)
    low, high = deviation.min(), deviation.max()
    axes.set_xlim(start - margin, end + margin)
    axes.set_ylim(low - 0.08 * (high - low), high + 0.5 * (high - low))  # with room for the text
    axes.set_xlabel(axis_label(curve.parameter_column))
    unit = mathematical(curve.reaction_column.unit)
    axes.set_ylabel(f"deviation / $10^{{{exponent}}}$ {unit}")
    rise, fall = scientific(plateau.steepest_rise), scientific(plateau.steepest_fall)
    unit = curve.parameter_column.unit
    text = (
        f"mean {plateau.mean:.6g}, amplitude {scientific(plateau.amplitude)}\n"
        f"slopes {rise}, {fall} per {unit}\n"
        f"subtracted drift {scientific(plateau.drift)} per {unit}"
    )
    axes.text(0.03, 0.97, text, transform=axes.transAxes, va="top", fontsize=8, linespacing=1.4)
