"""The random strips of `benchmarks/stress.py`: their ranges, their cases, and their tables."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

import stress
from isopeel.paper.study import SPACES
from isopeel.physics.adhesion import VanDerWaals
from isopeel.post.law import law_character


def test_a_seed_determines_the_strips_whatever_their_number() -> None:
    assert stress.draws(3, 5) == stress.draws(3, 9)[:5]
    assert stress.draws(3, 5) != stress.draws(4, 5)


def test_strips_are_of_the_ranges() -> None:
    drawn = stress.draws(0, 200)
    assert [draw.number for draw in drawn] == list(range(200))
    # four digits of each are kept
    for name, (low, high) in {
        "youngs_modulus_gpa": stress.YOUNGS_MODULUS,
        "poissons_ratio": stress.POISSONS_RATIO,
        "distance_nm": stress.DISTANCE,
        "hamaker_j": stress.HAMAKER,
        "height_nm": stress.HEIGHT,
    }.items():
        values = np.array([getattr(draw, name) for draw in drawn])
        assert low * (1 - 1e-3) <= values.min() <= values.max() <= high * (1 + 1e-3)
    assert max(draw.strength for draw in drawn) <= stress.STRONGEST
    assert {draw.space for draw in drawn} == set(SPACES)


def test_the_strength_is_that_of_the_law() -> None:
    draw = stress.draws(0, 1)[0]
    law = draw.case(150.0, 1.0, "auto").problem().adhesion.law
    assert isinstance(law, VanDerWaals)
    # the problem's unit of stress is 2 GPa
    strength = law_character(law).strength * 2.0 / draw.youngs_modulus_gpa
    assert draw.strength == pytest.approx(strength, rel=1e-6)


def test_a_strip_is_traced_under_each_path_control_and_its_failure_reported() -> None:
    draw = next(draw for draw in stress.draws(0, 200) if draw.mesh == "13x2")
    plain, automatic = stress.Attempt(draw, 60.0, 2.0)()
    assert (plain.path_control, automatic.path_control) == stress.PATH_CONTROLS
    assert automatic.reached_deg == pytest.approx(60.0)
    assert (automatic.cause, automatic.reason) == ("", "")
    assert plain.reached_deg < 60
    assert plain.cause
    table = stress.shares([(draw, (plain, automatic))])
    assert [next(iter(column.cells)) for column in table.columns][:6] == ["all", "", "", "1", "0.0", "100.0"]
    assert stress.failures([(draw, (plain, automatic))]).row_count == 0
