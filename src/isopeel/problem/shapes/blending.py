"""Patches between four quadratic curves.

Curves are Bezier curves in homogeneous coordinates: control points times weights, and the weights, (3, 3).
"""

from math import cos, sin

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.splines.nurbs import NurbsSurface
from isopeel.splines.space import SplineSpace


def line(start: tuple[float, float], end: tuple[float, float]) -> FloatArray:
    """Return a straight line."""
    ends = np.array([[*start, 1.0], [*end, 1.0]])
    return np.stack([ends[0], ends.mean(axis=0), ends[1]])


def arc(radius: float, start: float, end: float) -> FloatArray:
    """Return an exact arc of the circle that touches the x axis from above at the origin.

    Angles are measured anticlockwise from the lowest point. The NURBS Book (Piegl, Tiller), Sec. 7.3.
    """
    middle = cos((end - start) / 2)
    angles, weights = (start, (start + end) / 2, end), (1.0, middle, 1.0)
    rows = zip(angles, weights, strict=True)
    # the tangents at both ends meet at the distance radius / middle from the centre: times its weight, the
    # middle control point is at the radius too
    return np.array([[radius * sin(angle), radius * (w - cos(angle)), w] for angle, w in rows])


def blended(left: FloatArray, right: FloatArray, bottom: FloatArray, top: FloatArray) -> NurbsSurface:
    """Return the biquadratic patch between four curves that meet at their ends.

    It is Coons's bilinear blend in homogeneous coordinates (Coons, 1967). The sides give all control points
    except for one inside.
    """
    points = np.empty((3, 3, 3))
    points[0], points[2], points[:, 0], points[:, 2] = left, right, bottom, top
    corners = bottom[0] + bottom[2] + top[0] + top[2]
    points[1, 1] = (left[1] + right[1] + bottom[1] + top[1]) / 2 - corners / 4
    quadratic = SplineSpace.uniform(2, 1, 1)
    return NurbsSurface((quadratic, quadratic), points[..., :2] / points[..., 2:], points[..., 2])
