"""The routes of refinement: more knots, a higher degree, and the two in either order."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from isopeel.common.arrays import FloatArray
from isopeel.post.figures.spaces import draw_functions
from isopeel.post.style import DASHES, TWO_COLUMNS, style
from isopeel.splines.refinement import elevate, insert_knots, k_refine
from isopeel.splines.space import SplineSpace

#: Two quadratic elements, a function on them, and the knots that halve them.
COARSE = SplineSpace(2, np.array([0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0]))
COEFFICIENTS = np.array([0.45, 1.15, 0.05, 0.7])
NEW_KNOTS = np.array([0.5, 1.5])


def refinement_figure() -> Figure:
    """Draw a quadratic space, and the spaces after knot insertion (h), order elevation (p), and both (k).

    The dashed line is the same function in all spaces. The continuity is written above each inner knot.
    """
    elevated = elevate(COARSE, COEFFICIENTS, 1)
    inserted = insert_knots(COARSE, COEFFICIENTS, NEW_KNOTS)
    routes = {
        "coarse": ("a coarse space", COARSE, COEFFICIENTS),
        "h": ("h: knots inserted", *inserted),
        "p": ("p: degree elevated", *elevated),
        "k": ("k: elevated, then knots inserted", *k_refine(COARSE, COEFFICIENTS, 1, NEW_KNOTS)),
        "hp": ("h, then p: knots inserted, then elevated", *elevate(*inserted, 1)),
    }
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 6.2), layout="constrained")
        panels = figure.subplot_mosaic([["coarse", "legend"], ["h", "p"], ["hp", "k"]])
        panels["legend"].axis("off")
        for key, (title, space, coefficients) in routes.items():
            _draw(panels[key], title, space, coefficients)
        lowest = min(panels[key].get_ylim()[0] for key in routes)
        for key in routes:
            panels[key].set_ylim(bottom=lowest)
        functions, *_, knots, same = panels["coarse"].lines
        panels["legend"].legend(
            [functions, same, knots],
            ["a B-spline", "one function, in all five spaces", "a knot, once for each repetition"],
            loc="center left",
        )
        return figure


def _draw(axes: Axes, title: str, space: SplineSpace, coefficients: FloatArray) -> None:
    draw_functions(axes, space, "", r"$\xi$")
    # above the continuities
    axes.set_title(f"{title}\ndegree {space.degree}, {space.size} functions", loc="left", pad=16)
    points = np.linspace(space.breakpoints[0], space.breakpoints[-1], 201)
    axes.plot(points, space.collocation(points) @ coefficients, color="black", linestyle=DASHES)
    for knot, continuity in zip(space.breakpoints[1:-1], space.continuities, strict=True):
        axes.text(knot, 1.05, f"$C^{continuity}$", ha="center", fontsize=8)
