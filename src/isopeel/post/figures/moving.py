"""The deformed body and the curve side by side, for each state of a run."""

from collections.abc import Mapping

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from isopeel.common.arrays import FloatArray
from isopeel.post.figures.body import FIELD_LABEL, draw_field, draw_outline, draw_substrate, mark_adhering
from isopeel.post.figures.labels import axis_label, plane_axes, shown_parameter
from isopeel.post.figures.reaction import draw_branches
from isopeel.post.laboratory import Laboratory
from isopeel.post.states import BodyState, body_state, common_view
from isopeel.post.style import ORANGE, TWO_COLUMNS, style
from isopeel.problem import Problem
from isopeel.results.curve import Curve
from isopeel.splines.rows import RowSpace

Picture = np.ndarray[tuple[int, ...], np.dtype[np.uint8]]


class MovingFigure:
    """A picture of (width, height) pixels, drawn again for each state.

    `fields` maps values of the drive's parameter, in the unit of its column, to displacement coefficients
    (size, 2), and `maximum_openings` to those of an irreversible joint. Window and colours
    are the same for all states.
    """

    def __init__(
        self,
        problem: Problem,
        space: RowSpace,
        curve: Curve,
        fields: Mapping[float, FloatArray],
        size: tuple[int, int],
        units: Laboratory | None = None,
        maximum_openings: Mapping[float, FloatArray] | None = None,
    ) -> None:
        self._problem, self._units = problem, units
        self._maximum_openings = maximum_openings or {}
        shown = curve if units is None else units.curve(curve)
        self._space, self._fields = space, fields
        self._parameters = list(fields)
        window, self._scale = common_view(problem, space, fields, maximum_openings)
        width, height = size
        with style():
            # letters have the size that they have on paper; the tiny addition makes the pixel sizes exact
            inches = TWO_COLUMNS, TWO_COLUMNS * height / width
            dots = (width + 1e-6) / TWO_COLUMNS
            self._figure = Figure(figsize=inches, dpi=dots, layout="constrained")
            self._canvas = FigureCanvasAgg(self._figure)
            self._body, curve_axes = self._figure.subplots(1, 2, width_ratios=(1.5, 1))
            self._body.set(xlim=window.x, ylim=window.y)
            plane_axes(self._body, units)
            self._body.set_aspect("equal")
            draw_substrate(self._body, problem.adhesion.substrate, window)
            draw_branches(curve_axes, shown)
            curve_axes.set_xlabel(axis_label(shown.parameter_column))
            curve_axes.set_ylabel(axis_label(shown.reaction_column))
            (self._marker,) = curve_axes.plot(
                [], [], "o", color=ORANGE, markeredgecolor="black", markersize=7, zorder=5
            )
            self._places = _places(curve, shown, self._parameters)
            mesh = draw_field(self._body, self._state(0).fields, self._scale, 1)
            self._drawn: list[Artist] = [mesh]
            self._figure.colorbar(
                mesh, ax=self._body, label=FIELD_LABEL, location="bottom", aspect=40, pad=0.02
            )
            # the layout is computed once, with a title: with a new layout for each state, pictures would
            # jitter
            self._body.set_title("0", loc="left")
            for _ in range(2):
                self._canvas.draw()  # type: ignore[no-untyped-call]
            self._figure.set_layout_engine("none")

    def __len__(self) -> int:
        """Number of states."""
        return len(self._parameters)

    def _state(self, number: int) -> BodyState:
        parameter = self._parameters[number]
        maximum_openings = self._maximum_openings.get(parameter)
        return body_state(
            self._problem, self._space, parameter, self._fields[parameter], maximum_openings=maximum_openings
        )

    def picture(self, number: int) -> Picture:
        """Draw a state, by its number from zero: red, green and blue of pixels (height, width, 3)."""
        state = self._state(number)
        for artist in self._drawn:
            artist.remove()
        with style():
            before = set(self._body.get_children())
            draw_field(self._body, state.fields, self._scale, 1)
            draw_outline(self._body, state.fields, 2)
            mark_adhering(self._body, state, 1.2, 3)
            self._drawn = [artist for artist in self._body.get_children() if artist not in before]
            at = shown_parameter(self._problem.drive.parameter_column, state.parameter, self._units)
            self._body.set_title(at, loc="left")
            self._marker.set_data(*self._places[:, number : number + 1])
            self._canvas.draw()  # type: ignore[no-untyped-call]
            pixels = np.asarray(self._canvas.buffer_rgba())  # type: ignore[no-untyped-call]
        return pixels[..., :3].copy()


def _places(curve: Curve, shown: Curve, parameters: list[float]) -> FloatArray:
    """Return the places (2, states) of states on a curve.

    Where the curve meets a parameter more than once, the stored state is the last one.
    """
    last = len(curve) - 1
    steps = [last - int(np.abs(curve.parameter[::-1] - value).argmin()) for value in parameters]
    return np.stack([shown.parameter[steps], shown.reaction[steps]])
