"""The place of a body: its shape turned and moved, and how far it reaches."""

from math import cos, sin

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.splines.nurbs import NurbsCurve, NurbsSurface

#: Points of each element of a curve among which its farthest one is looked for first.
_SAMPLES = 17


def placed(shape: NurbsSurface, at: tuple[float, float], angle: float) -> NurbsSurface:
    """Return a plane shape turned anticlockwise by an angle (radians) about the origin, and then moved."""
    # the round-off of pi would slant what is meant to lie along an axis
    cosine, sine = np.round([cos(angle), sin(angle)], 15)
    turned = shape.control_points @ np.array([[cosine, sine], [-sine, cosine]])
    return NurbsSurface(shape.spaces, turned + np.array(at), shape.weights)


def reach(curve: NurbsCurve, direction: FloatArray) -> float:
    """Return the largest component along a direction (2,) of the points of a curve."""
    from scipy.optimize import minimize_scalar

    ends = curve.space.breakpoints
    # control points of a polygon lie on it
    if curve.space.degree == 1:
        return float((curve.control_points @ direction).max())
    places = np.unique(np.linspace(ends[:-1], ends[1:], _SAMPLES))
    found = curve.evaluate(places) @ direction
    best = int(np.argmax(found))
    around = places[max(best - 1, 0)], places[min(best + 1, places.size - 1)]
    refined = minimize_scalar(
        lambda place: -float(curve.evaluate([place])[0] @ direction),
        bounds=around,
        method="bounded",
        options={"xatol": 1e-9},  # the component changes by its square
    )
    return max(float(found[best]), -float(refined.fun))
