"""Closest-point projection on the graph y = f(x) of a smooth function, the solid below it.

The closest point (s, f(s)) to (x, y) is a minimum of the distance, at which
g(s) = (s - x) + (f(s) - y) f'(s) turns from negative to positive. Compiled code takes a curve as a function
of a place s and of constants, which returns f, f' and f''.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numba import float64, int64, void

from isopeel.common.arrays import FloatArray
from isopeel.common.compilation import inlined
from isopeel.physics.batch import SUBSTRATE_SIGNATURE, BatchFunction, compile_batch, of_address
from isopeel.physics.points import PointLoop, compile_points

_VECTOR = float64[::1]
_CURVE_SIGNATURE = void(_VECTOR, _VECTOR, int64, _VECTOR, _VECTOR, _VECTOR)
_curve_at = of_address(_CURVE_SIGNATURE)

#: A graph y = f(x); the first parameter is the address of its compiled loop.
GRAPH_LOOP = PointLoop(
    _CURVE_SIGNATURE,
    "place, parameters, count, height, slope, second",
    {"x": "place[n]"},
    ("height[n]", "slope[n]", "second[n]"),
    first=1,
)

_SAMPLES = 65  # an odd number: the one in the middle lies straight below or above the point
_MOST_STEPS = 100  # halving alone needs 53 to the last digit


@cache
def curve_kernel(graph: Callable[..., Any]) -> BatchFunction:
    """Batch function of f, f' and f'' as formulas of `x` and constants, for `graph_kernel`."""
    return compile_points(GRAPH_LOOP, graph)


@cache
def graph_kernel() -> BatchFunction:
    """Batch function of gap, normal and curvature: one for all graphs.

    Its parameters are the address of a `curve_kernel`, which a float holds exactly, and the constants. The
    closest point is the true one where the curve has no bump, dip or step narrower than a tenth of its
    distance straight below or above the point; else it may be another minimum of the distance. All is nan
    where f has no value there, or ends where it would be closest.
    """
    return compile_batch(SUBSTRATE_SIGNATURE, _project)


def _project(
    position: FloatArray,
    parameters: FloatArray,
    count: int,
    gap: FloatArray,
    normal: FloatArray,
    curvature: FloatArray,
) -> None:
    curve = _curve_at(int(parameters[0]))
    samples = np.empty((4, _SAMPLES))
    places, heights = samples[0], samples[1]
    graph = parameters, np.empty((4, 1))
    square = np.empty(_SAMPLES)
    last = _SAMPLES - 1
    for n in range(count):
        x = position[0, n]
        y = position[1, n]
        reach = abs(_on_graph(x, graph)[0] - y)
        bound = closest = np.inf
        foot = np.nan
        # nothing farther along x than a known distance can be closer; near a steep slope the first distance,
        # straight down, is much too large, and the samples narrow down on what is left
        while True:
            for k in range(_SAMPLES):
                places[k] = x + reach * (2 * k - last) / last
            curve(places, parameters, _SAMPLES, heights, samples[2], samples[3])
            for k in range(_SAMPLES):
                square[k] = (places[k] - x) ** 2 + (heights[k] - y) ** 2
            for k in range(1, last):
                if square[k] <= square[k - 1] and square[k] <= square[k + 1]:
                    s, f, _, _ = minimum(_on_graph, graph, x, y, places[k - 1], places[k], places[k + 1])
                    distance = np.hypot(s - x, f - y)
                    if distance <= closest:
                        closest = distance
                        foot = s
                # somewhere between them a curve that passes y lies level with the point
                if (heights[k - 1] < y) != (heights[k] < y):
                    bound = min(bound, max(abs(places[k - 1] - x), abs(places[k] - x)))
            bound = min(bound, closest)
            if not bound < 0.5 * reach:
                break
            reach = bound
        f, slope, second = _on_graph(foot, graph)
        gap[n], normal[0, n], normal[1, n], curvature[n] = seen_from(x, y, (foot, f, slope, second))


@inlined
def _on_graph(x: float, graph: tuple[FloatArray, FloatArray]) -> tuple[float, float, float]:
    """Return f, f' and f''."""
    parameters, at = graph
    curve = _curve_at(int(parameters[0]))
    at[0, 0] = x
    curve(at[0], parameters, 1, at[1], at[2], at[3])
    return at[1, 0], at[2, 0], at[3, 0]


@inlined
def minimum(
    curve: Any, constants: Any, x: float, y: float, low: float, start: float, high: float
) -> tuple[float, float, float, float]:
    """Root s of g in a bracket where it rises, by Newton's method, with f, f' and f'' there.

    Where Newton's step would leave the bracket, or not halve the last one, the bracket is halved.
    """
    s = start
    width = high - low
    step = width
    for _ in range(_MOST_STEPS):
        f, slope, second = curve(s, constants)
        above = f - y
        g = (s - x) + above * slope
        if g < 0.0:
            low = s
        else:
            high = s
        last = step
        step = -g / (1.0 + slope**2 + above * second)
        if not (low <= s + step <= high and abs(step) <= 0.5 * abs(last)):
            step = 0.5 * (low + high) - s
        s += step
        if abs(step) <= 1e-16 * (abs(s) + width):
            break
    f, slope, second = curve(s, constants)
    return s, f, slope, second


@inlined
def seen_from(
    x: float, y: float, closest: tuple[float, float, float, float]
) -> tuple[float, float, float, float]:
    """Gap, normal and curvature of the closest point s, of which f, f' and f'' are known."""
    s, f, slope, second = closest
    length = np.hypot(1.0, slope)
    normal_x, normal_y = -slope / length, 1.0 / length
    # along the normal, because an error of s then counts by its square only
    return (x - s) * normal_x + (y - f) * normal_y, normal_x, normal_y, -second / length**3
