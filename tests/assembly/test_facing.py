"""Sides of two bodies that face each other: closest points, forces, tangents."""

from dataclasses import replace

import numpy as np
import pytest

from isopeel import (
    Body,
    Interface,
    MovedSide,
    NeoHooke,
    Problem,
    Support,
    VanDerWaals,
    row_space,
)
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.problem.place import placed
from isopeel.splines.nurbs import annulus_sector, rectangle

SOFT = NeoHooke(1.0, 0.3)
LAW = VanDerWaals(0.05, 0.4)
LOWER = Body(placed(rectangle(10.0, 2.0), (0.0, -2.0), 0.0), SOFT, "lower")
FLAT = Body(placed(rectangle(8.0, 1.0), (0.5, 0.45), 0.0), SOFT, "upper")
#: A ring's sector, with weights, hollow downwards.
BENT = Body(placed(annulus_sector(12.0, 13.0, 0.5), (5.0, -11.6), np.pi / 2 - 0.25), SOFT, "upper")
SCHEMES = ("unbiased", "biased", "two-half-pass")


def facing(upper: Body, side: str, scheme: str = "unbiased", **values: object) -> Problem:
    joint = Interface(upper.side(side), LAW, LOWER.side("top"), scheme=scheme)  # type: ignore[arg-type]
    return Problem(
        "facing",
        (upper, LOWER),
        (replace(joint, **values),),  # type: ignore[arg-type]
        (Support(LOWER.side("bottom"), (0, 1)),),
        MovedSide(upper.side("top" if side != "top" else "bottom"), 1.0, "held"),
    )


def system_of(problem: Problem, upper: str = "N2", lower: str = "N2.1") -> System:
    top = problem.body_of("upper").shape
    spaces = {"upper": row_space(upper, (7, 2), 2, shape=top), "lower": row_space(lower, (11, 2), 2)}
    return System(problem, spaces)


def deformed(system: System, size: float = 0.05, seed: int = 0) -> FloatArray:
    rng = np.random.default_rng(seed)
    return size * rng.standard_normal((system.spaces.size, 2))


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("upper", [FLAT, BENT], ids=["flat", "bent"])
def test_tangents_are_differences_of_forces(scheme: str, upper: Body) -> None:
    system = system_of(facing(upper, "bottom", scheme))
    u = deformed(system)
    _, matrix = system.linearize(u, "general")
    unknowns, count = system.constraints.unknowns, system.constraints.count
    rng = np.random.default_rng(1)
    z = rng.standard_normal(count)
    change = np.zeros(u.shape)
    change[unknowns >= 0] = z[unknowns[unknowns >= 0]]
    step = 1e-6
    two = [system.equilibrium(u + sign * step * change).residual for sign in (1, -1)]
    b, n = matrix.half_bandwidth, count
    product = np.zeros(n)
    for j in range(n):
        for i in range(max(0, j - b), min(n, j + b + 1)):
            product[i] += matrix.entries[j, 2 * b + i - j] * z[j]
    slope = (two[0] - two[1]) / (2 * step)
    # central differences of a step of 1e-6 have errors of 1e-12 f''' and of 1e-16/1e-6 of the forces
    np.testing.assert_allclose(product, slope, atol=2e-8 * np.abs(slope).max())


@pytest.mark.parametrize("scheme", ["unbiased", "biased"])
def test_forces_are_derivatives_of_the_energy_and_conserve_momentum(scheme: str) -> None:
    system = system_of(facing(FLAT, "bottom", scheme))
    u = deformed(system)
    change = deformed(system, 1.0, 2)
    loose = system.without_joint()
    forces = system.equilibrium(u).forces - loose.equilibrium(u).forces
    step = 1e-5
    energies = [system.equilibrium(u + sign * step * change) for sign in (1, -1)]
    slope = (energies[0].adhesive_energy - energies[1].adhesive_energy) / (2 * step)
    assert np.sum(forces * change) == pytest.approx(slope, rel=1e-8)
    # action and reaction, and their moments about the origin, to round-off
    assert np.abs(forces.sum(axis=0)).max() < 1e-14 * np.abs(forces).sum()
    x = system.spaces.control_points() + u
    moment = np.sum(x[:, 0] * forces[:, 1] - x[:, 1] * forces[:, 0])
    assert abs(moment) < 1e-12 * np.abs(x).max() * np.abs(forces).sum()
