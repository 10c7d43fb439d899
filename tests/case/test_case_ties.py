"""Case files of bodies that are tied: what they mean, and which are refused, in one line."""

import re

import numpy as np
import pytest

from isopeel import InputError, Tie
from isopeel.assembly.system import System
from isopeel.case import Case, with_options
from isopeel.problem import Boundary

TAPE = """
name = "tape"

[[body]]
name = "adhesive"
length = "12 mm"
height = "0.1 mm"
material = { law = "neo-hooke", youngs_modulus = "20 MPa", poissons_ratio = 0.4 }
mesh = "24x2"

[[body]]
name = "backing"
on = "adhesive.top"
length = "12 mm"
height = "0.05 mm"
material = { law = "neo-hooke", youngs_modulus = "1 GPa", poissons_ratio = 0.3 }
mesh = "24x1"

[[tie]]
between = ["backing.bottom", "adhesive.top"]

[[interface]]
boundary = "adhesive.bottom"
length = "10 mm"
law = "exponential"
strength = "1.5 MPa"
work_of_adhesion = "200 J/m^2"

[[support]]
boundary = "adhesive.left"
holds = "x"

[[support]]
boundary = "backing.left"
holds = "x"

[units]
length = "1 mm"
stress = "1 GPa"

[drive]
boundary = "backing.right"
kind = "force"
angle = "90 deg"
to = "1 mm"
step = "0.1 mm"
"""
LAYER = 'length = "12 mm"\nheight = "0.05 mm"'
SIDES = 'between = ["backing.bottom", "adhesive.top"]'


def changed(old: str, new: str) -> str:
    assert old in TAPE
    return TAPE.replace(old, new, 1)


def test_a_tie_joins_two_sides_that_touch() -> None:
    case = Case.parse(TAPE)
    (tie,) = case.problem().ties
    assert tie == Tie(Boundary("backing", "bottom"), Boundary("adhesive", "top"))
    assert Case.parse(case.text) == case
    spaces = case.spaces()
    rows = spaces["adhesive"].rows
    # the layers share one row
    together = sum(space.size for space in spaces.values()) - rows[-1].size
    system = System(case.problem(), spaces)
    assert len(np.unique(system.constraints.tied.copies)) == together


def test_the_second_side_may_be_a_part() -> None:
    text = changed(LAYER, LAYER.replace("12", "8"))
    text = text.replace('"adhesive.top"]', '{ boundary = "adhesive.top", end = "8 mm" }]')
    (tie,) = Case.parse(text).problem().ties
    assert tie.to.part == (0.0, 8 / 12)


BAD = [
    (SIDES, 'between = ["backing.bottom"]', "tie.1.between", "a list of 2 boundaries is needed"),
    (SIDES, "", "tie.1.between", "the key is missing; a list of 2 boundaries is needed"),
    ('"adhesive.top"]', '"pad.top"]', "tie.1.between.2.boundary", "the bodies are adhesive, backing"),
    ('"adhesive.top"]', '"adhesive.front"]', "tie.1.between.2.boundary", "the sides are left, right"),
    ('"adhesive.top"]', '"backing.top"]', "tie.1.between", "a body is not tied to itself"),
    (SIDES, f"{SIDES}\nlaw = 'contact'", "tie.1.law", "there is no such key; here the keys are between"),
    (
        '["backing.bottom"',
        '[{ boundary = "backing.bottom", end = "8 mm" }',
        "tie.1.between",
        "the first side follows as a whole",
    ),
    (
        "[[interface]]\n",
        '[[tie]]\nbetween = ["adhesive.top", "backing.bottom"]\n\n[[interface]]\n',
        "tie.2.between",
        "a part of this side is tied already",
    ),
    (
        '"adhesive.bottom"',
        '"adhesive.top"',
        "tie.1.between",
        "a part of this side is a side of an interface",
    ),
]


@pytest.mark.parametrize(("old", "new", "field", "words"), BAD)
def test_bad_ties_are_refused(old: str, new: str, field: str, words: str) -> None:
    with pytest.raises(InputError, match=re.escape(words)) as caught:
        Case.parse(changed(old, new))
    assert caught.value.field == field
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('on = "adhesive.top"', 'on = "adhesive.top"\ngap = "0.1 mm"', "its point"),
        (LAYER, LAYER.replace("12", "15"), "exchange the sides"),
        ('"adhesive.top"]', '{ boundary = "adhesive.top", end = 0.5 }]', "leaves the part of the second one"),
    ],
)
def test_sides_that_do_not_touch_are_refused_before_the_run(old: str, new: str, words: str) -> None:
    case = Case.parse(changed(old, new))
    with pytest.raises(InputError, match=words) as caught:
        System(case.problem(), case.spaces())
    assert case.named(caught.value).field == "tie.1.between"


def test_a_body_that_is_tied_needs_no_support() -> None:
    loose = TAPE.replace('\n[[support]]\nboundary = "backing.left"\nholds = "x"\n', "")
    case = Case.parse(loose)
    assert System(case.problem(), case.spaces()).count > 0
    with pytest.raises(InputError, match="nothing holds or drives this body; give it an"):
        Case.parse(loose.replace(f"[[tie]]\n{SIDES}\n", "").replace('"backing.right"', '"adhesive.right"'))


def test_options_and_new_values_reach_a_tie() -> None:
    case = with_options(Case.parse(TAPE), to="0.5 mm")
    other = case.with_values({"tie.1.between": ["adhesive.top", "backing.bottom"]})
    assert other.problem().ties[0].boundary.body == "adhesive"
