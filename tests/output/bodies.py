"""Bodies for the tests of this folder."""

import numpy as np

from isopeel import (
    Body,
    Boundary,
    CurvedStrip,
    Flat,
    HalfCylinder,
    Interface,
    NeoHooke,
    Problem,
    VanDerWaals,
    row_space,
    strip,
)
from isopeel.common.arrays import FloatArray
from isopeel.post.fields import as_rows, on_grid
from isopeel.splines.nurbs import NurbsSurface, Side, annulus_sector
from isopeel.splines.rows import RowSpace
from isopeel.splines.space import SplineSpace


def kinked() -> NurbsSurface:
    """A bar of two straight halves that meet at an angle, within an element where their number is odd."""
    points = np.array([[[0.0, 0.0], [0.0, 1.0]], [[2.0, 0.0], [2.0, 1.0]], [[3.5, 1.5], [3.0, 2.5]]])
    return NurbsSurface((SplineSpace.uniform(1, 0, 2), SplineSpace.uniform(1, 0, 1)), points, np.ones((3, 2)))


#: Shapes, spaces on them, and the degrees of the cells that hold both.
BODIES = {
    "strip": (strip().body.shape, row_space("L1+N2.1", (12, 3)), (3, 1)),
    "half cylinder": (HalfCylinder(10.0).surface(), row_space("N3", (5, 4), 2), (3, 2)),
    "curved strip": (CurvedStrip(20.0, 2.0, 15.0).surface(), row_space("N2.1", (6, 2)), (3, 1)),
    # linear rows do not hold the weights of an arc: degrees add up
    "linear rows on an arc": (annulus_sector(10.0, 20.0, 2.0), row_space("L1", (5, 2)), (3, 2)),
    "linear rows above": (annulus_sector(10.0, 20.0, 2.0), row_space("L1+N3", (5, 2)), (5, 2)),
    # two pieces of one element
    "kinked": (kinked(), row_space("N2", (5, 2)), (2, 1)),
}


def body(name: str, side: Side = "bottom") -> tuple[Problem, RowSpace]:
    """A body, and the space of its displacement; a part of a side adheres."""
    shape, space, _ = BODIES[name]
    lowest = float(shape.control_points[..., 1].min())
    law = VanDerWaals(hamaker_constant=0.05, equilibrium_distance=0.4)
    adhesion = Interface(Boundary("body", side, 0.1, 0.75), law, Flat(lowest - 0.3))
    return strip().changed(body=Body(shape, NeoHooke(1.0, 0.2)), adhesion=adhesion), space


def displacement(problem: Problem, space: RowSpace) -> FloatArray:
    """Coefficients (size, 2) of a stretch and some noise that turns no element inside out."""
    shape = problem.body.shape
    gradient = np.array([[0.2, 0.1], [-0.3, 0.1]])
    smooth = space.weighted(shape).interpolate(lambda xi, eta: shape.evaluate(xi, eta) @ gradient.T)
    noise = np.random.default_rng(2).uniform(-1, 1, smooth.shape)
    return smooth + 0.002 * float(np.ptp(shape.control_points[..., 0])) * noise


def exact(problem: Problem, space: RowSpace, coefficients: FloatArray, xi: float, eta: float) -> FloatArray:
    """Position at rest and displacement, (2, 2), by the shape's and the space's own functions."""
    at = np.array([[xi]]), np.array([[eta]])
    own = space.weighted(problem.body.shape), coefficients
    return np.stack([on_grid(*field, *at)[0].ravel() for field in (as_rows(problem.body.shape), own)])
