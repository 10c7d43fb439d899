"""Show a stored run in a window: the deformed bodies, with a slider over its states."""

import os
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import matplotlib as mpl
import numpy as np
from PIL import Image
from PIL.PngImagePlugin import PngInfo
from rich.console import Console

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.output.selection import chosen_states, shown_stage
from isopeel.physics.batch import evaluate_substrate
from isopeel.physics.substrates import Substrate
from isopeel.post.fields import SampledFields
from isopeel.post.states import DrawnState, Window, common_view, drawn_state, substrates
from isopeel.post.style import FIELD_MAP, SHADE, VERMILION
from isopeel.results.files import MAKER, replacing
from isopeel.running.folder import check_overwritten, make_folder
from isopeel.running.run_reader import StoredStage

_SIZE = (1280, 720)  # pixels
#: Metadata with the maker of a picture, as in those of matplotlib.
_MARK = PngInfo()
_MARK.add_text("Creator", MAKER)
_FIELD = "I1 = tr(sigma)/E"
#: Place of the colour bar: on the right, above the units.
_BAR = {
    "title": f"{_FIELD}\n ",
    "vertical": True,
    "position_x": 0.88,
    "position_y": 0.3,
    "height": 0.6,
    "title_font_size": 18,
    "label_font_size": 16,
    "fmt": "%.3g",
    "color": "black",
}


def view_run(
    folder: Path, at: str | None, screenshot: Path | None, console: Console, *, force: bool = False
) -> None:
    """Show the stored states of one stage in a window, until the window is closed.

    The window begins with the state `at` a parameter, by default with the last state. With `screenshot`, a
    picture of this state is written to a PNG file instead, which needs no display. Raises InputError if
    pyvista is not installed, if there is no display, or, without `force`, if the file exists and isopeel did
    not write it; OSError if it cannot be written.
    """
    stage = shown_stage(folder)
    steps = [state.step for state in stage.run.states]
    chosen = chosen_states(stage, [] if at is None else [at], console)
    number = steps.index(chosen[0].step) if chosen else len(steps) - 1
    if screenshot is not None:
        if screenshot.suffix.lower() != ".png":
            raise InputError("--screenshot", str(screenshot), "its name must end in .png")
        check_overwritten("--screenshot", [screenshot], force)
    pyvista = _pyvista()
    if screenshot is None:
        _check_display()
        viewer = Viewer(pyvista, stage, off_screen=False)
        viewer.add_slider(number)
        viewer.plotter.show(title=f"isopeel: {stage.title}")
        return
    make_folder(screenshot.parent, "--screenshot")
    # without a display VTK prints a warning, but it can draw
    with pyvista.vtk_verbosity("off"), replacing(screenshot) as part:
        viewer = Viewer(pyvista, stage, off_screen=True)
        viewer.show(number)
        picture = Image.fromarray(viewer.plotter.screenshot(return_img=True))
        picture.save(part, "PNG", pnginfo=_MARK)
        viewer.plotter.close()
    console.print(f"drawn in {screenshot}", soft_wrap=True)


def _pyvista() -> ModuleType:
    try:
        import pyvista
    except ImportError as error:
        allowed = f"it is not installed ({error}); pip install 'isopeel[view]' installs it"
        raise InputError("view", "pyvista", allowed) from error
    return pyvista


def _check_display() -> None:
    # on other systems there is always a display; without one VTK ends the process
    if sys.platform.startswith("linux") and not (
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    ):
        allowed = "there is no display for a window; --screenshot FILE writes a picture instead"
        raise InputError("view", "display", allowed)


class Viewer:
    """A scene of the bodies of a stage, their substrates, and the shown state."""

    def __init__(self, pyvista: ModuleType, stage: StoredStage, *, off_screen: bool) -> None:
        self._pyvista = pyvista
        self._column = stage.stage.problem.drive.parameter_column
        problem = stage.stage.problem
        self._stage = stage
        window, scale = common_view(problem, stage.spaces, stage.run.states)
        first = self._state(0)
        #: The number of the shown state, from zero.
        self.shown: int = 0
        #: The slider of VTK, once it has been added.
        self.slider: Any = None
        self._bodies = {name: _mesh(pyvista, fields) for name, fields in first.bodies.items()}
        # in front of the body, which would hide half of it
        self._above = 1e-3 * float(np.ptp(window.y))
        self._faces = {
            name: pyvista.lines_from_points(_points(face.position, self._above))
            for name, face in first.faces.items()
        }
        self.plotter: Any = pyvista.Plotter(off_screen=off_screen, window_size=_SIZE)
        self.plotter.set_background("white")
        self.plotter.enable_anti_aliasing("ssaa")
        for body in self._bodies.values():
            self.plotter.add_mesh(
                body,
                scalars=_FIELD,
                cmap=mpl.colormaps[FIELD_MAP],
                clim=(-scale, scale),
                lighting=False,
                # bars of one title are one bar; the arguments are changed
                scalar_bar_args=dict(_BAR),
            )
        for face in self._faces.values():
            self.plotter.add_mesh(face, color=VERMILION, line_width=8, lighting=False)
        for one in substrates(problem):
            substrate = _region(pyvista, one, window)
            if substrate.n_cells:
                self.plotter.add_mesh(substrate, color=SHADE, lighting=False)
                edges = substrate.extract_feature_edges(feature_edges=False, manifold_edges=False)
                self.plotter.add_mesh(edges, color="black", line_width=1, lighting=False)
        self.plotter.add_text(stage.laboratory.note(), position="lower_right", font_size=8, color="black")
        self.plotter.view_xy()
        self.plotter.enable_parallel_projection()
        low, high = np.transpose([window.x, window.y])
        self.plotter.camera.focal_point = (*(low + high) / 2, 0.0)
        self.plotter.camera.position = (*(low + high) / 2, float(np.ptp(window.x)))
        aspect = _SIZE[0] / _SIZE[1]
        self.plotter.camera.parallel_scale = 0.65 * max(high[1] - low[1], (high[0] - low[0]) / aspect)

    def _state(self, number: int) -> DrawnState:
        stage = self._stage
        return drawn_state(stage.stage.problem, stage.spaces, stage.run.states[number])

    def show(self, number: int) -> None:
        """Show a state, by its number from zero; numbers beyond the ends show the states at the ends."""
        self.shown = min(max(number, 0), len(self._stage.run.states) - 1)
        state = self._state(self.shown)
        for name, fields in state.bodies.items():
            self._bodies[name].points = _points(fields.position)
            self._bodies[name][_FIELD] = fields.first_invariant.ravel()
        for name, face in state.faces.items():
            self._faces[name].points = _points(face.position, self._above)
        text = self._stage.laboratory.parameter(self._column, state.parameter)
        self.plotter.add_text(text, position="upper_left", font_size=12, color="black", name="parameter")

    def add_slider(self, number: int) -> None:
        """Add a slider over the states, which the arrow keys move too, and show one of them."""
        last = len(self._stage.run.states) - 1
        self.show(number)
        if not last:
            return
        self.slider = self.plotter.add_slider_widget(
            lambda value: self.show(round(value)),
            (0, last),
            value=number,
            title="stored state",
            fmt="%.0f",
            color="black",
            pointa=(0.1, 0.1),
            pointb=(0.6, 0.1),
        )

        self.plotter.add_key_event("Right", lambda: self.move(1))
        self.plotter.add_key_event("Left", lambda: self.move(-1))

    def move(self, by: int) -> None:
        """Move by a number of states, with the slider."""
        self.show(self.shown + by)
        self.slider.GetRepresentation().SetValue(self.shown)
        self.plotter.render()


def _points(places: FloatArray, height: float = 0.0) -> FloatArray:
    """Return places (..., 2) as points (n, 3) in the plane z = height."""
    flat = places.reshape(-1, 2)
    return np.column_stack([flat, np.full(len(flat), height)])


def _mesh(pyvista: ModuleType, fields: SampledFields) -> Any:
    """Return the cells of all elements, each element with its own nodes."""
    nodes = np.arange(fields.first_invariant.size).reshape(fields.first_invariant.shape)
    lower, upper = slice(None, -1), slice(1, None)
    around = (lower, lower), (upper, lower), (upper, upper), (lower, upper)
    corners = [nodes[..., along, across].ravel() for along, across in around]
    cells = np.column_stack([np.full(len(corners[0]), 4), *corners])
    mesh = pyvista.PolyData(_points(fields.position), faces=cells.ravel())
    mesh[_FIELD] = fields.first_invariant.ravel()
    return mesh


def _region(pyvista: ModuleType, substrate: Substrate, window: Window) -> Any:
    """Return the part of a window where the gap of a substrate is negative."""
    count = 401
    x, y = np.meshgrid(np.linspace(*window.x, count), np.linspace(*window.y, count), indexing="ij")
    gap, _, _ = evaluate_substrate(substrate.kernel, substrate.parameters, np.stack([x, y], axis=-1))
    grid = pyvista.StructuredGrid(x, y, np.full_like(x, -1e-3 * float(np.ptp(window.y))))
    # the formula of a substrate may have no value somewhere; nodes of the grid count along x first
    grid["gap"] = np.nan_to_num(gap, nan=1.0).ravel(order="F")
    return grid.clip_scalar(scalars="gap", value=0.0).extract_surface(algorithm=None)
