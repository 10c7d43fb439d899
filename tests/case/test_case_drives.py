"""Drives on several boundaries and loads that are held, in case files of one body and of several."""

import numpy as np
import pytest

from isopeel import Boundary, Case, HeldLoad, InputError, MovedSide, PulledSide, RotatedSide, load_case
from two_arms import PULLED_APART, TWO_ARMS

ONE = load_case("strip").text
PEEL = """
[[drive]]
name = "peel"
kind = "force"
angle = "90 deg"
to = "1 nm"
step = "0.5 nm"
"""
LIFT = """
[[drive]]
kind = "displacement"
angle = "90 deg"
transverse = "held"
to = "1 nm"
step = "0.5 nm"

[[drive.on]]
boundary = "upper.top"
start = "16 nm"

[[load]]
boundary = "lower.bottom"
start = 0.25
end = "10 nm"
force = "0.02 N/m"
angle = "-90 deg"
"""
TWO = TWO_ARMS + PEEL + PULLED_APART + LIFT


def test_boundaries_factors_and_loads_are_read() -> None:
    first, second = (stage.problem for stage in Case.parse(TWO).stages())
    arms = (Boundary("upper", "right"), 1.0), (Boundary("lower", "right"), -1.0)
    assert first.drive == PulledSide(arms, np.pi / 2)
    assert first.driven_names == ("upper.right", "lower.right")
    assert second.drive == MovedSide(((Boundary("upper", "top", 0.8), 1.0),), np.pi / 2, "held")
    load = HeldLoad(Boundary("lower", "bottom", 0.25, 0.5), 0.01, -np.pi / 2)
    assert first.loads == second.loads == (load,)


def test_a_case_is_read_back_from_its_text() -> None:
    case = Case.parse(TWO)
    assert Case.parse(case.text) == case
    other = case.with_values({"drive.1.on.2.factor": -0.5, "load.1.force": "0.04 N/m"})
    assert other.problem().driven[1].factor == -0.5
    assert other.problem().loads[0].force == 0.02


def test_a_case_of_one_body_has_loads_and_several_boundaries() -> None:
    on = '\n[[drive.on]]\nboundary = "body.right"\n'
    on += '[[drive.on]]\nboundary = "body.top"\nend = 0.2\nfactor = 0.5\n'
    load = '[[load]]\nboundary = "body.top"\nstart = 0.5\nforce = "0.01 N/m"\nangle = "90 deg"\n'
    problem = Case.parse(ONE + on + load).problem()
    assert problem.drive == RotatedSide(
        ((Boundary("body", "right"), 1.0), (Boundary("body", "top", 0.0, 0.2), 0.5))
    )
    assert problem.loads == (HeldLoad(Boundary("body", "top", 0.5), 0.005, np.pi / 2),)


@pytest.mark.parametrize(
    ("old", "new", "field", "allowed"),
    [
        ("factor = -1.0", "factor = 0.0", "drive.1.on.2.factor", "its size must be from 1e-06 to 1e+06"),
        ("factor = -1.0", "factor = 1e300", "drive.1.on.2.factor", "its size must be from 1e-06 to 1e+06"),
        ("factor = -1.0", "factor = '1'", "drive.1.on.2.factor", "a number is needed"),
        ("factor = -1.0", "share = 1.0", "drive.1.on.2.share", "the keys are start, end, length, boundary"),
        ('"lower.right"', '"upper.right"', "drive.1.on", "the drive acts twice on one part"),
        ('"lower.right"', '"lower.front"', "drive.1.on.2.boundary", "the sides are left, right"),
        ('"upper.top"', '"middle.top"', "drive.2.on.1.boundary", "the bodies are upper, lower"),
        ('"16 nm"', '"26 nm"', "drive.2.on.1.start", "which is 20 nm long"),
        ('name = "peel"', 'boundary = "upper.right"', "drive.1.boundary", "the tables [[drive.on]]"),
        ('name = "peel"', "start = 0.5", "drive.1.start", "the tables [[drive.on]]"),
        ('"0.02 N/m"', '"0 N/m"', "load.1.force", "it must be finite, and not zero"),
        ('"0.02 N/m"', '"0.02 N"', "load.1.force", "a force per width is needed"),
        ('force = "0.02 N/m"', "", "load.1.force", "the key is missing; a force per width"),
        ('"-90 deg"', '"1 nm"', "load.1.angle", "an angle is needed"),
        ('"lower.bottom"', '"lower"', "load.1.boundary", "BODY.SIDE"),
    ],
)
def test_bad_values_name_their_key_and_what_is_allowed(old: str, new: str, field: str, allowed: str) -> None:
    assert old in TWO
    with pytest.raises(InputError) as caught:
        Case.parse(TWO.replace(old, new, 1))
    assert caught.value.field == field
    assert allowed in caught.value.allowed
    assert str(caught.value).count("\n") == 0
