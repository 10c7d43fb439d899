"""The deformed body along a run, and its delamination front."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, QuadMesh
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from isopeel.arrays import FloatArray
from isopeel.errors import InputError
from isopeel.physics.batch import evaluate_substrate
from isopeel.post.fields import SampledFields, sample_fields, side_positions
from isopeel.post.style import FIELD_MAP, SHADE, TWO_COLUMNS, VERMILION, style
from isopeel.problem import Problem
from isopeel.splines.nurbs import Side
from isopeel.splines.rows import RowSpace

MOST_SHAPES = 6
#: The front is where the gap first exceeds so many equilibrium gaps: there the attraction is past its peak.
FRONT_GAP = 3.0
_OPPOSITE: dict[Side, Side] = {"left": "right", "right": "left", "bottom": "top", "top": "bottom"}


@dataclass(frozen=True, eq=False)
class _Shape:
    """One state of the body, ready to be drawn."""

    parameter: float
    fields: SampledFields
    face: FloatArray  # (n, 2) positions along the part of the side that adheres


@dataclass(frozen=True)
class _Window:
    """A part of the plane."""

    x: tuple[float, float]
    y: tuple[float, float]

    @property
    def aspect(self) -> float:
        """Width over height."""
        return (self.x[1] - self.x[0]) / (self.y[1] - self.y[0])


def shapes_figure(problem: Problem, space: RowSpace, fields: Mapping[float, FloatArray]) -> Figure:
    """Draw deformed shapes coloured by I1 = tr(sigma)/E, and the delamination front of the last one enlarged.

    `fields` maps values of the drive's parameter, in the unit of its column, to displacement coefficients
    (size, 2); at most MOST_SHAPES of them are drawn, evenly spread. Raises InputError where there are none.
    """
    if not fields:
        raise InputError("fields", fields, "give the displacement of at least one state")
    cells = _cells(space)
    shapes = []
    for parameter in _spread(list(fields)):
        sampled = sample_fields(problem, space, fields[parameter], cells)
        shapes.append(_Shape(parameter, sampled, _face(problem, space, fields[parameter])))
    last = shapes[-1]
    enlarged = _front_window(problem, space, fields[last.parameter], last.face)
    positions = np.concatenate([shape.fields.position.reshape(-1, 2) for shape in shapes])
    whole = _whole_window(positions)
    scale = max(float(np.nanmax(np.abs(shape.fields.first_invariant))) for shape in shapes)
    with style():
        panel = TWO_COLUMNS - 1.3  # without labels and the colour bar
        heights = (min(panel / whole.aspect, 5.0), panel / enlarged.aspect)
        figure = Figure(figsize=(TWO_COLUMNS, sum(heights) + 1.5), layout="constrained")
        upper, lower = figure.subplots(2, 1, height_ratios=heights)
        for axes, window in ((upper, whole), (lower, enlarged)):
            axes.set(xlim=window.x, ylim=window.y, aspect="equal", xlabel="$x / L_0$", ylabel="$y / L_0$")
            _draw_substrate(axes, problem, window)
        for order, shape in enumerate(shapes):
            mesh = _draw_shape(upper, shape, scale, order)
        ...
        return figure
