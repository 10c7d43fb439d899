"""The stages of a case: their drives, steps, windows and stored fields."""

import tomllib

import numpy as np
import pytest
from case_texts import STAGES, case_with, two_stages

from isopeel.case import Case, load_case, with_options
from isopeel.common.errors import InputError
from isopeel.problem import RotatedSide


def test_angles_are_multiples_of_the_step_and_end_at_the_requested_one() -> None:
    case = load_case("strip")
    requested = [float(f"{k}e-1") for k in range(1201)]
    (stage,) = case.stages()
    assert stage.name == "rotation"
    assert np.array_equal(stage.parameters, np.radians(requested))
    for to, step in ((3.0, 0.7), ("3 deg", "0.7 deg"), ("180 arcmin", "0.7"), ("3", "42 arcmin")):
        (stage,) = with_options(case, to=to, step=step).stages()
        assert np.array_equal(stage.parameters, np.radians([0, 0.7, 1.4, 2.1, 2.8, 3.0]))
    (stage,) = with_options(case, to=0.05).stages()
    assert np.array_equal(stage.parameters, np.radians([0, 0.05]))


def test_a_stage_may_jump_and_a_case_has_a_path_control() -> None:
    case = Case.parse(case_with(head='about = "A test."', drive='path_control = "jump"'))
    assert [stage.path_control for stage in case.stages()] == ["jump"]
    assert case.about == "A test."
    plain = Case.parse(case_with())
    assert [stage.path_control for stage in plain.stages()] == ["auto"]
    assert plain.about == ""
    with pytest.raises(
        InputError, match=r"drive\.path_control: 1 cannot be used; 'newton', 'auto', 'jump' or"
    ):
        Case.parse(case_with(drive="path_control = 1"))


@pytest.mark.parametrize(("keys", "drive", "parameters"), STAGES)
def test_a_stage_continues_in_the_dimension_of_its_drive(
    keys: str, drive: object, parameters: list[float]
) -> None:
    case = Case.parse(two_stages(keys + '\nname = "peel"'))
    first, last = case.stages()
    assert (first.name, last.name) == ("rotation", "peel")
    assert np.array_equal(first.parameters, np.radians([0.0, 1.0, 2.0, 3.0]))
    assert last.problem.drive == drive
    assert last.parameters.tolist() == parameters
    assert last.problem.body.material == first.problem.body.material
    assert case.problem().drive == RotatedSide("right")
    # a tenth, where nothing is said
    assert last.fields_every == pytest.approx(abs(parameters[-1]) / 10, rel=1e-15)
    assert first.fields_every == 10.0
    assert Case.parse(case.text) == case
    alone = Case.parse(case_with(drive=keys)).stages()
    assert [stage.name for stage in alone] == [tomllib.loads(keys)["kind"]]


def test_windows_and_fields_are_in_the_dimension_of_the_last_drive() -> None:
    tables = '\n[reading]\nwindow = ["5 angstrom", "2 nm"]\n[output]\nfields_every = "0.5 nm"\n'
    case = Case.parse(two_stages(STAGES[1][0]) + tables)
    assert case.reading is not None
    assert case.reading.window == (0.5, 2.0)
    assert case.output.fields_every == 0.5
    first, last = case.stages()
    assert (first.window, first.fields_every) == (None, 10.0)
    assert (last.window, last.fields_every) == ((0.5, 2.0), 0.5)
    # all stages of that dimension, the first one too
    tables = '\n[output]\nfields_every = "1 deg"\n'
    turned_on = Case.parse(
        two_stages('kind = "rotation"\nside = "right"\nto = "4 deg"\nstep = "1 deg"') + tables
    )
    assert [stage.fields_every for stage in turned_on.stages()] == [1.0, 1.0]
    with pytest.raises(InputError, match=r"output\.fields_every: '0\.5 nm'.*a force per width"):
        Case.parse(two_stages(STAGES[2][0]) + '\n[output]\nfields_every = "0.5 nm"')


def test_overrides_are_for_the_last_stage() -> None:
    case = with_options(Case.parse(two_stages(STAGES[1][0])), to="2 nm", step="5 angstrom")
    first, last = case.stages()
    assert first.parameters[-1] == np.radians(3.0)
    assert last.parameters.tolist() == [0.0, 0.5, 1.0, 1.5, 2.0]
    for to, reason in ((2.0, "no unit; a length is needed"), ("2 deg", "a length"), ("0 nm", "not be zero")):
        with pytest.raises(InputError, match=reason) as caught:
            with_options(case, to=to)
        assert (caught.value.field, caught.value.value) == ("--to", to)


def test_too_many_steps_are_an_error_of_the_given_option() -> None:
    stages = Case.parse(two_stages(STAGES[1][0]))
    single = Case.parse(case_with(drive=STAGES[1][0]))
    for case in (stages, single):
        with pytest.raises(InputError, match=r"^--to: '1 m' cannot be used; .* at least 10 µm is") as caught:
            with_options(case, to="1 m")
        assert (caught.value.field, caught.value.value) == ("--to", "1 m")
        with pytest.raises(InputError, match=r"^--step: '1 fm' cannot be used; .* at least 30 fm is"):
            with_options(case, step="1 fm")
        with pytest.raises(InputError, match=r"^--step: '1 fm' cannot be used; .* at least 20 fm is"):
            with_options(case, to="2 nm", step="1 fm")
