"""The random pairs of strips of `benchmarks/stress_two_bodies.py`: their cases, and their tables."""

import sys
from dataclasses import replace
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

import stress_two_bodies as stress
from isopeel.case import Case
from isopeel.post.law import law_character


def test_a_seed_determines_the_pairs_whatever_their_number() -> None:
    assert stress.draws(3, 5) == stress.draws(3, 9)[:5]
    assert stress.draws(3, 5) != stress.draws(4, 5)


@pytest.mark.parametrize("law", list(stress.LAWS))
def test_the_case_has_the_strength_and_the_work_of_the_pair(law: str) -> None:
    pair = replace(stress.draws(0, 1)[0], law=law)
    case = Case.parse(pair.toml())
    problem, units = case.problem(), case.units.system()
    found = law_character(problem.interfaces[0].law)
    softer = min(body.youngs_modulus_gpa for body in (pair.upper, pair.lower))
    # the numbers in the text have six digits; the rounded kinks of a law lower its strength by up to 2 %
    assert found.strength * float(units.stress) == pytest.approx(pair.strength * softer * 1e9, rel=0.02)
    work = found.work_of_adhesion * float(units.stress * units.length)
    assert work == pytest.approx(pair.work, rel=1e-4)


def test_a_pair_is_traced_and_a_failure_reported() -> None:
    drawn = stress.draws(0, 1)[0]
    short = replace(drawn.upper, space="N2", mesh="12x1"), replace(drawn.lower, space="N2", mesh="9x1")
    pair = replace(drawn, upper=short[0], lower=short[1], law="exponential", drive="rotation")
    outcome = stress.Attempt(pair, 300.0)()
    assert outcome.cause == ""
    assert outcome.reached == pytest.approx(1.0)
    assert outcome.steps >= stress.STEPS + 1
    stopped = stress.Attempt(pair, 0.0)()
    assert (stopped.cause, stopped.steps) == ("time limit", 1)
    failed = replace(outcome, cause="limit point", reached=0.5)
    assert [next(iter(column.cells)) for column in stress.summary([(pair, outcome)]).columns][:3] == [
        *("all", "1", "1")
    ]
    assert stress.failures([(pair, outcome)]).row_count == 0
    assert "limit point" in str(next(iter(stress.failures([(pair, failed)]).columns[-1].cells)))
