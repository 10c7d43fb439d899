"""Several bodies, interfaces and supports in one system: each acts as it does alone."""

from collections.abc import Mapping
from dataclasses import replace

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
    MovedSide,
    NeoHooke,
    NewtonSettings,
    Problem,
    PulledSide,
    RotatedSide,
    RowSpace,
    SaintVenantKirchhoff,
    Support,
    VanDerWaals,
    row_space,
    strip,
    trace,
)
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.matrix.band import Storage
from isopeel.splines.nurbs import annulus_sector, rectangle

STRIP = strip(length=20.0, height=2.0, adhering_length=15.0)
UPPER = replace(STRIP.body, name="strip")
JOINT = replace(STRIP.adhesion, boundary=UPPER.side("bottom", end=0.75))
#: Of another shape and material, on the same kind of substrate by its own law, which is damaged.
PAD = Body(annulus_sector(10.0, 12.0, 1.0), SaintVenantKirchhoff(0.5, 0.3), "pad")
STICKY = Interface(
    PAD.side("bottom", 0.2, 0.9),
    Exponential(0.06, 0.015, 0.3),
    Circle(9.7, "inside", (0.0, 0.0)),
    irreversible=True,
)
TURN = RotatedSide("right")
ALONE = Problem("strip", (UPPER,), (JOINT,), (Support(UPPER.side("left"), (0,)),), TURN)
PUSH = MovedSide("right", 0.0, "held")
OTHER = Problem("pad", (PAD,), (STICKY,), (Support(PAD.side("left"), (0, 1)),), PUSH)
SPACES: Mapping[str, RowSpace] = {"strip": row_space("N2.1", (20, 3)), "pad": row_space("L2", (12, 2))}


def both(drive: RotatedSide | MovedSide, driven: str) -> Problem:
    """The drive moves one of them; the other one is held where its own drive would move it."""
    rest = Support(PAD.side("right"), (0, 1)) if driven == "strip" else Support(UPPER.side("right"), (0, 1))
    supports = (*ALONE.supports, *OTHER.supports, rest)
    body = UPPER if driven == "strip" else PAD
    return Problem("both", (UPPER, PAD), (JOINT, STICKY), supports, replace(drive, on=body.side("right")))


def matrix_of(system: System, u: FloatArray, storage: Storage) -> FloatArray:
    """The tangent (count, count), of the lower half or of the whole band."""
    _, matrix = system.linearize(u, storage)
    n, b = system.constraints.count, system.half_bandwidth
    full = np.zeros((n, n))
    for j in range(n):
        for i in range(max(0, j - b) if storage == "general" else j, min(n, j + b + 1)):
            full[i, j] = matrix.entries[j, i - j + (2 * b if storage == "general" else 0)]
    return full


@pytest.mark.parametrize("storage", ["symmetric", "general"])
def test_residuals_and_tangents_are_those_of_two_systems(storage: Storage) -> None:
    one, other = System(ALONE, SPACES["strip"]), System(OTHER, SPACES["pad"])
    held = System(both(TURN, "strip"), SPACES)
    rng = np.random.default_rng(0)
    u, v = (0.02 * rng.standard_normal((system.space.size, 2)) for system in (one, other))
    one, other, held = (
        system.after(system.commit(3 * opened))
        for system, opened in ((one, u), (other, v), (held, np.concatenate([u, v])))
    )
    opened = held.maximum_openings_of(held.maximum_openings)
    np.testing.assert_array_equal(opened["strip.bottom"], one.maximum_openings)
    np.testing.assert_array_equal(opened["pad.bottom"], other.maximum_openings)
    found = held.equilibrium(np.concatenate([u, v]))
    first, second = one.equilibrium(u), other.equilibrium(v)
    # the same sums
    forces = np.concatenate([first.forces, second.forces])
    np.testing.assert_allclose(found.forces, forces, rtol=0, atol=1e-12 * np.abs(forces).max())
    for energy in ("stored_energy", "adhesive_energy", "dissipated_energy"):
        total = getattr(first, energy) + getattr(second, energy)
        assert getattr(found, energy) == pytest.approx(total, rel=1e-12)
    assert second.dissipated_energy > 0
    assert found.lowest_determinant == min(first.lowest_determinant, second.lowest_determinant)
    whole = matrix_of(held, np.concatenate([u, v]), storage)
    alone, beside = matrix_of(one, u, storage), matrix_of(other, v, storage)
    size = one.constraints.count
    largest = np.abs(whole).max()
    assert np.abs(whole[:size, size:]).max() == np.abs(whole[size:, :size]).max() == 0
    np.testing.assert_allclose(whole[:size, :size], alone, rtol=0, atol=1e-12 * largest)
    np.testing.assert_allclose(whole[size:, size:], beside, rtol=0, atol=1e-12 * largest)


@pytest.mark.parametrize("path_control", ["newton", "auto"])
def test_curves_are_those_of_two_systems(path_control: str) -> None:
    settings = NewtonSettings(path_control=path_control)  # type: ignore[arg-type]
    paths = np.radians(np.arange(0.0, 6.1, 0.25)), np.arange(0.0, 0.31, 0.02)
    cases = (("strip", ALONE, TURN, paths[0]), ("pad", OTHER, PUSH, paths[1]))
    for driven, alone, drive, path in cases:
        expected = [step.reaction for step in trace(alone, SPACES[driven], path, settings)]
        steps = list(trace(both(drive, driven), SPACES, path, settings))
        found = [step.reaction for step in steps]
        # what the other one relaxes by at first works on nothing that is driven
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-8 * np.abs(expected).max())
        assert steps[-1].maximum_openings.size == sum(
            term.table.weights.size for term in System(both(drive, driven), SPACES).interfaces
        )


@pytest.mark.parametrize(
    "drive", [PulledSide("right", 1.0), PulledSide("right", 1.0, control="force", follows=True)]
)
def test_a_load_acts_on_the_second_body(drive: PulledSide) -> None:
    alone, on_strip = replace(ALONE, drive=drive), replace(drive, on=UPPER.side("right"))
    first = Problem("both", (PAD, UPPER), (STICKY, JOINT), (*OTHER.supports, *ALONE.supports), on_strip)
    path = np.linspace(0.0, 0.05 if drive.control == "displacement" else 1e-4, 6)
    expected = [step.reaction for step in trace(alone, SPACES["strip"], path)]
    found = [step.reaction for step in trace(first, SPACES, path)]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-8 * np.abs(expected).max())
    assert np.abs(expected).max() > 0


def test_a_face_in_two_parts_is_that_of_one() -> None:
    """Two interfaces meet at a breakpoint; a gap between them takes its forces away."""
    space = row_space("N2", (20, 2))
    parts = tuple(replace(JOINT, boundary=UPPER.side("bottom", *part)) for part in ((0.0, 0.4), (0.4, 0.75)))
    whole, split = System(ALONE, space), System(replace(ALONE, interfaces=parts), space)
    rng = np.random.default_rng(0)
    u = 0.02 * rng.standard_normal((whole.space.size, 2))
    expected, found = whole.equilibrium(u), split.equilibrium(u)
    np.testing.assert_allclose(
        found.forces, expected.forces, rtol=0, atol=1e-13 * np.abs(expected.forces).max()
    )
    assert found.adhesive_energy == pytest.approx(expected.adhesive_energy, rel=1e-13)
    # of the first 8 of 15 elements, and the last
    gap = (parts[0], replace(JOINT, boundary=UPPER.side("bottom", 0.7, 0.75)))
    with_gap = System(replace(ALONE, interfaces=gap), space)
    lengths = [term.table.weights.sum() for term in with_gap.interfaces]
    assert lengths == pytest.approx([8.0, 1.0], rel=1e-13)
    rest = with_gap.equilibrium(np.zeros_like(u)).adhesive_energy
    assert rest == pytest.approx(9 / 15 * whole.equilibrium(np.zeros_like(u)).adhesive_energy, rel=1e-13)


def test_upper_and_lower_side_pull_alike() -> None:
    """A strip between two planes, each at the equilibrium gap: no net force, and twice the energy."""
    law = VanDerWaals(hamaker_constant=0.05, equilibrium_distance=0.4)
    plane = Circle(1e9, "inside", (0.0, 2.0 + law.equilibrium_gap + 1e9))
    lower = Interface(UPPER.side("bottom"), law, Flat(-law.equilibrium_gap))
    joints = lower, Interface(UPPER.side("top"), law, plane)
    space = row_space("N2", (10, 2))
    system = System(replace(ALONE, interfaces=joints), space)
    one = System(replace(ALONE, interfaces=joints[:1]), space)
    u = np.zeros((space.size, 2))
    u[:, 1] = 0.01
    lifted, lowered = system.equilibrium(u), system.equilibrium(-u)
    # the circle falls off by 20^2/2e9 of its radius at the end
    assert lifted.adhesive_energy == pytest.approx(lowered.adhesive_energy, rel=1e-6)
    assert lifted.forces[:, 1].sum() == pytest.approx(-lowered.forces[:, 1].sum(), rel=1e-5)
    at_rest = system.equilibrium(0 * u).adhesive_energy
    assert at_rest == pytest.approx(2 * one.equilibrium(0 * u).adhesive_energy, rel=1e-6)


@pytest.mark.parametrize(
    ("part", "count"), [((0.0, 0.9), 11), ((0.0, 0.3), 5), ((0.35, 0.55), 5), ((0.3, 0.4), 3)]
)
def test_a_support_holds_a_part_of_a_side(part: tuple[float, float], count: int) -> None:
    """Ten quadratic elements have 12 functions, of which three do not vanish on one of them."""
    space = row_space("N2", (10, 2))
    part_held = Support(UPPER.side("top", *part), (1,))
    system = System(replace(ALONE, supports=(*ALONE.supports, part_held)), space)
    top = system.constraints.unknowns[space.side_functions("top")]
    assert (top[:, 1] < 0).sum() == count
    assert (top[1:, 0] >= 0).all()


@pytest.mark.parametrize(
    ("problem", "spaces", "message"),
    [
        (ALONE, {"pad": SPACES["pad"]}, "each body needs one: strip"),
        (
            replace(both(TURN, "strip"), supports=()),
            SPACES,
            "nothing prevents this motion of the body",
        ),
    ],
)
def test_what_does_not_fit_is_refused(problem: Problem, spaces: Mapping[str, RowSpace], message: str) -> None:
    with pytest.raises(InputError, match=message):
        System(problem, spaces)


def test_parts_of_one_side_have_names_of_their_own() -> None:
    parts = tuple(replace(JOINT, boundary=UPPER.side("bottom", *part)) for part in ((0.0, 0.4), (0.5, 0.75)))
    problem = replace(ALONE, interfaces=(*parts, replace(JOINT, boundary=UPPER.side("top"))))
    assert problem.interface_names == ("strip.bottom", "strip.bottom#2", "strip.top")


def test_a_history_is_a_value() -> None:
    """A commit does not change the system; the system after the commit has the damage."""
    system = System(OTHER, SPACES["pad"])
    rng = np.random.default_rng(0)
    u = 0.02 * rng.standard_normal((system.space.size, 2))
    before, initial = system.equilibrium(u), system.maximum_openings
    later = system.after(system.commit(3 * u))
    assert later.equilibrium(u).dissipated_energy > 2 * before.dissipated_energy > 0
    assert system.maximum_openings is initial
    np.testing.assert_array_equal(system.equilibrium(u).forces, before.forces)
    with pytest.raises(ValueError, match="read-only"):
        later.maximum_openings[0, 0] = 0.0


def test_a_bar_without_an_interface_is_stretched() -> None:
    """Its force is E' h e at a small strain e, up to e itself; nothing adheres."""
    soft = Body(rectangle(20.0, 2.0), NeoHooke(3.0, 0.2))
    supports = (Support(soft.side("left"), (0,)), Support(soft.side("bottom"), (1,)))
    bar = Problem("bar", (soft,), (), supports, MovedSide("right", 0.0))
    strains = np.linspace(0.0, 1e-5, 4)
    steps = list(trace(bar, row_space("N2", (8, 2)), 20.0 * strains))
    expected = 3.0 / (1 - 0.2**2) * 2.0 * strains
    np.testing.assert_allclose([step.reaction for step in steps], expected, rtol=1e-4, atol=1e-14)
    assert steps[-1].adhesive_energy == 0
    assert System(bar, row_space("N2", (8, 2))).maximum_openings_of(steps[-1].maximum_openings) == {}


def test_names_are_checked() -> None:
    with pytest.raises(InputError, match="no two may have the same name"):
        Problem("two", (UPPER, UPPER), (), (), RotatedSide("right"))
    with pytest.raises(InputError, match="body: 'pad' cannot be used; the bodies are strip"):
        replace(ALONE, interfaces=(STICKY,))
    with pytest.raises(InputError, match="0 <= start < end <= 1"):
        Boundary("strip", "top", 0.5, 0.5)
    with pytest.raises(InputError, match="2 of the kind interface"):
        _ = both(TURN, "strip").adhesion
    assert NeoHooke(1.0, 0.2) == UPPER.material
