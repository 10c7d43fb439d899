"""Joints of fixed pairs between two bodies: jumps, forces and tangents."""

from dataclasses import replace

import numpy as np
import pytest

from isopeel import (
    Body,
    Flat,
    InputError,
    Interface,
    MixedModeBilinear,
    MovedSide,
    NeoHooke,
    Problem,
    Support,
    XuNeedleman,
    row_space,
)
from isopeel.assembly.pair_term import PairTerm
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.physics.joints import JointLaw
from isopeel.problem.place import placed
from isopeel.splines.nurbs import annulus_sector, rectangle

SOFT = NeoHooke(1.0, 0.3)
LOWER = Body(placed(rectangle(10.0, 2.0), (0.0, -2.0), 0.0), SOFT, "lower")
FLAT = Body(placed(rectangle(8.0, 1.0), (0.5, 0.1), 0.0), SOFT, "upper")
#: A ring's sector, with weights, hollow downwards: its pairs have distances from 0.4 to 0.8.
BENT = Body(placed(annulus_sector(12.0, 13.0, 0.5), (5.0, -11.6), np.pi / 2 - 0.25), SOFT, "upper")
EXPONENTIAL = XuNeedleman(0.3, 0.2, 0.1, 0.8, 0.2)
BILINEAR = MixedModeBilinear(0.3, 0.2, 0.1, 0.15, 0.3)


def joined(upper: Body, law: JointLaw, end: float = 1.0) -> Problem:
    return Problem(
        "joined",
        (upper, LOWER),
        (Interface(upper.side("bottom", end=end), law, LOWER.side("top")),),
        (Support(LOWER.side("bottom"), (0, 1)),),
        MovedSide(upper.side("top"), 1.0, "held"),
    )


def system_of(problem: Problem) -> System:
    top = problem.body_of("upper").shape
    spaces = {"upper": row_space("N2", (7, 2), 2, shape=top), "lower": row_space("N2.1", (11, 2), 2)}
    return System(problem, spaces)


def deformed(system: System, size: float = 0.05, seed: int = 0) -> FloatArray:
    rng = np.random.default_rng(seed)
    return size * rng.standard_normal((system.spaces.size, 2))


def damaged(system: System) -> System:
    """Return a system of which half of the points are damaged, each with a mixity of its own."""
    (term,) = system.interfaces
    assert isinstance(term, PairTerm)
    if not term.law.history:
        return system
    rng = np.random.default_rng(4)
    points = term.paired.size
    damage = np.where(rng.random(points) < 0.5, 0.6, 0.0)
    history = np.concatenate([damage, rng.random(points), 0.01 * damage])
    return system.after(history.reshape(system.maximum_openings.shape))


@pytest.mark.parametrize("law", [EXPONENTIAL, BILINEAR], ids=lambda law: law.name)
@pytest.mark.parametrize("upper", [FLAT, BENT], ids=["flat", "bent"])
def test_tangents_are_symmetric_and_differences_of_forces(upper: Body, law: JointLaw) -> None:
    system = damaged(system_of(joined(upper, law)))
    u = deformed(system)
    _, matrix = system.linearize(u, "general")
    unknowns, count = system.constraints.unknowns, system.constraints.count
    b = matrix.half_bandwidth
    full = np.zeros((count, count))
    for j in range(count):
        rows = np.arange(max(0, j - b), min(count, j + b + 1))
        full[rows, j] = matrix.entries[j, 2 * b + rows - j]
    # round-off of sums over a hundred entries
    np.testing.assert_allclose(full, full.T, atol=1e-14 * np.abs(full).max())
    z = np.random.default_rng(1).standard_normal(count)
    change = np.zeros(u.shape)
    change[unknowns >= 0] = z[unknowns[unknowns >= 0]]
    step = 1e-7
    two = [system.equilibrium(u + sign * step * change).residual for sign in (1, -1)]
    slope = (two[0] - two[1]) / (2 * step)
    # central differences of a step of 1e-7 have errors of 1e-14 f''' and of 1e-16/1e-7 of the forces
    np.testing.assert_allclose(full @ z, slope, atol=2e-8 * np.abs(slope).max())
    # the lower half, as it is stored for a symmetric factor
    _, lower = system.linearize(u, "symmetric")
    for j in range(count):
        rows = np.arange(j, min(count, j + lower.half_bandwidth + 1))
        np.testing.assert_allclose(lower.entries[j, : rows.size], full[rows, j], atol=1e-14)


@pytest.mark.parametrize("law", [EXPONENTIAL, BILINEAR], ids=lambda law: law.name)
@pytest.mark.parametrize("upper", [FLAT, BENT], ids=["flat", "bent"])
def test_forces_are_derivatives_of_the_energy_and_conserve_momentum(upper: Body, law: JointLaw) -> None:
    system = damaged(system_of(joined(upper, law)))
    u, change = deformed(system), deformed(system, 1.0, 2)
    loose = system.without_joint()
    forces = system.equilibrium(u).forces - loose.equilibrium(u).forces
    step = 1e-6
    found = [system.equilibrium(u + sign * step * change) for sign in (1, -1)]
    energies = [one.adhesive_energy + one.dissipated_energy for one in found]
    slope = (energies[0] - energies[1]) / (2 * step)
    assert np.sum(forces * change) == pytest.approx(slope, rel=1e-7)
    # action and reaction, and their moments about the origin, to round-off
    assert np.abs(forces.sum(axis=0)).max() < 1e-14 * np.abs(forces).sum()
    x = system.spaces.control_points() + u
    moment = np.sum(x[:, 0] * forces[:, 1] - x[:, 1] * forces[:, 0])
    assert abs(moment) < 1e-13 * np.abs(x).max() * np.abs(forces).sum()


def test_a_rigid_motion_of_both_bodies_opens_nothing() -> None:
    system = system_of(joined(BENT, EXPONENTIAL))
    (term,) = system.interfaces
    assert isinstance(term, PairTerm)
    turn, x = 0.7, system.spaces.control_points()
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    jumps = np.abs(term.opening(x @ rotation.T + np.array([3.0, -1.0]) - x))
    assert jumps.max() < 1e-14 * np.abs(x).max()


def test_jump_rates_are_those_of_the_distances_of_pairs_that_are_joined() -> None:
    system = system_of(joined(BENT, EXPONENTIAL))
    (term,) = system.interfaces
    assert isinstance(term, PairTerm)
    rates = system.jump_rates()
    assert rates is not None
    z = np.random.default_rng(2).standard_normal(system.constraints.count)
    rest, u = (system.constraints.displacement(one, 0.0) for one in (0 * z, z))
    change = term.directions(u)[1] - term.directions(rest)[1]
    weighted = change * np.sqrt(np.where(term.paired, term.table.weights, 0.0)).reshape(-1, 1)
    np.testing.assert_allclose(rates @ z, weighted.T.ravel(), atol=1e-13)
    # faces of a crack are not joined
    cracked = system_of(joined(BENT, replace(BILINEAR, initial_damage=1.0)))
    assert cracked.jump_rates() is None


def test_pairs_are_closest_points_of_the_undeformed_sides() -> None:
    over = replace(FLAT, shape=placed(rectangle(8.0, 1.0), (6.1, 0.1), 0.0))
    (term,) = system_of(joined(over, EXPONENTIAL)).interfaces
    assert isinstance(term, PairTerm)
    np.testing.assert_array_equal(term.paired, term.table.positions[..., 0] < 10.0)
    np.testing.assert_allclose(term.distances[term.paired], [[0.0, 0.1]] * term.paired.sum(), atol=1e-14)


def test_a_joint_law_needs_another_body_and_a_side_that_faces_it() -> None:
    with pytest.raises(InputError, match=r"adhesion\.law: 'xu-needleman'.*two bodies"):
        Interface(FLAT.side("bottom"), EXPONENTIAL, Flat())
    with pytest.raises(InputError, match=r"adhesion\.irreversible: True"):
        Interface(FLAT.side("bottom"), BILINEAR, LOWER.side("top"), irreversible=True)
    with pytest.raises(InputError, match=r"adhesion\.scheme: 'biased'"):
        Interface(FLAT.side("bottom"), BILINEAR, LOWER.side("top"), scheme="biased")
    away = replace(
        joined(FLAT, BILINEAR), interfaces=(Interface(FLAT.side("top"), BILINEAR, LOWER.side("top")),)
    )
    with pytest.raises(InputError, match=r"between: 'upper\.top and lower\.top' .*no point faces the other"):
        system_of(away)
