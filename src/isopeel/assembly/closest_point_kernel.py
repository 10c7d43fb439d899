"""Compiled search for the closest point of a deformed side, a curve of Bezier segments.

The closest point y(s) to x is a minimum of the distance, at which f(s) = -(x - y) . y' turns from negative to
positive. It is the closest one of the whole curve: a segment is left out only where its bounding box is
farther away than a point that is known. So it depends on nothing but the present displacement.
"""

from typing import NamedTuple

import numpy as np

from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import compiled, inner

#: Segments of one larger box, which is compared first.
_GROUP = 8
_MOST_STEPS = 100  # halving alone needs 53 to the last digit
#: A step of Newton's method of this size leaves an error of about its square; any other one, of its own size.
_QUADRATIC, _ROUND_OFF = 1e-8, 1e-16
#: Tangents of two segments whose sine is smaller than this are parallel: the curve is smooth there.
_PARALLEL = 1e-10
#: A projection that leaves the end of a curve at a right angle, to round-off, is one on the curve.
_UPRIGHT = 1e-9
#: Distance of a point from a curve that is round-off, as a share of its coordinates.
_ON_THE_END = 1e-14

#: Kinds of partners.
NONE, SMOOTH, CORNER = 0, 1, 2


class Segments(NamedTuple):
    """A curve in its present position."""

    points: FloatArray  # (S, 2, p + 1) numerators
    weights: FloatArray  # (S, p + 1) their denominator
    rational: bool  # whether some denominator is not 1
    slowest: FloatArray  # (S,) lower bound of y'.y' / |y''| on a segment that is not rational
    boxes: FloatArray  # (S, 4) least x and y, largest x and y
    groups: FloatArray  # (groups, 4) of the boxes of `_GROUP` segments


@compiled
def segments_at(
    functions: IntArray, values: FloatArray, weights: FloatArray, shape: FloatArray, u: FloatArray
) -> Segments:
    """Return the curve of a `FacingCurve` at coefficients u (size, 2)."""
    count, m, p = values.shape
    points = shape.copy()
    slowest = np.zeros(count)
    boxes = np.empty((count, 4))
    groups = np.empty((-(-count // _GROUP), 4))
    groups[:, :2] = np.inf
    groups[:, 2:] = -np.inf
    rational = False
    for s in range(count):
        for b in range(m):
            for i in range(2):
                for k in range(p):
                    points[s, i, k] += values[s, b, k] * u[functions[s, b], i]
        for k in range(p):
            rational = rational or weights[s, k] != 1.0
        slowest[s] = _slowest(points[s])
        for i in range(2):
            # a rational Bezier curve lies in the convex hull of its control points
            low, high = np.inf, -np.inf
            for k in range(p):
                point = points[s, i, k] / weights[s, k]
                low, high = min(low, point), max(high, point)
            g = s // _GROUP
            boxes[s, i], boxes[s, 2 + i] = low, high
            groups[g, i] = min(groups[g, i], low)
            groups[g, 2 + i] = max(groups[g, 2 + i], high)
    return Segments(points, weights, rational, slowest, boxes, groups)


@inner
def _slowest(points: FloatArray) -> float:
    """Return a lower bound of y'.y' / |y''| on a polynomial segment of control points (2, p + 1).

    Derivatives lie in the convex hulls of p times the differences of control points (Piegl and Tiller, The
    NURBS Book, Eq. 1.10). The tangent is at least as long as its component along the chord.
    """
    p = points.shape[1] - 1
    chord_x, chord_y = points[0, p] - points[0, 0], points[1, p] - points[1, 0]
    chord = np.hypot(chord_x, chord_y)
    slowest, bend = np.inf, 0.0
    for k in range(p):
        step_x, step_y = points[0, k + 1] - points[0, k], points[1, k + 1] - points[1, k]
        slowest = min(slowest, p * (step_x * chord_x + step_y * chord_y))
        if k > 0:
            turn_x, turn_y = (
                step_x - (points[0, k] - points[0, k - 1]),
                step_y - (points[1, k] - points[1, k - 1]),
            )
            bend = max(bend, p * (p - 1) * np.hypot(turn_x, turn_y))
    if not slowest > 0.0:
        return 0.0
    speed = slowest / chord
    return speed * speed / bend if bend > 0.0 else np.inf


@inner
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


@inner
def curve_at(curve: Segments, segment: int, s: float, basis: FloatArray, point: FloatArray) -> None:
    """Write position, tangent dy/ds and its derivative to a point (3, 2), and the basis."""
    bernstein(s, basis)
    numerators, denominator = curve.points[segment], curve.weights[segment]
    for i in range(2):
        for d in range(3):
            total = 0.0
            for k in range(denominator.size):
                total += numerators[i, k] * basis[d, k]
            point[d, i] = total
    if not curve.rational:
        return
    W0, W1, W2 = 0.0, 0.0, 0.0
    for k in range(denominator.size):
        W0 += denominator[k] * basis[0, k]
        W1 += denominator[k] * basis[1, k]
        W2 += denominator[k] * basis[2, k]
    for i in range(2):
        point[0, i] /= W0
        point[1, i] = (point[1, i] - point[0, i] * W1) / W0
        point[2, i] = (point[2, i] - 2.0 * point[1, i] * W1 - point[0, i] * W2) / W0


@inner
def _box_distance(x: float, y: float, box: FloatArray) -> float:
    """Return the squared distance of a point to a box."""
    across = max(box[0] - x, 0.0, x - box[2])
    up = max(box[1] - y, 0.0, y - box[3])
    square: float = across * across + up * up
    return square


@inner
def _closest_on(
    curve: Segments, segment: int, x: float, y: float, basis: FloatArray, point: FloatArray
) -> tuple[float, float]:
    """Return the place s of the closest point of one segment, and the squared distance."""
    low, high, s = 0.0, 1.0, 0.5
    if not curve.rational and _is_convex(curve, segment, x, y):
        points = curve.points[segment]
        p = points.shape[1] - 1
        # the slopes f at both ends, by their control points
        r_x, r_y = x - points[0, 0], y - points[1, 0]
        at_start = -p * (r_x * (points[0, 1] - points[0, 0]) + r_y * (points[1, 1] - points[1, 0]))
        if at_start >= 0.0:
            return 0.0, r_x * r_x + r_y * r_y
        r_x, r_y = x - points[0, p], y - points[1, p]
        at_end = -p * (r_x * (points[0, p] - points[0, p - 1]) + r_y * (points[1, p] - points[1, p - 1]))
        if at_end <= 0.0:
            return 1.0, r_x * r_x + r_y * r_y
        s = at_start / (at_start - at_end)
    else:
        samples = 2 * basis.shape[1] - 1
        least, nearest = np.inf, 0
        for k in range(samples + 1):
            curve_at(curve, segment, k / samples, basis, point)
            square = (x - point[0, 0]) ** 2 + (y - point[0, 1]) ** 2
            if square < least:
                least, nearest = square, k
        low, high = max(nearest - 1, 0) / samples, min(nearest + 1, samples) / samples
        s = nearest / samples
    width = step = high - low
    for _ in range(_MOST_STEPS):
        curve_at(curve, segment, s, basis, point)
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
        by_newton = low <= s + step <= high and abs(step) <= 0.5 * abs(last)
        if not by_newton:
            step = 0.5 * (low + high) - s
        s += step
        if abs(step) <= (_QUADRATIC if by_newton else _ROUND_OFF):
            break
    curve_at(curve, segment, s, basis, point)
    return s, (x - point[0, 0]) ** 2 + (y - point[0, 1]) ** 2


@inner
def _is_convex(curve: Segments, segment: int, x: float, y: float) -> bool:
    """Return whether the squared distance to a point is convex along a segment: y'.y' > (x - y) . y''."""
    points, slowest = curve.points[segment], curve.slowest[segment]
    farthest = 0.0
    for k in range(points.shape[1]):
        farthest = max(farthest, (x - points[0, k]) ** 2 + (y - points[1, k]) ** 2)
    convex: bool = farthest < slowest * slowest
    return convex


@inner
def _parallel(one: FloatArray, other: FloatArray) -> bool:
    """Return whether two tangents (2,) have one direction."""
    sizes = np.hypot(one[0], one[1]) * np.hypot(other[0], other[1])
    turn, along = one[0] * other[1] - one[1] * other[0], one[0] * other[0] + one[1] * other[1]
    parallel: bool = along > 0.0 and abs(turn) <= _PARALLEL * sizes
    return parallel


@compiled
def closest_places(curve: Segments, points: FloatArray) -> tuple[IntArray, IntArray, FloatArray]:
    """Return kinds of partners, segments and places (n,) of the points closest to points (n, 2)."""
    count = len(points)
    kinds, segments = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
    places = np.empty(count)
    basis, point, normal = np.empty((3, curve.weights.shape[1])), np.empty((3, 2)), np.empty(2)
    segment = 0
    for p in range(count):
        x, y = points[p, 0], points[p, 1]
        kinds[p], segment, places[p] = closest_point(curve, x, y, segment, basis, point, normal)
        segments[p] = segment
    return kinds, segments, places


@inner
def closest_point(
    curve: Segments,
    x: float,
    y: float,
    first: int,
    basis: FloatArray,
    point: FloatArray,
    normal: FloatArray,
) -> tuple[int, int, float]:
    """Return the kind of partner that a point has on a curve, and its segment and place s.

    `first` is the segment to begin with, which changes the time only. Writes position and derivatives to
    `point` (3, 2), the basis at s, and to `normal` (2,) the vector to the right of the curve; at a corner it
    is the mean of both sides.
    """
    segment = first
    s, least = _closest_on(curve, first, x, y, basis, point)
    count = len(curve.boxes)
    for g in range(len(curve.groups)):
        if _box_distance(x, y, curve.groups[g]) >= least:
            continue
        for k in range(g * _GROUP, min((g + 1) * _GROUP, count)):
            if k == first or _box_distance(x, y, curve.boxes[k]) >= least:
                continue
            place, square = _closest_on(curve, k, x, y, basis, point)
            if square < least:
                least, segment, s = square, k, place
    kind = SMOOTH
    if s == 0.0 or s == 1.0:
        other = segment - 1 if s == 0.0 else segment + 1
        if not 0 <= other < count:
            curve_at(curve, segment, s, basis, point)
            r_x, r_y = x - point[0, 0], y - point[0, 1]
            speed = np.hypot(point[1, 0], point[1, 1])
            # of a point on the end itself, the direction is round-off
            upright = _UPRIGHT * np.hypot(r_x, r_y) + _ON_THE_END * (abs(x) + abs(y) + speed)
            if abs(r_x * point[1, 0] + r_y * point[1, 1]) > upright * speed:
                kind = NONE
        else:
            curve_at(curve, other, 1.0 - s, basis, point)
            beyond = point[1].copy()
            curve_at(curve, segment, s, basis, point)
            if not _parallel(point[1], beyond):
                kind = CORNER
                size = np.hypot(beyond[0], beyond[1])
                normal[0], normal[1] = beyond[1] / size, -beyond[0] / size
    curve_at(curve, segment, s, basis, point)
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
