"""A case of several stages: folders, titles, what is stored, and what an earlier run left."""

import json
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console

import isopeel
from isopeel.case import Case
from isopeel.cli import main
from isopeel.running.folder import FILES
from isopeel.running.run import run_case

STAGES = """
[[drive]]
name = "lift"
kind = "displacement"
side = "right"
angle = "90 deg"
to = "1 nm"
step = "0.25 nm"

[[drive]]
name = "on"
kind = "displacement"
side = "right"
angle = "90 deg"
to = "2 nm"
step = "0.5 nm"
"""
TEXT = isopeel.load_case("strip").text.split("[drive]")[0].replace("200x10", "40x2").replace("N2.1", "N2")
CASE = Case.parse(TEXT + STAGES)
QUIET = Console(quiet=True)

pytestmark = pytest.mark.usefixtures("without_figures")


def test_each_stage_has_its_folder_and_continues(tmp_path: Path) -> None:
    run, folder = run_case(CASE, tmp_path, QUIET)
    assert folder == tmp_path / "2-on"
    assert {path.name for path in tmp_path.iterdir()} == {"1-lift", "2-on"}
    assert all({path.name for path in stage.iterdir()} == set(FILES) for stage in tmp_path.iterdir())
    first = isopeel.read_run(tmp_path / "1-lift" / "run.h5")
    assert first.base is None
    assert run.base is not None
    assert first.last is not None
    np.testing.assert_array_equal(run.base, first.last.displacement)
    assert (first.attributes["stage"], run.attributes["stage"]) == ("lift", "on")
    # the second stage begins with the force that the first one ended with
    assert run.curve.reaction[0] == pytest.approx(first.curve.reaction[-1], rel=1e-9)
    titles = [
        json.loads((tmp_path / name / "summary.json").read_text())["case"] for name in ("1-lift", "2-on")
    ]
    assert titles == ["strip, stage 1: lift", "strip, stage 2: on"]


def test_a_stored_stage_continues_bit_for_bit(tmp_path: Path) -> None:
    """From its file alone: the base, and the states of half of it."""
    run, _ = run_case(CASE, tmp_path, QUIET)
    assert run.base is not None
    second, space = CASE.stages()[1], CASE.space()
    base = isopeel.State(0.0, run.base)
    steps, states = [], []
    for step in isopeel.trace(second.problem, space, second.parameters, base=base):
        steps.append(step)
        states.append(step.state)
    assert [step.reaction for step in steps] == run.curve.reaction.tolist()
    again = list(isopeel.trace(second.problem, space, second.parameters[4:], base=base, start=states[3:4]))
    assert [step.reaction for step in again] == run.curve.reaction[4:].tolist()


def test_nothing_of_an_earlier_run_is_left(tmp_path: Path) -> None:
    run_case(CASE, tmp_path, QUIET)
    # a step that is too large: the first stage ends early, and there is no second one any more
    too_far = Case.parse(
        TEXT
        + STAGES.replace('to = "1 nm"', 'path_control = "newton"\nto = "400 nm"', 1).replace(
            '"0.25 nm"', '"100 nm"', 1
        )
    )
    run, folder = run_case(too_far, tmp_path, QUIET)
    assert (run.ending, folder) == ("not converged", tmp_path / "1-lift")
    # the finished run is kept until another one has finished
    assert [path.name for path in (tmp_path / "2-on").iterdir()] == ["run.earlier.h5"]
    single = Case.parse(TEXT + STAGES.split('[[drive]]\nname = "on"')[0])
    run_case(single, tmp_path, QUIET)
    assert list((tmp_path / "1-lift").iterdir()) == []
    assert list((tmp_path / "2-on").iterdir()) == []
    assert {path.name for path in tmp_path.iterdir() if path.is_file()} == set(FILES)


def test_folders_are_checked_before_the_first_step(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "case.toml"
    file.write_text(CASE.text)
    out = tmp_path / "out"
    out.mkdir()
    (out / "2-on").write_text("in the way")
    assert main(["run", str(file), "--out", str(out)]) == 2
    assert "--out" in capsys.readouterr().err
    assert not (out / "1-lift").exists()
