"""The runs of the study."""

from dataclasses import replace

import pytest

from isopeel import row_space
from isopeel.case import OneBody
from isopeel.common import fingerprint
from isopeel.paper.study import (
    CONTACT_ROW,
    ELEVATED_ROW,
    LITERATURE,
    MESHES,
    SPACES,
    Run,
    contact_row_runs,
    default_points,
    literature_runs,
    quadrature_runs,
    table_runs,
    timed_runs,
    traction_runs,
    with_bases,
)


def test_the_published_study_is_27_runs_to_150_degrees() -> None:
    runs = table_runs(MESHES)
    assert len(set(runs)) == 27
    for run in runs:
        angles = run.angles_deg
        assert (len(angles), angles[0], angles[-1]) == (1501, 0.0, 150.0)
        assert angles[689] == 68.9  # no trace of binary fractions: angles are keys


def test_every_space_can_be_built_and_has_a_canonical_name() -> None:
    for space in (*SPACES, *CONTACT_ROW, *ELEVATED_ROW, *LITERATURE):
        assert row_space(space, MESHES["m1"]).name == space


@pytest.mark.parametrize(
    ("run", "name"),
    [
        (Run("L1+N2.1", "m3"), "L1+N2.1-m3"),
        (Run("N8", "m2", "projected"), "N8-m2-projected"),
        (Run("N2+N4@2", "m2", contact_points=3), "N2+N4@2-m2-3points"),
        (Run("L4", "m3", timed=True), "L4-m3-timed"),
        (Run("L1", "m1", plain=True), "L1-m1-plain"),
    ],
)
def test_names_distinguish_runs(run: Run, name: str) -> None:
    assert run.name == name


def test_names_and_keys_are_unique() -> None:
    runs = [
        *table_runs(MESHES),
        *contact_row_runs(MESHES),
        *literature_runs(MESHES),
        *traction_runs(),
        *quadrature_runs(),
    ]
    assert len({run.name for run in runs}) == len(runs)
    runs += timed_runs(table_runs(MESHES))
    runs += [replace(run, plain=True) for run in table_runs(MESHES)]
    assert len({run.name for run in runs}) == len(runs)
    chosen = {*runs[::7], runs[-1]}
    assert len({run.key for run in chosen}) == len(chosen)


def test_the_case_of_a_run_is_the_strip_with_its_choices() -> None:
    case = Run("N4", "m3", "projected", 7).case
    assert (case.discretization.space, case.discretization.mesh) == ("N4", "240x12")
    assert case.discretization.contact_points == 7
    assert case.problem().adhesion.traction == "projected"
    assert isinstance(case, OneBody)
    assert (case.body.length, case.body.height) == (200.0, 10.0)


def test_timed_runs_are_of_few_steps_on_the_plateau() -> None:
    (run,) = timed_runs([Run("L4", "m3")])
    assert run.base == Run("L4", "m3")
    assert (len(run.angles_deg), run.range_deg) == (21, (100.0, 102.0))


def test_points_go_from_2_to_one_more_than_the_default() -> None:
    points = [run.contact_points for run in quadrature_runs() if run.space == "L1+N4.1"]
    assert points == [2, 3, 4, 5, 7]  # p = 5
    assert default_points("L1+N4.1") == 6


def test_bases_come_first_and_once() -> None:
    runs = with_bases([*traction_runs(), Run("L4", "m2")])
    assert len(runs) == len(set(runs)) == 2 * len(traction_runs())
    for run in runs:
        if run.base is not None:
            assert runs.index(run.base) < runs.index(run)
    costs = [run.cost for run in runs if run.base is None]
    assert costs == sorted(costs, reverse=True)


def test_comments_do_not_change_the_fingerprint_but_code_does() -> None:
    source = 'def f(x):\n    """Docstring."""\n    return x + 1\n'
    same = '# comment\ndef f(x):\n    """Another."""\n\n    return (x + 1)\n'
    other = source.replace("x + 1", "x + 2")
    meaning = fingerprint._meaning
    assert meaning(source) == meaning(same) != meaning(other)
