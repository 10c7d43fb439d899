"""A smooth curve through the nodes of a side of Lagrange elements, on which closest points are found."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline
from test_facing import FLAT, LAW, LOWER, SOFT, deformed, facing, system_of

from isopeel import Body, Flat, InputError, Interface, row_space
from isopeel.assembly.closest_point_kernel import CORNER, SMOOTH
from isopeel.assembly.facing_curve import FacingCurve
from isopeel.assembly.smoothed_curve import smoothed_curve
from isopeel.assembly.spaces import Spaces
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.physics.joints import XuNeedleman
from isopeel.problem import Scheme
from isopeel.splines.nurbs import NurbsSurface
from isopeel.splines.space import SplineSpace


def evaluated(curve: FacingCurve, coefficients: FloatArray, places: FloatArray) -> FloatArray:
    """Positions (segments, n, 2) at places (n,) of all segments."""
    s = places[:, None]
    basis = np.concatenate([(1 - s) ** 3, 3 * s * (1 - s) ** 2, 3 * s**2 * (1 - s), s**3], axis=1)
    moved = np.einsum("emk,emi->eik", curve.values, coefficients[curve.functions])
    positions: FloatArray = np.einsum("nk,eik->eni", basis, curve.shape + moved)
    return positions


@pytest.mark.parametrize("name", ["L1", "L2", "L3"])
def test_the_curve_is_the_hermite_spline_of_the_nodes(name: str) -> None:
    """Of SciPy, with the second-order differences of NumPy as tangents, on elements of several lengths."""
    problem = facing(FLAT, "bottom")
    spaces = Spaces.on(
        problem, {"upper": row_space("N2", (3, 1)), "lower": row_space(name, (5, 1), grading=(3.0, 1.0))}
    )
    u = 0.1 * np.random.default_rng(0).standard_normal((spaces.size, 2))
    curve = smoothed_curve(spaces, LOWER.side("top"))
    space, lower = spaces.of["lower"], spaces.places["lower"]
    degree, ends = space.degree, space.rows[0].breakpoints
    nodes = np.concatenate([*(np.linspace(*pair, degree + 1)[:-1] for pair in pairwise(ends)), [1.0]])
    basis = space.basis(nodes, np.ones(nodes.size), 0)
    moved = np.einsum("nm,nmi->ni", basis.values, u[lower][basis.functions])
    positions = LOWER.shape.evaluate(nodes, np.ones(nodes.size)) + moved
    spline = CubicHermiteSpline(nodes, positions, np.gradient(positions, nodes, axis=0, edge_order=2))
    at = np.linspace(0.0, 1.0, 5)
    wanted = spline(curve.ends[:-1, None] + np.diff(curve.ends)[:, None] * at)
    # round-off of differences over the shortest distance of nodes
    np.testing.assert_allclose(evaluated(curve, u, at), wanted, rtol=0, atol=1e-12)


def smoothed_system(scheme: Scheme) -> System:
    return system_of(facing(FLAT, "bottom", scheme, smoothed=True), "L3", "L2")


@pytest.mark.parametrize("scheme", ["unbiased", "biased", "two-half-pass"])
def test_tangents_of_a_smoothed_side_are_differences_of_forces(scheme: Scheme) -> None:
    system = smoothed_system(scheme)
    u = deformed(system)
    _, matrix = system.linearize(u, "general")
    b, n = matrix.half_bandwidth, system.constraints.count
    z = np.random.default_rng(1).standard_normal(n)
    unknowns, change = system.constraints.unknowns, np.zeros(u.shape)
    change[unknowns >= 0] = z[unknowns[unknowns >= 0]]
    step = 1e-6
    one, other = (system.equilibrium(u + sign * step * change).residual for sign in (1, -1))
    slope = (one - other) / (2 * step)
    product = np.zeros(n)
    for j in range(n):
        rows = np.arange(max(0, j - b), min(n, j + b + 1))
        product[rows] += matrix.entries[j, 2 * b + rows - j] * z[j]
    # as of the sides themselves
    np.testing.assert_allclose(product, slope, atol=2e-8 * np.abs(slope).max())


@pytest.mark.parametrize("scheme", ["unbiased", "biased"])
def test_forces_on_the_nodes_conserve_momentum(scheme: Scheme) -> None:
    system = smoothed_system(scheme)
    u, change = deformed(system), deformed(system, 1.0, 2)
    forces = system.equilibrium(u).forces - system.without_joint().equilibrium(u).forces
    step = 1e-6
    one, other = (system.equilibrium(u + sign * step * change).adhesive_energy for sign in (1, -1))
    assert np.sum(forces * change) == pytest.approx((one - other) / (2 * step), rel=1e-8)
    # to round-off, as of the sides themselves
    assert np.abs(forces.sum(axis=0)).max() < 1e-14 * np.abs(forces).sum()
    x = system.spaces.control_points() + u
    moment = np.sum(x[:, 0] * forces[:, 1] - x[:, 1] * forces[:, 0])
    assert abs(moment) < 1e-12 * np.abs(x).max() * np.abs(forces).sum()


def test_partners_on_a_smoothed_side_meet_no_corners() -> None:
    plain, smooth = (
        system_of(facing(FLAT, "bottom", "biased", smoothed=smoothed), lower="L1")
        for smoothed in (False, True)
    )
    u = deformed(plain, 0.2)
    assert (plain.facing[0].partners(u).kind == CORNER).any()
    found = smooth.facing[0].partners(u)
    assert (found.kind == SMOOTH).sum() > 10
    assert not (found.kind == CORNER).any()


def test_a_corner_of_the_shape_stays_a_corner() -> None:
    """A roof, which parabolas across its ridge would bend."""
    points = np.array([[[0.0, -2.0], [0.0, -1.0]], [[5.0, -2.0], [5.0, 0.0]], [[10.0, -2.0], [10.0, -1.0]]])
    spaces = SplineSpace.uniform(1, 0, 2), SplineSpace.uniform(1, 0, 1)
    roof = Body(NurbsSurface(spaces, points, np.ones((3, 2))), SOFT, "lower")
    joint = Interface(FLAT.side("bottom"), LAW, roof.side("top"), scheme="biased", smoothed=True)
    problem = replace(facing(FLAT, "bottom"), bodies=(FLAT, roof), interfaces=(joint,))
    meshes = {"upper": row_space("N2", (7, 2), 2), "lower": row_space("L2", (6, 2), 2)}
    curve = smoothed_curve(Spaces.on(problem, meshes), roof.side("top"))
    at = evaluated(curve, np.zeros((1000, 2)), np.linspace(0.0, 1.0, 9))
    np.testing.assert_allclose(at[..., 1], -np.abs(at[..., 0] - 5.0) / 5.0, atol=1e-14)


def test_what_cannot_be_smoothed_is_refused() -> None:
    with pytest.raises(InputError, match=r"interface\.1\.smoothed: True.*it needs Lagrange elements"):
        system_of(facing(FLAT, "bottom", smoothed=True))
    # of a biased energy, closest points are found on the second side only
    with pytest.raises(InputError, match=r"interface\.1\.smoothed: True.*it needs Lagrange elements"):
        system_of(facing(FLAT, "bottom", "biased", smoothed=True), "L2", "N2")
    for law, against in ((LAW, Flat()), (XuNeedleman(0.1, 0.1, 0.1), LOWER.side("top"))):
        with pytest.raises(InputError, match=r"adhesion\.smoothed: True.*side of another body"):
            Interface(FLAT.side("bottom"), law, against, smoothed=True)
