"""Parts of a picture of deformed bodies: field, elements, outline, and the substrate."""

from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, TriMesh
from matplotlib.tri import Triangulation

from isopeel.physics.batch import evaluate_substrate
from isopeel.physics.substrates import Substrate
from isopeel.post.fields import SampledFields
from isopeel.post.states import DrawnState, Face, Window
from isopeel.post.style import FIELD_MAP, SHADE, VERMILION

FIELD_LABEL = r"$I_1 = \mathrm{tr}\,\sigma / E$"


def draw_field(axes: Axes, fields: SampledFields, scale: float, order: float) -> TriMesh:
    """Fill the body with I1 on the scale from -scale to scale, linear over two triangles of each cell."""
    nodes = np.arange(fields.first_invariant.size).reshape(fields.first_invariant.shape)
    ends = (slice(None, -1), slice(1, None))
    lower_left, upper_left, lower_right, upper_right = (nodes[..., k, m].ravel() for k in ends for m in ends)
    triangles = np.concatenate(
        [
            np.stack([lower_left, lower_right, upper_right], axis=1),
            np.stack([lower_left, upper_right, upper_left], axis=1),
        ]
    )
    x, y = fields.position.reshape(-1, 2).T
    # an inverted element has no stress, and stays blank
    values = fields.first_invariant.ravel()
    return axes.tripcolor(
        Triangulation(x, y, triangles[np.isfinite(values[triangles]).all(axis=1)]),
        np.nan_to_num(values),
        shading="gouraud",
        cmap=FIELD_MAP,
        vmin=-scale,
        vmax=scale,
        rasterized=True,
        zorder=order,
    )


def draw_outline(axes: Axes, fields: SampledFields, order: float) -> None:
    """Draw the boundary of the body."""
    x = fields.position
    sides = (x[:, 0, :, 0], x[-1, :, -1, :], x[::-1, -1, ::-1, -1], x[0, ::-1, 0, ::-1])
    ring = np.concatenate([side.reshape(-1, 2) for side in sides])
    axes.plot(*ring.T, color="black", linewidth=0.6, solid_joinstyle="round", zorder=order)


def draw_elements(axes: Axes, fields: SampledFields, order: float) -> None:
    """Draw the edges of the elements."""
    x = fields.position
    edges = [x[:, :, :, 0], x[:, -1, :, -1], x[:, :, 0, :], x[-1, :, -1, :]]
    lines = [line for edge in edges for line in edge.reshape(-1, edge.shape[-2], 2)]
    axes.add_collection(
        LineCollection(lines, colors="black", linewidths=0.3, alpha=0.6, zorder=order), autolim=False
    )


def draw_bodies(
    axes: Axes, state: DrawnState, scale: float, order: float, *, elements: bool = False
) -> TriMesh:
    """Draw all bodies with their fields and outlines, and with their `elements`; return the last field."""
    for fields in state.bodies.values():
        mesh = draw_field(axes, fields, scale, order)
        if elements:
            draw_elements(axes, fields, order + 1)
        draw_outline(axes, fields, order + (2 if elements else 0.2))
    return mesh


def draw_substrates(axes: Axes, substrates: Iterable[Substrate], window: Window) -> None:
    """Hatch the part of a window that substrates occupy, where a gap is negative."""
    x, y = np.meshgrid(np.linspace(*window.x, 201), np.linspace(*window.y, 201))
    for substrate in substrates:
        gap, _, _ = evaluate_substrate(substrate.kernel, substrate.parameters, np.stack([x, y], axis=-1))
        lowest = float(np.nanmin(gap))  # a substrate from a formula may have no value somewhere
        if lowest < 0:
            axes.contourf(x, y, gap, levels=[2 * lowest, 0], colors=[SHADE], hatches=["/////"], zorder=0)
            axes.contour(x, y, gap, levels=[0.0], colors="black", linewidths=0.8, zorder=0.5)


def mark_adhering(axes: Axes, faces: Iterable[Face], width: float, order: float) -> None:
    """Draw the adhering parts of sides; where nothing adheres, those in contact."""
    given = list(faces)
    for face in [one for one in given if one.adheres] or given:
        # the white seam separates the mark from the field in print without colours
        for color, total in (("white", width + 1), (VERMILION, width)):
            axes.plot(*face.position.T, color=color, linewidth=total, zorder=order, solid_capstyle="butt")
