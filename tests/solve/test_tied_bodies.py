"""Paths of bodies that are tied: the curve of one body, and the bending of composite beams."""

import numpy as np
import pytest

from isopeel import (
    Body,
    Flat,
    Interface,
    NeoHooke,
    Problem,
    PulledSide,
    RotatedSide,
    RowSpace,
    Support,
    Tie,
    VanDerWaals,
    row_space,
    trace,
)
from isopeel.common.arrays import FloatArray
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.problem.place import placed
from isopeel.splines.nurbs import rectangle
from isopeel.splines.space import SplineSpace

STIFF, SOFT = NeoHooke(1.0, 0.3), NeoHooke(0.05, 0.4)
LAW = VanDerWaals(0.05, 0.4)
LENGTH, LOWER, UPPER = 10.0, 0.4, 0.6


def layers(lower: NeoHooke = STIFF, upper: NeoHooke = STIFF, length: float = LENGTH) -> tuple[Body, Body]:
    return (
        Body(rectangle(length, LOWER), lower, "lower"),
        Body(placed(rectangle(length, UPPER), (0.0, LOWER), 0.0), upper, "upper"),
    )


def held_in_x(*bodies: Body) -> tuple[Support, ...]:
    return tuple(Support(body.side("left"), (0,)) for body in bodies)


@pytest.mark.parametrize("upper_follows", [True, False])
def test_two_tied_bodies_peel_as_one_body_that_is_continuous_only_between_them(upper_follows: bool) -> None:
    lower, upper = layers()
    whole = Body(rectangle(LENGTH, LOWER + UPPER), STIFF, "whole")
    part = row_space("N2", (20, 2), 2)
    across = SplineSpace(2, np.array([0, 0, 0, 0.2, 0.4, 0.4, 0.7, 1, 1, 1]))
    path = np.linspace(0.0, 2.0, 11)

    def curve(bodies: tuple[Body, ...], space: object, ties: tuple[Tie, ...]) -> FloatArray:
        joint = Interface(bodies[0].side("bottom", end=0.75), LAW, Flat(-LAW.equilibrium_gap))
        loaded = bodies[-1].side("right", 0.4 if len(bodies) == 1 else 0.0)
        drive = PulledSide(loaded, np.pi / 2)
        problem = Problem("tape", bodies, (joint,), held_in_x(*bodies), drive, ties=ties)
        return np.array([step.reaction for step in trace(problem, space, path)])  # type: ignore[arg-type]

    sides = upper.side("bottom"), lower.side("top")
    tie = Tie(*sides) if upper_follows else Tie(*sides[::-1])
    expected = curve((whole,), RowSpace("N2", across, (part.rows[0],) * across.size), ())
    found = curve((lower, upper), {"lower": part, "upper": part}, (tie,))
    assert expected.max() > 0.01
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * expected.max())


def bending_stiffness(elements: tuple[int, int], upper_follows: bool) -> float:
    """Moment over curvature of a beam of two layers, which a side of the stiff one turns."""
    lower, upper = layers(SOFT, STIFF, 20.0)
    sides = upper.side("bottom"), lower.side("top")
    tie = Tie(*sides) if upper_follows else Tie(*sides[::-1])
    supports = (*held_in_x(lower, upper), Support(lower.side("bottom", end=1e-6), (1,)))
    problem = Problem("beam", (lower, upper), (), supports, RotatedSide(upper.side("right")), ties=(tie,))
    spaces = {body.name: row_space("N2", (n, 2), 2) for body, n in zip((lower, upper), elements, strict=True)}
    turn = 1e-5
    *_, step = trace(problem, spaces, [0.0, turn])
    space = spaces["upper"]
    # three points of the middle, at which the line is a parabola (Saint-Venant)
    xi = np.array([0.4, 0.5, 0.6])
    basis = space.basis(xi, np.ones(3), space.elements[1] - 1)
    u = step.displacement[spaces["lower"].size :][basis.functions, 1]
    line = (basis.values * u).sum(axis=1)
    curvature = (line[0] - 2 * line[1] + line[2]) / (0.1 * 20.0) ** 2
    return float(step.reaction / curvature)


def composite_stiffness() -> float:
    """EI of the layers about their common neutral axis, with E' of plane strain (Timoshenko's strips)."""
    moduli = np.array([plane_strain_modulus(SOFT), plane_strain_modulus(STIFF)])
    heights, centres = np.array([LOWER, UPPER]), np.array([LOWER / 2, LOWER + UPPER / 2])
    neutral = (moduli * heights * centres).sum() / (moduli * heights).sum()
    return float((moduli * heights * (heights**2 / 12 + (centres - neutral) ** 2)).sum())


@pytest.mark.parametrize(
    ("elements", "allowed"),
    [
        ((40, 40), 1e-6),  # the turn is large enough that the moment is known to 1e-7 of it
        ((40, 30), 1e-6),
        ((30, 40), 1e-6),
        # elements of the size of a height: the decay of the stresses of the ends is not resolved
        ((20, 15), 1e-4),
    ],
)
@pytest.mark.parametrize("upper_follows", [True, False])
def test_layers_bend_as_a_composite_beam(
    elements: tuple[int, int], allowed: float, upper_follows: bool
) -> None:
    assert bending_stiffness(elements, upper_follows) == pytest.approx(composite_stiffness(), rel=allowed)
