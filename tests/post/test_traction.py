"""Adhesive tractions against the forces that the solver assembles."""

from dataclasses import replace

import numpy as np
import pytest

from isopeel import (
    AdhesiveSide,
    Body,
    Circle,
    Exponential,
    Flat,
    InputError,
    NeoHooke,
    Problem,
    VanDerWaals,
    Wavy,
    row_space,
    strip,
)
from isopeel.assembly.system import System
from isopeel.post.traction import adhesive_traction
from isopeel.splines.nurbs import rectangle

LENGTH, PART = 20.0, 0.7
LAW = VanDerWaals(hamaker_constant=0.05, equilibrium_distance=0.4)
PEAKED = Exponential(strength=0.05, work_of_adhesion=0.02, equilibrium_gap=0.3)
SPACE = row_space("N2", (20, 2))
_points, _weights = np.polynomial.legendre.leggauss(3)
# Gauss points of the 14 elements that adhere, as the solver integrates at, and the lengths they stand for
PARAMETERS = (np.arange(14)[:, None] + (_points + 1) / 2) / 20
LENGTHS = np.tile(_weights / 2, (14, 1))

flat = AdhesiveSide("bottom", LAW, Flat(-0.3), end=PART)
SIDES = [
    flat,
    replace(flat, traction="projected"),
    replace(flat, substrate=Circle(50.0, "inside", (5.0, -50.3))),
    replace(flat, substrate=Wavy(0.1, 15.0, height=-0.5)),
    replace(flat, law=PEAKED, sliding_length=0.5),
    replace(flat, law=PEAKED, irreversible=True),
    replace(flat, law=PEAKED, irreversible=True, traction="projected"),
]


def problem_with(side: AdhesiveSide) -> Problem:
    body = Body(rectangle(LENGTH, 2.0), NeoHooke(1.0, 0.2))
    return replace(strip(), body=body, adhesion=side)


@pytest.mark.parametrize("side", SIDES)
def test_tractions_sum_up_to_the_assembled_force(side: AdhesiveSide) -> None:
    problem = problem_with(side)
    random = np.random.default_rng(5)
    wide = 0.4 * random.random((SPACE.size, 2))
    closer = 0.3 * wide + 0.05 * random.random((SPACE.size, 2))
    system = System(problem, SPACE)
    system.accept(wide)
    before = adhesive_traction(problem, SPACE, wide, PARAMETERS)
    found = adhesive_traction(problem, SPACE, closer, PARAMETERS, before.opening)
    total = np.einsum("nk,nkc->c", LENGTHS, found.traction)
    # internal forces sum up to none; forces are slopes of the energy, those on the body have the other sign
    expected = -system.equilibrium(closer).forces.sum(axis=0)
    # round-off of the sum over 42 points and of that over all functions, whose forces are below 1
    np.testing.assert_allclose(total, expected, atol=1e-13)
    assert np.abs(expected).max() > 1e-3
    if side.irreversible:
        assert (found.opening > found.gap - PEAKED.equilibrium_gap).any()
        fresh = adhesive_traction(problem, SPACE, closer, PARAMETERS)
        assert np.abs(fresh.traction - found.traction).max() > 1e-3


def test_repulsion_is_positive_and_opens_nothing() -> None:
    problem = problem_with(replace(flat, substrate=Flat(-0.2)))
    found = adhesive_traction(problem, SPACE, np.zeros((SPACE.size, 2)), PARAMETERS)
    np.testing.assert_allclose(found.gap, 0.2, rtol=1e-15)  # one subtraction
    assert (found.normal_traction > 0).all()
    np.testing.assert_array_equal(found.traction[..., 1], found.normal_traction)
    assert not found.opening.any()


def test_coefficients_of_another_space_are_refused() -> None:
    with pytest.raises(InputError, match="displacement"):
        adhesive_traction(problem_with(flat), SPACE, np.zeros((3, 2)), PARAMETERS)
