"""The deformed bodies and the curve side by side, for each state of a run."""

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from isopeel.assembly.spaces import SpaceOfBodies
from isopeel.post.figures.body import FIELD_LABEL, draw_bodies, draw_substrates, mark_adhering
from isopeel.post.figures.labels import axis_label, plane_axes, shown_parameter
from isopeel.post.figures.reaction import draw_branches
from isopeel.post.laboratory import Laboratory
from isopeel.post.states import DrawnState, common_view, drawn_state, substrates
from isopeel.post.style import ORANGE, TWO_COLUMNS, style
from isopeel.problem import Problem
from isopeel.results.curve import Curve
from isopeel.results.fields import StoredState

Picture = np.ndarray[tuple[int, ...], np.dtype[np.uint8]]


class MovingFigure:
    """A picture of (width, height) pixels, drawn again for each state.

    The states are those of steps of the curve. Window and colours are the same for all states.
    """

    def __init__(
        self,
        problem: Problem,
        space: SpaceOfBodies,
        curve: Curve,
        states: Sequence[StoredState],
        size: tuple[int, int],
        units: Laboratory | None = None,
    ) -> None:
        self._problem, self._units = problem, units
        shown = curve if units is None else units.curve(curve)
        self._space, self._states = space, states
        window, self._scale = common_view(problem, space, states)
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
            draw_substrates(self._body, substrates(problem), window)
            draw_branches(curve_axes, shown)
            curve_axes.set_xlabel(axis_label(shown.parameter_column))
            curve_axes.set_ylabel(axis_label(shown.reaction_column))
            (self._marker,) = curve_axes.plot(
                [], [], "o", color=ORANGE, markeredgecolor="black", markersize=7, zorder=5
            )
            steps = [state.step for state in states]
            self._places = np.stack([shown.parameter[steps], shown.reaction[steps]])
            before = set(self._body.get_children())
            mesh = draw_bodies(self._body, self._state(0), self._scale, 1)
            self._drawn: list[Artist] = [one for one in self._body.get_children() if one not in before]
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
        return len(self._states)

    def _state(self, number: int) -> DrawnState:
        return drawn_state(self._problem, self._space, self._states[number])

    def picture(self, number: int) -> Picture:
        """Draw a state, by its number from zero: red, green and blue of pixels (height, width, 3)."""
        state = self._state(number)
        for artist in self._drawn:
            artist.remove()
        with style():
            before = set(self._body.get_children())
            draw_bodies(self._body, state, self._scale, 1)
            mark_adhering(self._body, state.faces.values(), 1.2, 3)
            self._drawn = [artist for artist in self._body.get_children() if artist not in before]
            at = shown_parameter(self._problem.drive.parameter_column, state.parameter, self._units)
            self._body.set_title(at, loc="left")
            self._marker.set_data(*self._places[:, number : number + 1])
            self._canvas.draw()  # type: ignore[no-untyped-call]
            pixels = np.asarray(self._canvas.buffer_rgba())  # type: ignore[no-untyped-call]
        return pixels[..., :3].copy()
