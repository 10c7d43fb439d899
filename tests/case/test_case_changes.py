"""Other values for any keys of a case, from Python and from the command line."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from isopeel.case import Case, OneBody, assignment, load_case
from isopeel.cli import main
from isopeel.common.errors import InputError

STRIP = load_case("strip")
STAGES = load_case("press-and-peel")


def test_a_value_is_that_of_a_file_with_it() -> None:
    changed = STRIP.with_values({"body.height": "12 nm", "adhesion.hamaker_constant": "2e-19 J"})
    text = STRIP.text.replace('"10 nm"', '"12 nm"').replace('"1e-19 J"', '"2e-19 J"')
    assert text.count("12 nm") == text.count("2e-19 J") == 1
    assert changed == Case.parse(text)
    assert changed.text == Case.parse(text).text
    assert STRIP.text == load_case("strip").text  # left as it is


def test_values_of_a_stage_are_those_of_its_number() -> None:
    first, second, *_ = STAGES.with_values({"drive.2.path_control": "jump"}).stages()
    assert (first.path_control, second.path_control) == ("auto", "jump")


def test_tables_and_keys_that_were_not_there_are_made() -> None:
    changed = STRIP.with_values({"held.left": "xy", "substrate.gap": "1 nm", "body.height": "9 nm"})
    assert isinstance(changed, OneBody)
    assert changed.held is not None
    assert changed.held.left == "xy"


def test_none_leaves_a_key_out() -> None:
    assert STRIP.with_values({"discretization.mesh": None, "reading": None}).reading is None
    assert STRIP.with_values({"held.left": None}) == STRIP  # it was not there


@pytest.mark.parametrize("ratio", [0.3, np.float64(0.3)])
def test_numbers_may_be_those_of_numpy(ratio: float) -> None:
    changed = STRIP.with_values({"material.poissons_ratio": ratio})
    assert Case.parse(changed.text).problem().body.material.poissons_ratio == 0.3


@pytest.mark.parametrize(
    ("case", "key", "value", "needed"),
    [
        (STRIP, "body.height", "12", "no unit"),
        (STRIP, "body.hight", "12 nm", "no such key"),
        (STRIP, "body.height.x", "12 nm", "is no table"),
        (STRIP, "body..height", "12 nm", "a key is a dotted name"),
        (STRIP, "", "12 nm", "a key is a dotted name"),
        (STRIP, "a." * 40 + "b", 1, "a key is a dotted name"),
        (STRIP, "body.height", object(), "a text, a number"),
        (STRIP, "material.poissons_ratio", 0.7, "0.5"),
        (STAGES, "drive.9.to", "1 deg", "from 1 to"),
        (STAGES, "drive.to", "1 deg", "from 1 to"),
    ],
)
def test_what_cannot_be_is_refused_in_a_line(case: Case, key: str, value: Any, needed: str) -> None:
    with pytest.raises(InputError) as caught:
        case.with_values({key: value})
    line = str(caught.value)
    assert needed in line
    assert "\n" not in line


@pytest.mark.parametrize(
    ("text", "pair"),
    [
        ("body.height=12 nm", ("body.height", "12 nm")),
        ("body.height = '12 nm'", ("body.height", "12 nm")),
        ("material.poissons_ratio=0.3", ("material.poissons_ratio", 0.3)),
        ("discretization.grading=[1, 2.5]", ("discretization.grading", [1, 2.5])),
        ("adhesion.irreversible=true", ("adhesion.irreversible", True)),
        ("discretization.mesh=160x8", ("discretization.mesh", "160x8")),
        ("discretization.mesh=", ("discretization.mesh", None)),
        ("about=1\nname = 'x'", ("about", "1\nname = 'x'")),
    ],
)
def test_an_assignment_has_a_value_of_toml_or_a_text(text: str, pair: tuple[str, object]) -> None:
    assert assignment(text) == pair


@pytest.mark.usefixtures("without_figures")
def test_a_run_has_the_values_that_are_set(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = str(tmp_path / "out")
    values = ("--set", "discretization.mesh=20x2", "--set", "drive.to=2 deg", "--set", "drive.step=1 deg")
    assert main(["run", "strip", *values, "--out", out]) == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert (summary["mesh"], summary["theta_deg"]) == ("20x2", 2.0)
    capsys.readouterr()
    for wrong, line in (
        ("mesh", "KEY=VALUE"),
        ("body.hight=1 nm", "body.hight"),
        ("body.height=x", "body.height"),
    ):
        assert main(["run", "strip", "--set", wrong, "--out", out]) == 2
        error = capsys.readouterr().err
        assert line in error
        assert error.count("\n") == 1
