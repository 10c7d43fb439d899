"""The place of a body: its shape turned and moved."""

from math import cos, sin

import numpy as np

from isopeel.splines.nurbs import NurbsSurface


def placed(shape: NurbsSurface, at: tuple[float, float], angle: float) -> NurbsSurface:
    """Return a plane shape turned anticlockwise by an angle (radians) about the origin, and then moved."""
    # the round-off of pi would slant what is meant to lie along an axis
    cosine, sine = np.round([cos(angle), sin(angle)], 15)
    turned = shape.control_points @ np.array([[cosine, sine], [-sine, cosine]])
    return NurbsSurface(shape.spaces, turned + np.array(at), shape.weights)
