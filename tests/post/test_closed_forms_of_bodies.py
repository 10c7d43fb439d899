"""The closed forms of two bodies: shown where they are valid, and nowhere else."""

from dataclasses import replace
from math import pi
from typing import Any

import pytest

from isopeel import (
    Body,
    Exponential,
    HeldLoad,
    Interface,
    NeoHooke,
    Problem,
    PulledSide,
    RotatedSide,
    Support,
    row_space,
)
from isopeel.physics.materials.prestretched import Prestretched
from isopeel.post.closed_form import kendall_force, t_peel, t_peel_force, tape_on_body
from isopeel.problem.place import placed
from isopeel.splines.nurbs import rectangle

LENGTH, HEIGHT = 12.0, 0.1
MATERIAL = NeoHooke(1.0, 0.3)
LAW = Exponential(1.5e-3, 2e-4)
SPACE = row_space("N2", (120, 1))
SPACES = {"upper": SPACE, "lower": SPACE}
UPPER = Body(rectangle(LENGTH, HEIGHT), MATERIAL, "upper")
LOWER = Body(placed(rectangle(LENGTH, HEIGHT), (0.0, -HEIGHT), 0.0), MATERIAL, "lower")
ENDS = (UPPER.side("right"), 1.0), (LOWER.side("right"), -1.0)
JOINT = Interface(UPPER.side("bottom", end=10 / 12), LAW, LOWER.side("top", end=10 / 12))
PEELED = Problem(
    "t-peel",
    (UPPER, LOWER),
    (JOINT,),
    (Support(UPPER.side("left"), (0, 1)), Support(LOWER.side("left"), (0,))),
    PulledSide(ENDS, pi / 2),
)


def test_the_force_is_that_of_the_balance_of_energies() -> None:
    form = t_peel(PEELED, SPACES).form
    assert form is not None
    assert form.source == "T-peel"
    assert form.reaction == t_peel_force(2e-4, HEIGHT / (1 - 0.3**2))
    # an element of 0.1 on each arm, stretched by 1e-3
    assert form.period == pytest.approx(0.2, rel=2e-3)


@pytest.mark.parametrize(
    "problem",
    [
        pytest.param(replace(PEELED, interfaces=(replace(JOINT, scheme="biased"),)), id="biased"),
        pytest.param(
            replace(PEELED, interfaces=(replace(JOINT, boundary=JOINT.against, against=JOINT.boundary),)),  # type: ignore[arg-type]
            id="sides exchanged",
        ),
        pytest.param(replace(PEELED, bodies=(LOWER, UPPER)), id="bodies exchanged"),
        pytest.param(
            replace(PEELED, drive=PulledSide(tuple((one, -factor) for one, factor in ENDS), -pi / 2)),
            id="angle and factors reversed",
        ),
    ],
)
def test_the_same_test_in_other_words_has_the_same_form(problem: Problem) -> None:
    assert t_peel(problem, SPACES) == t_peel(PEELED, SPACES)


THICK = Body(rectangle(LENGTH, 2 * HEIGHT), MATERIAL, "upper")
FAR = Body(placed(UPPER.shape, (0.0, 0.01), 0.0), MATERIAL, "upper")
STIFF = Body(UPPER.shape, NeoHooke(2.0, 0.3), "upper")
TENSE = {name: Prestretched(MATERIAL, 1.01) for name in ("upper", "lower")}


@pytest.mark.parametrize(
    "changed",
    [
        pytest.param({"bodies": (THICK, LOWER)}, id="heights differ"),
        pytest.param({"bodies": (STIFF, LOWER)}, id="materials differ"),
        pytest.param({"bodies": (FAR, LOWER)}, id="not at the equilibrium gap"),
        pytest.param(
            {"bodies": tuple(replace(one, material=TENSE[one.name]) for one in (UPPER, LOWER))}, id="tense"
        ),
        pytest.param({"drive": PulledSide(ENDS, 1.5)}, id="not at a right angle"),
        pytest.param({"drive": PulledSide(ENDS, -pi / 2)}, id="pressed"),
        pytest.param(
            {"drive": PulledSide((ENDS[0], (LOWER.side("right"), -2.0)), pi / 2)}, id="other forces"
        ),
        pytest.param({"drive": PulledSide((ENDS[0], (LOWER.side("left"), -1.0)), pi / 2)}, id="other ends"),
        pytest.param({"drive": RotatedSide(ENDS)}, id="moments"),
        pytest.param({"supports": (*PEELED.supports, Support(LOWER.side("bottom"), (1,)))}, id="held below"),
        pytest.param({"loads": (HeldLoad(UPPER.side("top"), 1e-6, pi / 2),)}, id="a load that is held"),
        pytest.param(
            {"interfaces": (replace(JOINT, boundary=UPPER.side("bottom", 0.1, 0.8)),)},
            id="free far end",
        ),
    ],
)
def test_other_problems_have_none(changed: dict[str, Any]) -> None:
    found = t_peel(replace(PEELED, **changed), SPACES)
    assert (found.form, found.reason) == (None, "")


def test_two_half_passes_have_none_for_a_reason() -> None:
    found = t_peel(replace(PEELED, interfaces=(replace(JOINT, scheme="two-half-pass"),)), SPACES)
    assert found.form is None
    assert found.reason.startswith("two half-passes have no energy")


BASE = Body(placed(rectangle(16.0, 1.0), (-2.0, -1.0), 0.0), NeoHooke(0.01, 0.3), "base")
ON_BASE = Problem(
    "on a soft body",
    (UPPER, BASE),
    (Interface(JOINT.boundary, LAW, BASE.side("top", 0.125, 0.75)),),
    (Support(UPPER.side("left"), (0,)), Support(BASE.side("bottom"), (0, 1))),
    PulledSide(UPPER.side("right"), pi / 2),
)
ON_BASE_SPACES = {"upper": SPACE, "base": row_space("N2", (80, 2))}


def test_a_tape_on_a_soft_body_needs_the_force_of_kendall() -> None:
    form = tape_on_body(ON_BASE, ON_BASE_SPACES).form
    assert form is not None
    stiffness = HEIGHT / (1 - 0.3**2)
    assert (form.source, form.reaction) == ("Kendall's tape", kendall_force(2e-4, stiffness, pi / 2))
    assert form.period == pytest.approx(0.1, rel=3e-3)  # an element, stretched by 2e-3
    # the soft body makes the front longer than a stiff one
    stiff = replace(BASE, material=NeoHooke(100.0, 0.3))
    other = tape_on_body(replace(ON_BASE, bodies=(UPPER, stiff)), ON_BASE_SPACES).form
    assert other is not None
    assert other.reaction == form.reaction
    assert other.behind <= form.behind
    exchanged = replace(ON_BASE.interfaces[0], boundary=BASE.side("top", 0.125, 0.75), against=JOINT.boundary)
    assert tape_on_body(replace(ON_BASE, interfaces=(exchanged,)), ON_BASE_SPACES).form == form


@pytest.mark.parametrize(
    "changed",
    [
        pytest.param({"drive": PulledSide(UPPER.side("right"), 1.0)}, id="not at a right angle"),
        pytest.param({"drive": PulledSide(UPPER.side("right"), -pi / 2)}, id="pressed"),
        pytest.param({"drive": PulledSide(BASE.side("right"), -pi / 2)}, id="the thick body is pulled"),
        pytest.param({"supports": (Support(UPPER.side("top"), (0,)), ON_BASE.supports[1])}, id="held on top"),
        pytest.param({"bodies": (FAR, BASE)}, id="not at the equilibrium gap"),
        pytest.param({"bodies": (replace(UPPER, material=TENSE["upper"]), BASE)}, id="tense"),
    ],
)
def test_other_problems_of_a_tape_have_none(changed: dict[str, Any]) -> None:
    assert tape_on_body(replace(ON_BASE, **changed), ON_BASE_SPACES).form is None
