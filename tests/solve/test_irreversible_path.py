"""Irreversible adhesion along a path: tangent, energies, damage that stays, and going on from a state."""

from itertools import pairwise

import numpy as np
import pytest

from isopeel import Bilinear, Exponential, InputError, Problem, Step, row_space, strip, trace
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion import AdhesionLaw
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.step import State

# about half the strip's strength and its work, so that the front is wide enough for a coarse mesh
LAW = Exponential(0.03, 0.015)
SPACE = row_space("N2.1", (100, 3))


def problem(law: AdhesionLaw = LAW) -> Problem:
    return strip(law=law, irreversible=True)


def path(degrees: FloatArray, law: AdhesionLaw = LAW, settings: NewtonSettings | None = None) -> list[Step]:
    return list(trace(problem(law), SPACE, np.radians(degrees), settings))


def total_energy(step: Step) -> float:
    return step.stored_energy + step.adhesive_energy + step.dissipated_energy


def test_tangent_with_a_history_is_the_derivative_of_the_residual() -> None:
    """Points that open further, that close along their secant, and that are pressed on."""
    system = System(problem(), row_space("N2", (20, 2)))
    rng = np.random.default_rng(5)
    system = system.after(0.3 * rng.random(system.maximum_openings.shape))
    z = 0.1 * rng.standard_normal(system.constraints.count)

    def residual(values: FloatArray) -> FloatArray:
        return system.equilibrium(system.constraints.displacement(values, 0.01)).residual

    _, matrix = system.linearize(system.constraints.displacement(z, 0.01), "general")
    half = matrix.half_bandwidth
    n = len(z)
    dense = np.zeros((n, n))
    for j in range(n):
        for i in range(max(0, j - half), min(n, j + half + 1)):
            dense[i, j] = matrix.entries[j, 2 * half + i - j]
    for _ in range(3):
        direction = rng.standard_normal(n)
        difference = (residual(z + 1e-7 * direction) - residual(z - 1e-7 * direction)) / 2e-7
        scale = np.abs(difference).max()
        # central differences of a law whose stiffness has kinks, which few points meet within 1e-7
        np.testing.assert_allclose(dense @ direction, difference, rtol=0, atol=1e-6 * scale)


def test_work_is_stored_adhesive_and_dissipated_energy_there_and_back() -> None:
    """Out to 70 degrees, back to 40 and out again, by Gauss points in each interval of two degrees."""
    turns = [0.0, 70.0, 40.0, 76.0]
    ends = np.concatenate(
        [
            [0.0],
            *(np.arange(a, b, np.sign(b - a) * 2.0) + np.sign(b - a) * 2.0 for a, b in pairwise(turns)),
        ]
    )
    points, weights = np.polynomial.legendre.leggauss(4)
    half = np.diff(ends)[:, None] / 2
    inner = ends[:-1, None] + half * (points + 1)
    angles = np.concatenate([np.column_stack([ends[:-1], inner]).ravel(), ends[-1:]])
    steps = path(angles)
    moments = np.array([step.reaction for step in steps[:-1]]).reshape(-1, 5)[:, 1:]
    work = np.concatenate([[0.0], np.cumsum(np.sum(np.radians(half) * weights * moments, axis=1))])
    energies = np.array([total_energy(step) for step in steps[::5]])
    # what the quadrature leaves where the front passes elements
    np.testing.assert_allclose(energies - energies[0], work, rtol=0, atol=1e-6 * work.max())
    dissipated = np.array([step.dissipated_energy for step in steps])
    assert np.all(np.diff(dissipated) >= -1e-15)
    assert dissipated[-1] > 0.1 * work.max()
    # no damage during closing, except round-off
    back = (ends > 40) & (np.arange(len(ends)) > 35) & (np.arange(len(ends)) <= 50)
    assert np.ptp(dissipated[::5][back]) < 1e-6 * dissipated[-1]


def test_while_it_opens_the_joint_is_as_strong_as_a_reversible_one() -> None:
    degrees = np.arange(0.0, 71.0, 2.0)
    out = path(degrees)
    reversible = list(trace(strip(law=LAW), SPACE, np.radians(degrees)))
    # points just behind the front are pulled a little before they are pressed, and follow their secant then
    assert out[-1].reaction == pytest.approx(reversible[-1].reaction, rel=1e-3)
    assert all(step.dissipated_energy == 0 for step in reversible)


def test_what_is_peeled_does_not_heal() -> None:
    out = np.arange(0.0, 73.0, 2.0)
    steps = path(np.concatenate([out, out[-2::-1]]))
    there, back = steps[20].reaction, steps[-21].reaction
    assert steps[20].parameter == steps[-21].parameter  # 40 degrees
    assert back < 0.9 * there
    reversible = list(trace(strip(law=LAW), SPACE, np.radians([*out, *out[-2::-1]])))
    assert reversible[-21].reaction == pytest.approx(reversible[20].reaction, rel=1e-9)  # Newton's tolerance


def test_a_joint_continues_with_its_damage() -> None:
    degrees = np.array([*np.arange(0.0, 71.0, 2.0), *np.arange(68.0, 49.0, -2.0)])
    whole = path(degrees)
    cut = 40
    start = [State(s.parameter, s.displacement, s.maximum_openings) for s in whole[cut - 3 : cut]]
    rest = list(trace(problem(), SPACE, np.radians(degrees[cut:]), start=start))
    for step, known in zip(rest, whole[cut:], strict=True):
        assert step.reaction == pytest.approx(known.reaction, rel=1e-10)  # round-off of the start
        assert step.dissipated_energy == pytest.approx(known.dissipated_energy, rel=1e-10)
    with pytest.raises(InputError, match="points"):
        trace(problem(), SPACE, [0.1], start=[State(0.0, whole[0].displacement, np.zeros((1, 1)))])


def test_newton_converges_quadratically_while_the_joint_tears() -> None:
    steps = path(np.arange(0.0, 71.0, 1.0), Bilinear(0.03, 0.015, 0.2), NewtonSettings(plain=True))
    *_, before, last = steps[-1].iterations
    # energies are quadratic in the error: the exponent doubles, but for the kinks of the law
    assert len(steps[-1].iterations) <= 6
    assert last < before**1.5
