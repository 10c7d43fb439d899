"""Ties of sides: what follows, exact tangents, constant stress over all meshes, and refusals."""

import numpy as np
import pytest

from isopeel import Body, InputError, MovedSide, NeoHooke, Problem, Support, Tie, row_space, trace
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.matrix.band import Storage
from isopeel.problem import Boundary
from isopeel.problem.place import placed
from isopeel.splines.nurbs import NurbsSurface, annulus_sector, rectangle

STIFF, SOFT = NeoHooke(1.0, 0.3), NeoHooke(0.2, 0.3)
LOWER = Body(rectangle(10.0, 0.4), STIFF, "lower")
UPPER = Body(placed(rectangle(10.0, 0.6), (0.0, 0.4), 0.0), STIFF, "upper")
ACROSS = Tie(UPPER.side("bottom"), LOWER.side("top"))
BACK = Tie(LOWER.side("top"), UPPER.side("bottom"))
#: Another outline of the same curve: on top of a quarter of a ring.
INNER, OUTER = (
    Body(annulus_sector(2.0, 3.0, 1.0), STIFF, "lower"),
    Body(annulus_sector(3.0, 3.5, 1.0), SOFT, "upper"),
)


def pulled(lower: Body, upper: Body, tie: Tie) -> Problem:
    held = Support(lower.side("bottom"), (0, 1))
    return Problem("tied", (lower, upper), (), (held,), MovedSide(upper.side("top"), np.pi / 2), ties=(tie,))


def full(system: System, u: FloatArray, storage: Storage) -> FloatArray:
    """The tangent (count, count)."""
    _, matrix = system.linearize(u, storage)
    n, b = system.constraints.count, matrix.half_bandwidth
    found = np.zeros((n, n))
    for j in range(n):
        for i in range(j if storage == "symmetric" else max(0, j - b), min(n, j + b + 1)):
            found[i, j] = matrix.entries[j, i - j + matrix.diagonal]
    return found + np.tril(found, -1).T if storage == "symmetric" else found


@pytest.mark.parametrize("storage", ["symmetric", "general"])
@pytest.mark.parametrize(
    ("lower", "upper", "elements"),
    [(LOWER, UPPER, (8, 8)), (LOWER, UPPER, (8, 5)), (INNER, OUTER, (5, 5)), (INNER, OUTER, (4, 7))],
)
def test_tangents_are_the_derivatives_of_the_residual(
    lower: Body, upper: Body, elements: tuple[int, int], storage: Storage
) -> None:
    spaces = {"lower": row_space("N2", (elements[0], 2), 2), "upper": row_space("L2", (elements[1], 1), 2)}
    system = System(pulled(lower, upper, Tie(upper.side("bottom"), lower.side("top"))), spaces)
    rng = np.random.default_rng(1)
    own = system.constraints.unknowns[system.constraints.tied.of_several].ravel()
    y, direction = 0.01 * rng.standard_normal((2, system.count))
    y[own] = direction[own] = 0.0

    def residual(at: FloatArray) -> FloatArray:
        return system.equilibrium(system.state(at, 0.05)[0]).residual

    size = 1e-4
    changed = (residual(y + size * direction) - residual(y - size * direction)) / (2 * size)
    found = full(system, system.state(y, 0.05)[0], storage) @ direction
    # central differences of a smooth function
    np.testing.assert_allclose(found, changed, rtol=0, atol=1e-7 * np.abs(changed).max())


@pytest.mark.parametrize("tie", [ACROSS, BACK])
@pytest.mark.parametrize(
    ("lower", "upper"),
    [
        (("N2", 10), ("N2", 7)),
        (("N2", 8), ("N3", 9)),
        (("L1", 5), ("N2", 12)),
        (("N2.1", 12), ("L2", 5)),
        (("N2", 1), ("H3", 6)),
    ],
)
def test_a_constant_stress_crosses_meshes_that_do_not_match(
    lower: tuple[str, int], upper: tuple[str, int], tie: Tie
) -> None:
    held = Support(LOWER.side("bottom"), (1,)), *(Support(b.side("left"), (0,)) for b in (LOWER, UPPER))
    problem = Problem("patch", (LOWER, UPPER), (), held, MovedSide(UPPER.side("top"), np.pi / 2), ties=(tie,))
    spaces = {
        name: row_space(of, (n, rows), 2)
        for (name, (of, n)), rows in zip((("lower", lower), ("upper", upper)), (2, 1), strict=True)
    }
    *_, step = trace(problem, spaces, [0.0, -0.05, -0.1])
    points = System(problem, spaces).spaces.control_points()
    # -10 % along y, and the contraction of a free side along x
    u = step.displacement
    np.testing.assert_allclose(u[:, 1], -0.1 * points[:, 1], rtol=0, atol=1e-12)
    np.testing.assert_allclose(u[:, 0], u[:, 0].max() / 10.0 * points[:, 0], rtol=0, atol=1e-12)
    assert u[:, 0].max() > 0.3


def turned_back(shape: NurbsSurface) -> NurbsSurface:
    """The same shape with both parameters reversed."""
    return NurbsSurface(shape.spaces, shape.control_points[::-1, ::-1], shape.weights[::-1, ::-1])


def test_four_patches_of_four_meshes_turn_as_one_solid() -> None:
    places = {"a": (0.0, 0.0), "b": (2.0, 0.0), "c": (0.0, 1.0), "d": (2.0, 1.0)}
    bodies = {
        name: Body(placed(rectangle(2.0, 1.0), at, 0.0), STIFF if name in "ad" else SOFT, name)
        for name, at in places.items()
    }
    bodies["d"] = Body(turned_back(bodies["d"].shape), STIFF, "d")
    ties = (
        Tie(Boundary("b", "left"), Boundary("a", "right")),
        Tie(Boundary("c", "bottom"), Boundary("a", "top")),
        Tie(Boundary("d", "right"), Boundary("c", "right")),
        Tie(Boundary("d", "top"), Boundary("b", "top")),
    )
    held = Support(bodies["a"].side("left"), (0, 1))
    drive = MovedSide(bodies["b"].side("right"), 0.0)
    problem = Problem("four", tuple(bodies.values()), (), (held,), drive, ties=ties)
    meshes = {"a": (3, 3), "b": (4, 5), "c": (5, 2), "d": (3, 4)}
    spaces = {name: row_space("N2", mesh, 2) for name, mesh in meshes.items()}
    system = System(problem, spaces)
    points, tied = system.spaces.control_points(), system.constraints.tied
    turn = np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
    u = points @ turn.T - points
    followers = tied.followers
    led = np.add.reduceat(followers.shares[:, None] * u[followers.leaders], followers.starts[:-1])
    np.testing.assert_allclose(led, u[followers.functions], rtol=0, atol=1e-13)
    assert np.abs(system.equilibrium(u).forces).max() < 1e-13
    # one point belongs to all of them
    corner = np.flatnonzero(np.hypot(*(points - [2.0, 1.0]).T) < 1e-12)
    assert len(corner) == 4
    assert len(set(tied.copies[corner])) == 1


@pytest.mark.parametrize("web", [(6, 2), (5, 2), (1, 3)])
def test_a_web_on_a_part_of_a_flange_transfers_the_force(web: tuple[int, int]) -> None:
    flange = Body(rectangle(6.0, 1.0), STIFF, "flange")
    post = Body(placed(rectangle(3.0, 1.0), (3.5, 1.0), np.pi / 2), STIFF, "post")
    tie = Tie(post.side("left"), flange.side("top", 2.5 / 6.0, 3.5 / 6.0))
    held = Support(flange.side("bottom"), (0, 1))
    drive = MovedSide(post.side("right"), np.pi / 2)
    problem = Problem("T", (flange, post), (), (held,), drive, ties=(tie,))
    spaces = {"flange": row_space("N2", (12, 2), 2), "post": row_space("N2", web, 2)}
    *_, step = trace(problem, spaces, [0.0, 0.1, 0.2])
    system = System(problem, spaces)
    (reaction,) = system.support_reactions(system.equilibrium(step.displacement)).values()
    # the force that pulls the post is that of the support, to round-off of the equilibrium
    assert reaction[1] == pytest.approx(-step.reaction, rel=1e-9)
    assert abs(reaction[0]) < 1e-9 * step.reaction
    # the post alone would be longer by 0.2: the flange takes a part of it
    assert 0.8 < step.reaction / (0.2 / 3.0 / (1 - 0.09)) < 1.0


@pytest.mark.parametrize(
    ("upper", "ties", "field", "words"),
    [
        (placed(rectangle(10.0, 1.0), (0.0, 0.5), 0.0), (ACROSS,), "tie.1.between", "is 0.1 L0 away"),
        (placed(rectangle(12.0, 1.0), (0.0, 0.4), 0.0), (ACROSS,), "tie.1.between", "exchange the sides"),
        (
            UPPER.shape,
            (Tie(UPPER.side("bottom"), LOWER.side("top", end=0.5)),),
            "tie.1.between",
            "leaves the part",
        ),
        (UPPER.shape, (ACROSS, BACK), "tie.2.between", "tied already"),
    ],
)
def test_sides_that_do_not_fit_are_refused(
    upper: NurbsSurface, ties: tuple[Tie, ...], field: str, words: str
) -> None:
    bodies = LOWER, Body(upper, STIFF, "upper")
    held, drive = (Support(LOWER.side("left"), (0, 1)),), MovedSide(UPPER.side("right"), 0.0)
    spaces = {"lower": row_space("N2", (6, 2), 2), "upper": row_space("N2", (4, 1), 2)}
    with pytest.raises(InputError, match=words) as caught:
        System(Problem("refused", bodies, (), held, drive, ties=ties), spaces)
    assert caught.value.field == field


def test_a_side_that_follows_and_is_moved_is_refused() -> None:
    held = (Support(LOWER.side("left"), (0, 1)),)
    spaces = {"lower": row_space("N2", (6, 2), 2), "upper": row_space("N2", (4, 1), 2)}
    problem = Problem("moved", (LOWER, UPPER), (), held, MovedSide(UPPER.side("bottom"), 0.0), ties=(ACROSS,))
    with pytest.raises(InputError, match="tied to another side"):
        System(problem, spaces)


def test_ties_need_a_whole_side_of_another_body() -> None:
    with pytest.raises(InputError, match="whole side"):
        Tie(UPPER.side("bottom", end=0.5), LOWER.side("top"))
    with pytest.raises(InputError, match="another body"):
        Tie(UPPER.side("bottom"), UPPER.side("top"))
