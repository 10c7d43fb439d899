"""The region of the plane that the substrate occupies, as polygons."""

from typing import Any

import numpy as np
from contourpy import FillType, LineType, contour_generator

from isopeel.physics.batch import evaluate_substrate
from isopeel.physics.substrates import Substrate
from isopeel.post.states import Window

_POINTS = 501  # per direction
_DIGITS = 6

#: Points of a line, as x, y, x, y and so on.
Line = list[float]


def substrate_region(substrate: Substrate, window: Window) -> tuple[list[Line], list[Line]]:
    """Return rings around the part of a window where the gap is negative, with holes, and its surface."""
    x, y = np.linspace(*window.x, _POINTS), np.linspace(*window.y, _POINTS)
    gap, _, _ = evaluate_substrate(substrate.kernel, substrate.parameters, np.stack(np.meshgrid(x, y), -1))
    # the formula of a substrate may have no value at some points
    levels = np.ma.masked_invalid(gap)
    lowest = float(levels.min()) if levels.count() else 0.0
    if lowest >= 0:
        return [], []
    contours = contour_generator(x, y, levels, fill_type=FillType.OuterOffset, line_type=LineType.Separate)
    filled: Any = contours.filled(2 * lowest, 0.0)  # points, and the index of the first point of each ring
    rings = [ring for points, ends in zip(*filled, strict=True) for ring in np.split(points, ends[1:-1])]
    return [_flat(ring) for ring in rings], [_flat(line) for line in contours.lines(0.0)]


def _flat(points: object) -> Line:
    return [float(f"{value:.{_DIGITS}g}") for value in np.ravel(np.asarray(points, dtype=np.float64))]
