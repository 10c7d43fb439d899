"""Compiled search for the closest point of a deformed side, a curve of Bezier segments.

The closest point y(s) to x is a minimum of the distance, at which f(s) = -(x - y) . y' turns from negative to
positive. It is the closest one of the whole curve: a segment is left out only where its bounding box is
farther away than a point that is known. So it depends on nothing but the present displacement.
"""

from typing import NamedTuple

import numpy as np

from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import compiled

#: Segments of one larger box, which is compared first.
_GROUP = 8
_MOST_STEPS = 100  # halving alone needs 53 to the last digit
#: Tangents of two segments whose sine is smaller than this are parallel: the curve is smooth there.
_PARALLEL = 1e-10
#: A projection that leaves the end of a curve at a right angle, to round-off, is one on the curve.
_UPRIGHT = 1e-9

#: Kinds of partners.
NONE, SMOOTH, CORNER = 0, 1, 2


class Segments(NamedTuple):
    """A curve in its present position."""

    displacement: FloatArray  # (S, 2, p + 1) numerators
    weights: FloatArray  # (S, p + 1)
    shape: FloatArray  # (S, 3, q + 1)
    boxes: FloatArray  # (S, 4) least x and y, largest x and y
    groups: FloatArray  # (groups, 4) of the boxes of `_GROUP` segments


@compiled
def segments_at(
    functions: IntArray, values: FloatArray, weights: FloatArray, shape: FloatArray, u: FloatArray
) -> Segments:
    """Return the curve of a `FacingCurve` at coefficients u (size, 2)."""
    count, m, p = values.shape
    q = shape.shape[2]
    displacement = np.zeros((count, 2, p))
    boxes = np.empty((count, 4))
    groups = np.empty((-(-count // _GROUP), 4))
    groups[:, :2] = np.inf
    groups[:, 2:] = -np.inf
    for s in range(count):
        for b in range(m):
            for i in range(2):
                for k in range(p):
                    displacement[s, i, k] += values[s, b, k] * u[functions[s, b], i]
        for i in range(2):
            # a rational Bezier curve lies in the convex hull of its control points
            low, high = np.inf, -np.inf
            for k in range(p):
                point = displacement[s, i, k] / weights[s, k]
                low, high = min(low, point), max(high, point)
            low_shape, high_shape = np.inf, -np.inf
            for k in range(q):
                point = shape[s, i, k] / shape[s, 2, k]
                low_shape, high_shape = min(low_shape, point), max(high_shape, point)
            boxes[s, i], boxes[s, 2 + i] = low + low_shape, high + high_shape
            g = s // _GROUP
            groups[g, i] = min(groups[g, i], boxes[s, i])
            groups[g, 2 + i] = max(groups[g, 2 + i], boxes[s, 2 + i])
    return Segments(displacement, weights, shape, boxes, groups)


@compiled
def bernstein(s: float, basis: FloatArray) -> None:
    """Write the Bernstein polynomials of degree p at s, and two derivatives, to a basis (3, p + 1)."""
    p = basis.shape[1] - 1
    basis[:] = 0.0
    value = basis[0]
    value[0] = 1.0
    for d in range(1, p + 1):
        # of degree d - 1 so far; derivatives are differences of lower degrees
        if d == p - 1:
            for k in range(d):
                change = p * (p - 1) * value[k]
                basis[2, k] += change
                basis[2, k + 1] -= 2.0 * change
                basis[2, k + 2] += change
        if d == p:
            for k in range(d):
                basis[1, k] -= p * value[k]
                basis[1, k + 1] += p * value[k]
        for k in range(d, 0, -1):
            value[k] = s * value[k - 1] + (1.0 - s) * value[k]
        value[0] *= 1.0 - s


@compiled
def curve_at(
    curve: Segments, segment: int, s: float, basis: FloatArray, of_shape: FloatArray, point: FloatArray
) -> None:
    """Write position, tangent dy/ds and its derivative to a point (3, 2), and both bases."""
    bernstein(s, basis)
    bernstein(s, of_shape)
    point[:] = 0.0
    _add_quotients(curve.displacement[segment], curve.weights[segment], basis, point)
    _add_quotients(curve.shape[segment], curve.shape[segment, 2], of_shape, point)


@compiled
def _add_quotients(
    numerators: FloatArray, denominator: FloatArray, basis: FloatArray, point: FloatArray
) -> None:
    W0, W1, W2 = 0.0, 0.0, 0.0
    for k in range(denominator.size):
        W0 += denominator[k] * basis[0, k]
        W1 += denominator[k] * basis[1, k]
        W2 += denominator[k] * basis[2, k]
    for i in range(2):
        N0, N1, N2 = 0.0, 0.0, 0.0
        for k in range(denominator.size):
            N0 += numerators[i, k] * basis[0, k]
            N1 += numerators[i, k] * basis[1, k]
            N2 += numerators[i, k] * basis[2, k]
        value = N0 / W0
        slope = (N1 - value * W1) / W0
        point[0, i] += value
        point[1, i] += slope
        point[2, i] += (N2 - 2.0 * slope * W1 - value * W2) / W0


@compiled
def _box_distance(x: float, y: float, box: FloatArray) -> float:
    """Return the squared distance of a point to a box."""
    across = max(box[0] - x, 0.0, x - box[2])
    up = max(box[1] - y, 0.0, y - box[3])
    square: float = across * across + up * up
    return square


@compiled
def _closest_on(
    curve: Segments,
    segment: int,
    x: float,
    y: float,
    basis: FloatArray,
    of_shape: FloatArray,
    point: FloatArray,
) -> tuple[float, float]:
    """Return the place s of the closest point of one segment, and the squared distance."""
    samples = basis.shape[1] + of_shape.shape[1]
    least, nearest = np.inf, 0
    for k in range(samples + 1):
        curve_at(curve, segment, k / samples, basis, of_shape, point)
        square = (x - point[0, 0]) ** 2 + (y - point[0, 1]) ** 2
        if square < least:
            least, nearest = square, k
    low, high = max(nearest - 1, 0) / samples, min(nearest + 1, samples) / samples
    s = nearest / samples
    width = step = high - low
    for _ in range(_MOST_STEPS):
        curve_at(curve, segment, s, basis, of_shape, point)
        r_x, r_y = x - point[0, 0], y - point[0, 1]
        f = -(r_x * point[1, 0] + r_y * point[1, 1])
        if f < 0.0:
            low = s
        else:
            high = s
        # also a minimum at an end of the segment, towards which the distance decreases
        if f == 0.0 or high <= low:
            break
        rise = point[1, 0] ** 2 + point[1, 1] ** 2 - (r_x * point[2, 0] + r_y * point[2, 1])
        last = step
        step = -f / rise if rise > 0.0 else width
        if not (low <= s + step <= high and abs(step) <= 0.5 * abs(last)):
            step = 0.5 * (low + high) - s
        s += step
        if abs(step) <= 1e-16:
            break
    curve_at(curve, segment, s, basis, of_shape, point)
    return s, (x - point[0, 0]) ** 2 + (y - point[0, 1]) ** 2


@compiled
def _parallel(one: FloatArray, other: FloatArray) -> bool:
    """Return whether two tangents (2,) have one direction."""
    sizes = np.hypot(one[0], one[1]) * np.hypot(other[0], other[1])
    turn, along = one[0] * other[1] - one[1] * other[0], one[0] * other[0] + one[1] * other[1]
    parallel: bool = along > 0.0 and abs(turn) <= _PARALLEL * sizes
    return parallel


@compiled
def closest_point(
    curve: Segments,
    x: float,
    y: float,
    first: int,
    basis: FloatArray,
    of_shape: FloatArray,
    point: FloatArray,
    normal: FloatArray,
) -> tuple[int, int, float]:
    """Return the kind of partner that a point has on a curve, and its segment and place s.

    `first` is the segment to begin with, which changes the time only. Writes position and derivatives to
    `point` (3, 2), the bases at s, and to `normal` (2,) the vector to the right of the curve; at a corner it
    is the mean of both sides.
    """
    segment = first
    s, least = _closest_on(curve, first, x, y, basis, of_shape, point)
    count = len(curve.boxes)
    for g in range(len(curve.groups)):
        if _box_distance(x, y, curve.groups[g]) >= least:
            continue
        for k in range(g * _GROUP, min((g + 1) * _GROUP, count)):
            if k == first or _box_distance(x, y, curve.boxes[k]) >= least:
                continue
            place, square = _closest_on(curve, k, x, y, basis, of_shape, point)
            if square < least:
                least, segment, s = square, k, place
    kind = SMOOTH
    if s == 0.0 or s == 1.0:
        other = segment - 1 if s == 0.0 else segment + 1
        if not 0 <= other < count:
            curve_at(curve, segment, s, basis, of_shape, point)
            r_x, r_y = x - point[0, 0], y - point[0, 1]
            size = np.hypot(r_x, r_y) * np.hypot(point[1, 0], point[1, 1])
            if abs(r_x * point[1, 0] + r_y * point[1, 1]) > _UPRIGHT * size:
                kind = NONE
        else:
            curve_at(curve, other, 1.0 - s, basis, of_shape, point)
            beyond = point[1].copy()
            curve_at(curve, segment, s, basis, of_shape, point)
            if not _parallel(point[1], beyond):
                kind = CORNER
                size = np.hypot(beyond[0], beyond[1])
                normal[0], normal[1] = beyond[1] / size, -beyond[0] / size
    curve_at(curve, segment, s, basis, of_shape, point)
    size = np.hypot(point[1, 0], point[1, 1])
    if kind == CORNER:
        normal[0] += point[1, 1] / size
        normal[1] -= point[1, 0] / size
        size = np.hypot(normal[0], normal[1])
        normal[0] /= size
        normal[1] /= size
    else:
        normal[0], normal[1] = point[1, 1] / size, -point[1, 0] / size
    return kind, segment, s
