"""Sizes of bodies, which positions and gaps are compared with."""

import numpy as np

from isopeel.problem import Body, Problem

#: Motions and gaps are told apart from none by more than this share of the body's own size.
ROUND_OFF = 1e-9


def extent(problem: Problem) -> float:
    """Return the size of the largest body."""
    return max(extent_of(body) for body in problem.bodies)


def extent_of(body: Body) -> float:
    """Return the size of a body: of the box about its control points."""
    return float(np.ptp(body.shape.control_points.reshape(-1, 2), axis=0).max())
