"""Refinement of a spline: the same function with more knots, a higher degree, or both.

Coefficients are (size, ...). Those of a NURBS are homogeneous, control points times weights and the weights.

The coefficient of a B-spline of degree p is the polar form of the spline at p successive knots. It is
evaluated in the element that contains the knot before these. There its weights are sums and products of
nonnegative numbers (the Oslo algorithm: Cohen, Lyche and Riesenfeld, 1980). So nothing cancels, and the
refinement is exact to round-off.
"""

import numpy as np
from numpy.typing import ArrayLike

from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.errors import InputError
from isopeel.splines.space import SplineSpace


def insert_knots(
    space: SplineSpace, coefficients: ArrayLike, knots: ArrayLike
) -> tuple[SplineSpace, FloatArray]:
    """Return the space with these knots added, and the spline's coefficients in it.

    Raises InputError for a knot that is not inside the interval or would occur more than degree times.
    """
    added = np.atleast_1d(np.asarray(knots, dtype=np.float64))
    start, end = space.breakpoints[[0, -1]]
    outside = ~((added > start) & (added < end))
    if np.any(outside):
        raise InputError("knots", float(added[outside][0]), f"new knots lie inside ({start:g}, {end:g})")
    refined = SplineSpace(space.degree, np.sort(np.append(space.knot_vector, added)))
    windows = _windows(refined, space.degree + 1)
    elements = space.element_of(windows[:, 0])
    return refined, _combine(space, space.polar_weights(windows[:, 1:], elements), elements, coefficients)


def elevate(space: SplineSpace, coefficients: ArrayLike, times: int) -> tuple[SplineSpace, FloatArray]:
    """Return the space with its degree raised and its continuities kept, and the coefficients in it."""
    if times < 0:
        raise InputError("times", times, "it must be 0 or more")
    elevated, result = space, _checked(space, coefficients)
    for _ in range(times):
        lower, degree = elevated, elevated.degree + 1
        elevated = SplineSpace(degree, np.repeat(lower.breakpoints, lower.multiplicities + 1))
        windows = _windows(elevated, degree + 1)
        elements = lower.element_of(windows[:, 0])
        # The polar form of the higher degree is the mean of those of the lower degree without one argument.
        left_out = np.stack([np.delete(windows[:, 1:], argument, axis=1) for argument in range(degree)])
        result = _combine(lower, lower.polar_weights(left_out, elements).mean(axis=0), elements, result)
    return elevated, result


def k_refine(
    space: SplineSpace, coefficients: ArrayLike, times: int, knots: ArrayLike
) -> tuple[SplineSpace, FloatArray]:
    """Return the space and coefficients after k-refinement (Hughes, Cottrell and Bazilevs, 2005).

    The degree is elevated first, then knots are inserted. In this order a space of degree p has p + times - 1
    continuous derivatives at the new knots; in the other order it would have p - 1.
    """
    return insert_knots(*elevate(space, coefficients, times), knots)


def _windows(space: SplineSpace, length: int) -> FloatArray:
    """Return the knots from each function's first knot on, (size, length)."""
    return np.lib.stride_tricks.sliding_window_view(space.knot_vector, length)[: space.size]


def _combine(
    space: SplineSpace, weights: FloatArray, elements: IntArray, coefficients: ArrayLike
) -> FloatArray:
    active = space.first_functions[elements][:, None] + np.arange(space.degree + 1)
    combined: FloatArray = np.einsum("ij,ij...->i...", weights, _checked(space, coefficients)[active])
    return combined


def _checked(space: SplineSpace, coefficients: ArrayLike) -> FloatArray:
    array = np.array(coefficients, dtype=np.float64)
    if array.shape[:1] != (space.size,):
        raise InputError(
            "coefficients", f"shape {array.shape}", f"the first axis must have the {space.size} functions"
        )
    return array
