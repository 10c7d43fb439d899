"""Closest-point projection on the graph y = f(x) of a smooth function, the solid below it.

The closest point (s, f(s)) to (x, y) is a minimum of the distance, at which
g(s) = (s - x) + (f(s) - y) f'(s) turns from negative to positive. All compiled code of this subject is in
one file, because stored machine code is renewed when its own file changes, and only then.
"""

from typing import Any

import numpy as np
from numba import float64, int64, njit, void

from isopeel.common.arrays import FloatArray
from isopeel.common.compilation import compiled
from isopeel.physics.batch import SUBSTRATE_SIGNATURE, BatchFunction, compile_batch

_VECTOR = float64[::1]

#: (place x (n), parameters, n, f (n), f' (n), f'' (n)) of a curve
CURVE_SIGNATURE = void(_VECTOR, _VECTOR, int64, _VECTOR, _VECTOR, _VECTOR)

_SAMPLES = 65  # an odd number: the one in the middle lies straight below or above the point
_MOST_STEPS = 100  # halving alone needs 53 to the last digit

# a compiled function handed on as an argument is inlined, because else the result could not be stored
_inlined = njit(inline="always", error_model="numpy")


def graph_kernel(curve: BatchFunction) -> BatchFunction:
    """Batch function of gap, normal and curvature for a compiled curve of `CURVE_SIGNATURE`.

    The closest point is the true one where the curve has no bump, dip or step narrower than a tenth of its
    distance straight below or above the point; else it may be another minimum of the distance. All is nan
    where f has no value there, or ends where it would be closest.
    """

    def batch(
        position: FloatArray,
        parameters: FloatArray,
        count: int,
        gap: FloatArray,
        normal: FloatArray,
        curvature: FloatArray,
    ) -> None:
        _project_on_graph(curve, position, parameters, count, gap, normal, curvature)

    return compile_batch(SUBSTRATE_SIGNATURE, batch, cache=False)


@compiled
def _project_on_graph(
    curve: Any, position: Any, parameters: Any, count: int, gap: Any, normal: Any, curvature: Any
) -> None:
    samples = np.empty((4, _SAMPLES))
    square = np.empty(_SAMPLES)
    at = np.empty((4, 1))
    last = _SAMPLES - 1
    for n in range(count):
        x = position[0, n]
        y = position[1, n]
        _evaluate(curve, parameters, x, at)
        reach = abs(at[1, 0] - y)
        bound = closest = np.inf
        foot = np.nan
        # nothing farther along x than a known distance can be closer; near a steep slope the first distance,
        # straight down, is much too large, and the samples narrow down on what is left
        while True:
            for k in range(_SAMPLES):
                samples[0, k] = x + reach * (2 * k - last) / last
            curve(samples[0], parameters, _SAMPLES, samples[1], samples[2], samples[3])
            for k in range(_SAMPLES):
                square[k] = (samples[0, k] - x) ** 2 + (samples[1, k] - y) ** 2
            for k in range(1, last):
                if square[k] <= square[k - 1] and square[k] <= square[k + 1]:
                    low, start, high = samples[0, k - 1], samples[0, k], samples[0, k + 1]
                    s = _minimum(curve, parameters, x, y, low, start, high, at)
                    distance = np.hypot(s - x, at[1, 0] - y)
                    if distance <= closest:
                        closest = distance
                        foot = s
                # somewhere between them a curve that passes y lies level with the point
                if (samples[1, k - 1] < y) != (samples[1, k] < y):
                    bound = min(bound, max(abs(samples[0, k - 1] - x), abs(samples[0, k] - x)))
            bound = min(bound, closest)
            if not bound < 0.5 * reach:
                break
            reach = bound
        _evaluate(curve, parameters, foot, at)
        _write(x, y, at, n, gap, normal, curvature)


def project_on_wave(
    position: FloatArray,
    parameters: FloatArray,
    count: int,
    gap: FloatArray,
    normal: FloatArray,
    curvature: FloatArray,
) -> None:
    """Batch function of y = h + a cos(q x + phi), parameters (h, a, q, phi).

    A crest and a trough next to each other mirror the curve, so that the closest point lies in the same half
    wave as x. There g has one root only: with c the cosine, g' = 1 + A^2 + A q (y - h) c - 2 A^2 c^2 for
    A = a q, positive at c = 0, is positive between two places, and beyond them g has the sign that it has at
    the crest or trough. This holds for points at any distance.
    """
    at = np.empty((4, 1))
    height, amplitude, number, phase = parameters[0], parameters[1], parameters[2], parameters[3]
    for n in range(count):
        x = position[0, n]
        y = position[1, n]
        half = np.floor((number * x + phase) / np.pi)
        start = (half * np.pi - phase) / number
        # the half wave as a cosine from 0 to pi, of amplitude A/q of either sign
        A = amplitude * number * (1.0 if half % 2.0 == 0.0 else -1.0)
        B = number * (y - height) * (1.0 if A >= 0.0 else -1.0)
        # the two roots c, without loss of digits: one by the quadratic formula, one by their product
        root = abs(B) + np.sqrt(B * B + 8.0 * (1.0 + A * A))
        large = min(root / (4.0 * abs(A)), 1.0)
        small = min(2.0 * (1.0 + A * A) / (abs(A) * root), 1.0)
        low = start + np.arccos(large if B >= 0.0 else small) / number
        high = start + np.arccos(-small if B >= 0.0 else -large) / number
        _minimum(_wave, parameters, x, y, low, min(max(x, low), high), high, at)
        _write(x, y, at, n, gap, normal, curvature)


@compiled
def _wave(place: Any, parameters: Any, count: int, height: Any, slope: Any, second: Any) -> None:
    amplitude, number = parameters[1], parameters[2]
    for n in range(count):
        angle = number * place[n] + parameters[3]
        height[n] = parameters[0] + amplitude * np.cos(angle)
        slope[n] = -amplitude * number * np.sin(angle)
        second[n] = -amplitude * number**2 * np.cos(angle)


@_inlined
def _minimum(
    curve: Any, parameters: Any, x: float, y: float, low: float, start: float, high: float, at: Any
) -> float:
    """Root of g in a bracket where it rises, by Newton's method; the curve at the root comes in `at`.

    Where Newton's step would leave the bracket, or not halve the last one, the bracket is halved.
    """
    s = start
    width = high - low
    step = width
    for _ in range(_MOST_STEPS):
        _evaluate(curve, parameters, s, at)
        above = at[1, 0] - y
        g = (s - x) + above * at[2, 0]
        if g < 0.0:
            low = s
        else:
            high = s
        last = step
        step = -g / (1.0 + at[2, 0] ** 2 + above * at[3, 0])
        if not (low <= s + step <= high and abs(step) <= 0.5 * abs(last)):
            step = 0.5 * (low + high) - s
        s += step
        if abs(step) <= 1e-16 * (abs(s) + width):
            break
    _evaluate(curve, parameters, s, at)
    return s


@_inlined
def _evaluate(curve: Any, parameters: Any, s: float, at: Any) -> None:
    """Set `at` (4, 1) to s, f, f' and f''."""
    at[0, 0] = s
    curve(at[0], parameters, 1, at[1], at[2], at[3])


@compiled
def _write(x: float, y: float, at: Any, n: int, gap: Any, normal: Any, curvature: Any) -> None:
    slope = at[2, 0]
    length = np.hypot(1.0, slope)
    normal[0, n] = -slope / length
    normal[1, n] = 1.0 / length
    # along the normal, because an error of s then counts by its square only
    gap[n] = (x - at[0, 0]) * normal[0, n] + (y - at[1, 0]) * normal[1, n]
    curvature[n] = -at[3, 0] / length**3
