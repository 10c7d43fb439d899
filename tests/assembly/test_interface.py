"""The evaluation of the interface against the forces and energies that the solver assembles."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from isopeel import (
    Body,
    Boundary,
    Circle,
    Exponential,
    Flat,
    InputError,
    Interface,
    NeoHooke,
    Problem,
    VanDerWaals,
    Wavy,
    row_space,
    strip,
)
from isopeel.assembly.interface import InterfacePoints
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.splines.nurbs import rectangle

LAW = VanDerWaals(hamaker_constant=0.05, equilibrium_distance=0.4)
PEAKED = Exponential(strength=0.05, work_of_adhesion=0.02, equilibrium_gap=0.3)
SPACE = row_space("N2", (20, 2))
RANDOM = np.random.default_rng(5)
WIDE = 0.4 * RANDOM.random((SPACE.size, 2))
CLOSER = 0.3 * WIDE + 0.05 * RANDOM.random((SPACE.size, 2))

flat = Interface(Boundary("body", "bottom", end=0.7), LAW, Flat(-0.3))
SIDES = {
    "flat": flat,
    "projected": replace(flat, traction="projected"),
    "circle": replace(flat, against=Circle(50.0, "inside", (5.0, -50.3))),
    "wavy": replace(flat, against=Wavy(0.1, 15.0, height=-0.5)),
    "wavy, projected": replace(flat, against=Wavy(0.1, 15.0, height=-0.5), traction="projected"),
    "sliding": replace(flat, law=PEAKED, sliding_length=0.5),
    "sliding on waves": replace(flat, law=PEAKED, sliding_length=0.5, against=Wavy(0.1, 15.0, height=-0.5)),
    "irreversible": replace(flat, law=PEAKED, irreversible=True),
    "irreversible, van der Waals": replace(
        flat, irreversible=True, against=Circle(5e3, "inside", (5.0, -5000.25))
    ),
    "irreversible, projected": replace(flat, law=PEAKED, irreversible=True, traction="projected"),
    "top": replace(
        flat, boundary=Boundary("body", "top", end=0.7), against=Circle(50.0, "inside", (5.0, 52.4))
    ),
    "right": replace(
        flat,
        boundary=Boundary("body", "right", end=0.8),
        against=Circle(30.0, "inside", (50.4, 1.0)),
    ),
}


def problem_with(side: Interface) -> Problem:
    return strip().changed(body=Body(rectangle(20.0, 2.0), NeoHooke(1.0, 0.2)), adhesion=side)


@pytest.mark.parametrize("name", SIDES)
def test_tractions_and_energies_integrate_to_those_assembled(name: str) -> None:
    problem = problem_with(SIDES[name])
    system = System(problem, SPACE)
    system = system.after(system.commit(WIDE))
    history, points = system.maximum_openings, InterfacePoints.of_contact(problem, SPACE)
    found = points.state(CLOSER, history)
    assembled = system.equilibrium(CLOSER)
    # of the adhesion alone: without the same body whose joint exerts no force
    forces = system.without_joint().equilibrium(CLOSER).forces - assembled.forces
    side = forces[SPACE.side_functions(problem.adhesion.side)]
    total = np.einsum("nk,nkc->c", points.lengths, found.traction)
    size = np.abs(points.lengths[..., None] * found.traction).sum()
    # relative to the sum of sizes: round-off of two sums over some 50 points
    np.testing.assert_allclose(total, side.sum(axis=0), atol=1e-12 * size)
    assert np.abs(total).max() > 1e-3
    energies = (points.lengths * found.energy).sum(), (points.lengths * found.dissipated).sum()
    expected = assembled.adhesive_energy, assembled.dissipated_energy
    np.testing.assert_allclose(energies, expected, atol=1e-12 * np.abs(expected).max())
    if problem.adhesion.irreversible:
        virgin = points.state(CLOSER, np.zeros_like(history))
        # half of the points have closed again by more than half: what was lost shows
        assert np.abs(virgin.traction - found.traction).max() > 0.1 * np.abs(found.traction).max()


def test_unloading_lies_on_the_secant_at_points_of_the_assembly_and_in_between() -> None:
    """A stiff block lifted by 0.6 and let down to 0.25: all points have the same history."""
    problem = problem_with(SIDES["irreversible"])
    lift = np.zeros((SPACE.size, 2))
    system = System(problem, SPACE)
    for height in (0.6, 0.25):
        lift[:, 1] = height
        system = system.after(system.commit(lift))
    tried = np.linspace(0.0, 0.7, 15)[:-1, None] + 0.05 * np.linspace(0.0, 1.0, 7)
    found = InterfacePoints(problem, SPACE, tried).state(lift, system.maximum_openings)
    d = 0.02 / (np.e * 0.05)
    envelope = -0.02 * 0.6 / d**2 * np.exp(-0.6 / d)
    # round-off of the opening, a difference of numbers below 1, over 0.25
    np.testing.assert_allclose(found.normal_traction, 0.25 / 0.6 * envelope, rtol=1e-14 / 0.25)
    np.testing.assert_allclose(found.opening, 0.6, rtol=1e-14)
    np.testing.assert_array_equal(found.tangential_traction, 0.0)
    assert found.softening.all()
    np.testing.assert_allclose(found.stretch, 1.0, rtol=1e-14)


def test_further_opening_leaves_the_envelope_between_the_points_of_the_assembly() -> None:
    """A lifted block is tilted: while it opens, its history is the present opening everywhere."""
    problem = problem_with(SIDES["irreversible"])
    u = np.zeros((SPACE.size, 2))
    u[:, 1] = 0.02 + 0.03 * SPACE.interpolate(problem.body.shape.evaluate)[:, 0]
    system = System(problem, SPACE)
    system = system.after(system.commit(u))
    points = InterfacePoints(problem, SPACE, np.linspace(0.0, 0.7, 141)[:, None])
    found = points.state(u, system.maximum_openings)
    reversible = problem.changed(adhesion=replace(problem.adhesion, irreversible=False))
    virgin = InterfacePoints(reversible, SPACE, points.parameters).state(u)
    # the history is exact where nothing has closed: round-off of openings of 0.02 and more
    np.testing.assert_allclose(found.traction, virgin.traction, rtol=1e-12)
    np.testing.assert_array_equal(found.softening, virgin.softening)


def bump(xi: FloatArray, _eta: FloatArray, centre: float) -> FloatArray:
    lift = 0.5 * np.exp(-(((20 * xi - centre) / 4) ** 2))
    return np.stack([np.zeros_like(lift), lift], axis=-1)


def test_history_between_points_of_the_assembly_converges_with_the_elements() -> None:
    """The largest opening of a wave that moved on: a kink, met to first order, and smooth parts to second."""
    errors = []
    for elements in (20, 40, 80):
        space = row_space("N2", (elements, 2))
        problem = problem_with(
            replace(flat, boundary=Boundary("body", "bottom"), law=PEAKED, irreversible=True)
        )
        system = System(problem, space)
        for centre in (12.0, 8.0):
            u = space.interpolate(partial(bump, centre=centre))
            system = system.after(system.commit(u))
        points = InterfacePoints(problem, space, np.linspace(0.0, 1.0, 401)[:, None])
        x = 20 * points.parameters
        largest = 0.5 * np.exp(-(np.minimum(np.abs(x - 12), np.abs(x - 8)) ** 2) / 16)
        # the kink is at 10, and beyond the last points of the assembly the history is constant
        smooth = (np.abs(x - 10) > 1.1) & (np.abs(x - 10) < 9)
        errors.append(float(np.abs(points.state(u, system.maximum_openings).opening - largest)[smooth].max()))
    # halved elements: a quarter, to within the higher orders; at first 1 % of the opening
    assert errors[0] < 5e-3
    assert errors[1] < 0.35 * errors[0]
    assert errors[2] < 0.35 * errors[1]


def test_a_joint_that_has_not_closed_has_no_history() -> None:
    problem = problem_with(replace(SIDES["irreversible"], against=Flat(-0.5)))
    system = System(problem, SPACE)
    u = np.zeros((SPACE.size, 2))
    points = InterfacePoints.of_contact(problem, SPACE)
    found = points.state(u, system.maximum_openings)
    assert not found.opening.any()
    reversible = problem.changed(adhesion=replace(problem.adhesion, irreversible=False))
    virgin = InterfacePoints.of_contact(reversible, SPACE).state(u)
    np.testing.assert_array_equal(found.traction, virgin.traction)
    assert not found.dissipated.any()


def test_sliding_tractions_follow_the_potential_on_the_flat() -> None:
    """Xu and Needleman's potential at a slip of 0.2 and an opening of 0.1."""
    problem = problem_with(SIDES["sliding"])
    u = np.tile([0.2, 0.1], (SPACE.size, 1))
    found = InterfacePoints.of_contact(problem, SPACE).state(u)
    d = 0.02 / (np.e * 0.05)
    hold = np.exp(-((0.2 / 0.5) ** 2))
    normal = -0.02 * 0.1 / d**2 * np.exp(-0.1 / d) * hold
    well = -0.02 * (1 + 0.1 / d) * np.exp(-0.1 / d)
    tangential = well * 2 * 0.2 / 0.5**2 * hold
    # round-off of the gap, a difference of numbers below 1, over the opening of 0.1
    np.testing.assert_allclose(found.normal_traction, normal, rtol=1e-13)
    # the substrate's tangent points along -x where its normal points up
    np.testing.assert_allclose(np.abs(found.tangential_traction), -tangential, rtol=1e-13)
    np.testing.assert_allclose(found.traction[..., 0], tangential, rtol=1e-13)


def test_an_irreversible_joint_without_its_history_is_refused() -> None:
    problem = problem_with(SIDES["irreversible"])
    points = InterfacePoints.of_contact(problem, SPACE)
    for openings in (None, np.zeros((3, 3)), np.zeros(14)):
        with pytest.raises(InputError, match="openings"):
            points.state(WIDE, openings)
    with pytest.raises(InputError, match="displacement"):
        points.state(np.zeros((3, 2)), np.zeros((14, 3)))


def test_an_unknown_history_is_that_of_a_joint_never_opened_farther() -> None:
    problem = problem_with(SIDES["irreversible"])
    points = InterfacePoints.of_contact(problem, SPACE)
    unknown = points.state(CLOSER, np.full((14, 3), np.nan))
    np.testing.assert_array_equal(unknown.traction, points.state(CLOSER, np.zeros((14, 3))).traction)
