"""Random spline spaces and weights for the tests of this folder."""

from collections import Counter

import numpy as np
import splinepy
from hypothesis import strategies as st

from isopeel.common.arrays import FloatArray
from isopeel.splines.space import SplineSpace


@st.composite
def spaces(draw: st.DrawFn, highest_degree: int = 7) -> SplineSpace:
    """Spaces on any interval, with up to six elements of widths up to 50:1 and any inner multiplicities."""
    degree = draw(st.integers(1, highest_degree))
    widths = draw(st.lists(st.integers(1, 50), min_size=1, max_size=6))
    inner = [draw(st.integers(1, degree)) for _ in widths[1:]]
    start, unit = draw(st.sampled_from([(0.0, 0.02), (-3.0, 0.1), (10.0, 1.0)]))
    breakpoints = start + unit * np.cumsum([0, *widths])
    return SplineSpace(degree, np.repeat(breakpoints, [degree + 1, *inner, degree + 1]))


def points_in(space: SplineSpace, seed: int, count: int = 40) -> FloatArray:
    """Random points of the interval, and all breakpoints."""
    inside = np.random.default_rng(seed).uniform(space.breakpoints[0], space.breakpoints[-1], count)
    return np.concatenate([space.breakpoints, inside])


def new_knots(space: SplineSpace, seed: int) -> FloatArray:
    """Some knots that can be added: at existing breakpoints where they have room, between them, one twice."""
    rng = np.random.default_rng(seed)
    room = space.breakpoints[1:-1][space.continuities > 0]
    element = rng.integers(space.elements)
    between = space.breakpoints[element] + np.diff(space.breakpoints)[element] * rng.uniform(0.1, 0.9, 2)
    double = [between[0]] if space.degree > 1 else []
    return np.concatenate([room, between, double])


def superfluous_knots(elevated: splinepy.Spline, space: SplineSpace, direction: int = 0) -> FloatArray:
    """The knots that splinepy has more often than needed, as its elevation removes knots to a tolerance."""
    more = Counter(np.array(elevated.knot_vectors[direction])) - Counter(space.knot_vector)
    return np.array(list(more.elements()))


seeds = st.integers(0, 2**32 - 1)
