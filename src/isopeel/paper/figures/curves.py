"""Moment over rotation: functions for figures of whole and of enlarged curves."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import floor, log10
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from isopeel.common.arrays import FloatArray, frozen
from isopeel.common.errors import InputError
from isopeel.paper.study import MESHES
from isopeel.post.style import DASHES, DOTS, LineStyle, space_style

ROTATION = "rotation / degree"
MOMENT = "moment $M$ / $E_0 L_0^3$"
#: The last angle of complete curves of the study, in degrees.
END_DEG = 150.0

_MESH_LINES: dict[str, tuple[LineStyle, float]] = {"m1": (DOTS, 1.4), "m2": (DASHES, 1.0), "m3": ("-", 1.4)}
_SAME = 1e-9  # angles closer than this differ by round-off only


@dataclass(frozen=True, eq=False)
class Trace:
    """The moment of a run, in E0 L0^3, at rising angles; both (steps,). InputError for other arrays."""

    angles_deg: FloatArray
    moments: FloatArray

    def __post_init__(self) -> None:
        for name in ("angles_deg", "moments"):
            object.__setattr__(self, name, frozen(getattr(self, name)))
        shapes = self.angles_deg.shape, self.moments.shape
        if len(shapes[0]) != 1 or not self.angles_deg.size or shapes[0] != shapes[1]:
            raise InputError("trace", f"shapes {shapes}", "give as many moments as angles, one at least")
        if np.any(np.diff(self.angles_deg) <= 0):
            raise InputError("angles_deg", self.angles_deg.tolist(), "angles must rise")

    @property
    def end_deg(self) -> float:
        """The last angle."""
        return float(self.angles_deg[-1])

    def reaches(self, angle_deg: float) -> bool:
        """Return whether the run reached an angle."""
        return self.end_deg >= angle_deg - _SAME

    def within(self, part: tuple[float, float]) -> tuple[FloatArray, FloatArray]:
        """Return angles and moments in an interval of the angle; none if the curve ends before it."""
        inside = (self.angles_deg >= part[0] - _SAME) & (self.angles_deg <= part[1] + _SAME)
        return self.angles_deg[inside], self.moments[inside]

    def deviation(
        self, window: tuple[float, float], part: tuple[float, float]
    ) -> tuple[FloatArray, FloatArray]:
        """Return angles and moments in an interval, minus a straight line fitted to them in a window."""
        line = np.polynomial.Polynomial.fit(*self.within(window), 1)
        angles, moments = self.within(part)
        return angles, moments - line(angles)


def around(window: tuple[float, float]) -> tuple[float, float]:
    """Return the interval to draw for a window: the window and a margin."""
    margin = 0.15 * (window[1] - window[0])
    return window[0] - margin, window[1] + margin


def mesh_line(space: str, mesh: str) -> dict[str, Any]:
    """Return the style of a space on a mesh, for figures with several meshes: the colour is of the space."""
    if mesh not in _MESH_LINES:
        raise InputError("mesh", mesh, f"the published meshes are {', '.join(MESHES)}")
    linestyle, linewidth = _MESH_LINES[mesh]
    return {"color": space_style(space).color, "linestyle": linestyle, "linewidth": linewidth}


def mesh_handles(meshes: Iterable[str]) -> list[Line2D]:
    """Return the legend entries of meshes, in the colour of linear elements."""
    return [Line2D([], [], **mesh_line("L1", mesh), label=mesh) for mesh in dict.fromkeys(meshes)]


def draw_whole(axes: Axes, curves: Mapping[str, Trace], looks: Mapping[str, dict[str, Any]]) -> None:
    """Draw curves from 0 to END_DEG. Curves that end before have a cross at their last angle."""
    crosses = []
    for name, curve in curves.items():
        axes.plot(curve.angles_deg, curve.moments, **looks[name], label=name)
        if not curve.reaches(END_DEG):
            end = curve.end_deg, float(curve.moments[-1])
            cross = {"color": looks[name]["color"], "markersize": 7, "markeredgewidth": 1.5, "linestyle": ""}
            crosses += axes.plot(*end, marker="x", **cross, label=f"{name} ends at {curve.end_deg:.1f}°")
    if crosses:
        # the moment rises from the lower left to its plateau: the lower right corner is free
        axes.legend(handles=crosses, loc="lower right", handlelength=1)
    axes.set_xlim(0, END_DEG)
    axes.set_xticks(np.linspace(0, END_DEG, 6))
    axes.set_ylim(bottom=0)
    axes.set_xlabel(ROTATION)
    axes.set_ylabel(MOMENT)


def draw_enlarged(
    axes: Axes, curves: Mapping[str, Trace], looks: Mapping[str, dict[str, Any]], part: tuple[float, float]
) -> None:
    """Draw an interval of all curves that reach it."""
    for name, curve in curves.items():
        if curve.reaches(part[0]):
            axes.plot(*curve.within(part), **looks[name], label=name)
    _finish_enlarged(axes, part)
    axes.set_ylabel(MOMENT)


def draw_deviations(
    axes: Axes, curves: Mapping[str, Trace], looks: Mapping[str, dict[str, Any]], window: tuple[float, float]
) -> None:
    """Draw curves around a window, each minus the straight line fitted to it inside the window.

    Curves that do not reach its end are not drawn. The scale is a power of ten, written at the axis.
    """
    part = around(window)
    shown = {
        name: curve.deviation(window, part) for name, curve in curves.items() if curve.reaches(window[1])
    }
    largest = max((float(np.abs(deviation).max()) for _, deviation in shown.values()), default=1.0)
    exponent = floor(log10(max(largest, 1e-15)))  # below, there is round-off only
    for name, (angles, deviation) in shown.items():
        axes.plot(angles, deviation / 10.0**exponent, **looks[name], label=name)
    _finish_enlarged(axes, part)
    axes.set_ylabel(f"deviation / $10^{{{exponent}}}\\,E_0 L_0^3$")


def _finish_enlarged(axes: Axes, part: tuple[float, float]) -> None:
    if not axes.lines:
        axes.text(0.5, 0.5, "no curve gets this far", transform=axes.transAxes, ha="center")
        axes.set_yticks([])
    axes.set_xlim(*part)
    axes.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    axes.set_xlabel(ROTATION)
