"""The random cases of `benchmarks/trial.py`: their draws, their answers, and the verdicts on runs."""

import sys
from functools import partial
from math import nan, pi, radians
from pathlib import Path
from timeit import timeit

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

from isopeel.case import Case, load_case
from isopeel.post.closed_form import double_cantilever_force, kendall_force, sliding_tape_force
from trials.dice import Dice
from trials.drawing import FAMILIES, refined, trial
from trials.energy import Gain, gain_in_parts, works
from trials.families import cantilevers, columns, cylinders, double_cantilevers, tapes
from trials.quantities import LENGTHS, written
from trials.running import Attempt, Outcome, unit_of
from trials.sheets import poissons_ratio
from trials.verdict import CLOSE, Verdict, deviation, verdict, warned_by_default
from trials.workers import Lost, run_all

#: A pad, a cantilever and a strip by a moment, on meshes that do.
CHEAP = (10, 17, 7)


def test_a_case_depends_on_its_seed_and_number_alone() -> None:
    assert trial(3, 7) == trial(3, 7)
    assert len({trial(seed, number).text for seed in (3, 4) for number in range(5)}) == 10


def test_every_family_is_drawn_by_its_weight() -> None:
    drawn = [trial(1, number).family for number in range(300)]
    for name, family in FAMILIES.items():
        # 300 draws scatter by three standard deviations of a binomial distribution
        share = family.weight / 100
        assert drawn.count(name) / 300 == pytest.approx(share, abs=3 * (share * (1 - share) / 300) ** 0.5)


@pytest.mark.parametrize("number", range(30))
def test_a_case_is_a_case_file(number: int, tmp_path: Path) -> None:
    drawn = trial(2, number)
    for name, text in {**drawn.drawn.files, "case.toml": drawn.text}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    case = load_case(tmp_path / "case.toml")
    assert len(case.stages()[0].parameters) <= 160
    assert drawn.drawn.answer.value > 0


def test_a_refined_case_differs_in_its_mesh_alone() -> None:
    one = next(trial(1, number) for number in range(99) if trial(1, number).family == "cylinders")
    fine = refined(one)
    assert fine.drawn.answer == one.drawn.answer
    changed = {name for name in one.drawn.sections if fine.drawn.sections[name] != one.drawn.sections[name]}
    assert changed == {"discretization"}


def test_poissons_ratios_go_from_0_to_0_4999() -> None:
    dice = Dice(np.random.default_rng(0))
    found = {poissons_ratio(dice) for _ in range(500)}
    assert (min(found), max(found)) == (0.0, 0.4999)


def test_quantities_are_written_with_handy_units() -> None:
    random = np.random.default_rng(0)
    for exponent in range(-9, 1):
        number, unit = written(random, 2.5 * 10.0**exponent, LENGTHS).split()
        assert 0.01 <= float(number) < 1000
        size = dict(LENGTHS)[unit]
        assert float(number) * size == pytest.approx(2.5 * 10.0**exponent, rel=1e-9)  # ten digits are written


def test_answers_of_tapes_equal_the_closed_forms_of_the_package() -> None:
    for degrees in (10.0, 90.0, 180.0):
        angle = radians(degrees)
        assert tapes.steady_force(0.3, 500.0, angle, bonded=True) == pytest.approx(
            kendall_force(0.3, 500.0, angle)
        )
        slides = sliding_tape_force(0.3, 500.0, angle)
        assert tapes.steady_force(0.3, 500.0, angle, bonded=False) == pytest.approx(slides)


def test_the_mean_force_of_a_double_cantilever_is_that_of_its_path() -> None:
    displacement = np.linspace(0.9, 1.0, 1001)
    forces = [double_cantilever_force(2.0, 3.0, 2 * value) for value in displacement]
    # the trapezoidal rule is that good on a thousand steps
    mean = np.trapezoid(forces, displacement) / 0.1
    assert double_cantilevers.mean_force(2.0, 3.0, 0.9, 1.0) == pytest.approx(mean, rel=1e-6)


def test_the_elastica_is_that_of_the_table() -> None:
    # Bisshopp and Drucker: of P L^2/(E'I) = 1 the end moves by 0.30172 L; small ones by a third of the load
    assert cantilevers.elastica_load(0.30172) == pytest.approx(1.0, rel=1e-4)
    assert cantilevers.elastica_load(1e-3) == pytest.approx(3e-3, rel=1e-5)


def test_slender_films_buckle_at_eulers_load() -> None:
    euler = pi**2 / 12 / 1e6
    assert columns.buckling_load(1.0, 0.0, 1.0, 1e3, clamped=True) == pytest.approx(4 * euler, rel=1e-5)
    assert columns.buckling_load(1.0, 0.0, 1.0, 1e3, clamped=False) == pytest.approx(euler / 4, rel=1e-6)


def test_a_pressed_cylinder_approaches_by_its_load() -> None:
    load = cylinders.pressed_load(0.01, 2.0, 1.0)
    half_width = (4 * load / (2 * pi)) ** 0.5
    assert load / (2 * pi) * (2 * np.log(4 / half_width) - 1) == pytest.approx(0.01, rel=1e-9)


def outcome(share: float, *notes: str) -> Outcome:
    return Outcome("completed", share * trial(1, 0).drawn.answer.value, notes)


@pytest.mark.parametrize(
    ("found", "expected"),
    [
        (outcome(1.02), Verdict.RIGHT),
        (outcome(1.005, "resolution: coarse"), Verdict.WARNED_CLOSE),
        (outcome(0.98, "resolution: coarse"), Verdict.WARNED),
        (outcome(1.04, "resolution: coarse"), Verdict.NOTED),
        (outcome(0.96), Verdict.SILENT),
        (outcome(nan), Verdict.SILENT),
        (Outcome("refused", cause="mesh"), Verdict.FAILED),
        (Outcome("not converged", cause="limit point"), Verdict.FAILED),
        (Outcome("too slow"), Verdict.SLOW),
        (Outcome("crashed", cause="Traceback"), Verdict.CRASHED),
    ],
)
def test_verdicts(found: Outcome, expected: Verdict) -> None:
    assert verdict(trial(1, 0), found) is expected


def test_notes_on_default_meshes_are_counted() -> None:
    trials = [trial(1, number) for number in range(40)]
    default = sum(one.default_mesh for one in trials)
    assert 0 < default < 40
    assert warned_by_default([(one, outcome(1.0)) for one in trials]) == (0, default)
    both = sum(one.default_mesh and one.default_space for one in trials)
    assert warned_by_default([(one, outcome(1.0)) for one in trials], any_space=False) == (0, both)
    assert warned_by_default([(one, outcome(1.0, "locking: much")) for one in trials]) == (default, default)


def test_the_work_of_a_curve_is_known_to_its_estimated_error() -> None:
    along = np.linspace(0.0, 3.0, 31)
    nothing = np.zeros(31, dtype=bool)
    work, error = works(along, np.sin(along), jumped=nothing)
    exact = np.cos(along[:-1]) - np.cos(along[1:])
    assert np.all(np.abs(work - exact) <= error + 1e-12)
    # a parabola of the largest curvature, 1, in seven steps of 0.1 is 0.06 off a line; half of that, in one
    assert error.max() <= 0.5 * 0.1 * 0.06 + 5 * 0.1**3 / 12
    # a kink in the middle of a step hides a triangle from the trapezoidal rule
    work, error = works(along, np.minimum(along, 3.1 - along), jumped=nothing)
    missing = 0.1 * 1.525 - work[15]  # both lines meet at 1.55
    assert missing * (1 - 1e-9) <= error[15]


def test_where_a_path_jumps_either_force_may_have_worked_in_the_whole_step() -> None:
    jumped = np.array([False, False, True, False])
    work, error = works(np.arange(4.0), np.array([1.0, 2.0, 0.5, 0.5]), jumped=jumped)
    assert work[1] + error[1] >= 2.0


def test_units_of_reactions_are_read() -> None:
    units = {"L0": "1 mm", "E0": "2 MPa"}
    assert unit_of("E0 L0", units, moment=False) == pytest.approx(2e3)
    assert unit_of("E0 L0^3", units, moment=True) == pytest.approx(2.0)  # of a width of L0
    assert unit_of("N/mm", units, moment=False) == pytest.approx(1e3)
    with pytest.raises(ValueError, match="unit"):
        unit_of("E0", units, moment=False)


def test_a_task_that_is_out_of_time_is_ended_and_others_go_on() -> None:
    endless = partial(timeit, number=10**15)
    done = run_all([endless, partial(str, 1)], 1, 0.5, lambda *_: None)
    assert isinstance(done[0], Lost)
    assert done[0].out_of_time
    assert done[1] == "1"


def test_cheap_cases_are_right(tmp_path: Path) -> None:
    for number in CHEAP:
        one = trial(1, number)
        found = Attempt(one, tmp_path)()
        assert found.ending == "completed"
        assert abs(deviation(one, found)) < CLOSE
    assert Case.parse(trial(1, CHEAP[0]).text).name == f"trial-1-{CHEAP[0]}"


def test_a_gain_that_is_the_error_of_the_rule_is_none_in_parts() -> None:
    """A step of a sliding tape in which the trapezoidal rule misses 1.6e-4 of W A of the work."""
    case = Case.parse(trial(1, 148).text)
    assert not gain_in_parts(case, 0, Gain(1.6e-4, 0.357, 17)).forbidden
