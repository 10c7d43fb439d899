"""Sensitivities of a run are the derivatives that runs with other values of the parameters have."""

import csv
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console

from isopeel.case import Case, load_case
from isopeel.common.errors import InputError
from isopeel.results.curve import Curve
from isopeel.running.in_memory import stage_results
from isopeel.running.resume import resume_case
from isopeel.running.run import run_case
from isopeel.running.sensitivities import Differentiation
from isopeel.running.stage_run import stage_runs
from isopeel.solve.newton import NewtonSettings

#: What the issue asks for. Central differences of fourth order have an error of 1e-9 with the shares below.
ALLOWED = 1e-6
#: Shares of the parameter in the differences: round-off of the reaction, 1e-13 with the tolerance below, is
#: divided by it.
SHARE = 1e-3


@pytest.fixture
def tightened(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let all runs converge to round-off: reactions are otherwise known to 5e-9 only."""
    _, *others = NewtonSettings.__init__.__defaults__ or ()
    monkeypatch.setattr(NewtonSettings.__init__, "__defaults__", (1e-28, *others))


def traced(case: Case, keys: Sequence[str] = ()) -> list[Curve]:
    """Return the curves of the stages, without the readings and notes, which take longer."""
    differentiation, base, curves = Differentiation.of(case, keys), None, []
    for number, begun in enumerate(stage_runs(case, Path())):
        steps = list(differentiation.steps(number, replace(begun, base=base)))
        curves.append(Curve.of(steps, begun.stage.problem.drive, differentiation.sensitive_to))
        base = steps[-1].state
    return curves


def check(case: Case, keys: list[str], allowed: float = ALLOWED) -> None:
    """Compare sensitivities of all stages with central differences, as shares of the largest one."""
    found = traced(case, keys)
    for k, (key, value, unit) in enumerate(found[0].sensitive_to):
        varied = {}
        for multiple in (-2, -1, 1, 2):
            other = value * (1 + multiple * SHARE)
            varied[multiple] = traced(case.with_values({key: f"{other!r} {unit}" if unit else other}))
        for stage, curve in enumerate(found):
            one = {multiple: curves[stage] for multiple, curves in varied.items()}
            for same in one.values():
                np.testing.assert_array_equal(same.parameter, curve.parameter)
            far, near = one[2].reaction - one[-2].reaction, one[1].reaction - one[-1].reaction
            expected = (8 * near - far) / (12 * SHARE * value)
            deviation = np.abs(curve.sensitivities[:, k] - expected).max() / np.abs(expected).max()
            assert deviation < allowed, f"{key}, stage {stage}: {deviation:.1e}"


@pytest.mark.usefixtures("tightened")
def test_of_a_reversible_strip() -> None:
    values = {"discretization.mesh": "40x2", "drive.to": "12 deg", "drive.step": "1 deg", "reading": None}
    keys = ["adhesion.hamaker_constant", "material.poissons_ratio", "body.height"]
    check(load_case("strip").with_values(values), keys)


@pytest.mark.parametrize(
    ("key", "says"),
    [
        ("adhesion.hamaker", "the case states no 'hamaker' there"),
        ("adhesion.law", "one number is needed"),
        ("drive.to", "does not depend on it"),
        ("discretization.mesh", "does not depend on it"),
        ("", "the case states no '' there"),
    ],
)
def test_what_is_no_parameter(key: str, says: str) -> None:
    with pytest.raises(InputError, match=says) as caught:
        next(stage_results(load_case("strip"), [key]))
    assert caught.value.field == key or not key


def test_a_run_without_them_has_none() -> None:
    values = {"discretization.mesh": "40x2", "drive.to": "2 deg", "drive.step": "1 deg", "reading": None}
    (results,) = stage_results(load_case("strip").with_values(values))
    assert results.run.curve.sensitive_to == ()
    assert results.run.curve.sensitivities.shape == (3, 0)


def tape(**values: Any) -> Case:
    """Return a tape with few elements that is pulled a short way."""
    short = {"drive.to": "8 nm", "drive.step": "0.5 nm", "drive.path_control": "newton", "reading": None}
    mesh = {"discretization.mesh": "60x2", "body.length": "120 nm", "adhesion.length": "90 nm"}
    return load_case("tape-angle").with_values({**short, **mesh, "output": None, **values})


@pytest.mark.usefixtures("tightened")
def test_of_a_load_of_unknown_size_and_its_angle() -> None:
    check(tape(), ["drive.angle", "adhesion.sliding_length"])


@pytest.mark.usefixtures("tightened")
def test_of_forces_without_a_potential() -> None:
    values = {"discretization.mesh": "40x2", "drive.to": "6 deg", "drive.step": "1 deg", "reading": None}
    case = load_case("strip").with_values({**values, "adhesion.traction": "projected"})
    check(case, ["adhesion.equilibrium_distance"])


@pytest.mark.usefixtures("tightened")
def test_of_a_joint_with_damage() -> None:
    """The derivative of the maximum openings is carried from step to step."""
    values = {"discretization.mesh": "60x2", "drive.to": "0.5 mm", "drive.step": "0.05 mm", "output": None}
    # a law without kinks: at these, differences with finite steps are in error
    smooth = {"adhesion.law": "exponential", "adhesion.rise": None}
    case = load_case("double-cantilever").with_values({**values, **smooth})
    check(case, ["adhesion.work_of_adhesion", "body.height"])


@pytest.mark.usefixtures("tightened")
def test_after_a_stage_under_a_prescribed_load() -> None:
    """The second stage begins with displacement and history that depend on the parameter."""
    stages = [
        {
            "name": "load",
            "kind": "force",
            "side": "right",
            "angle": "90 deg",
            "to": "0.3 mm",
            "step": "0.1 mm",
        },
        {"name": "slide", "kind": "force", "control": "force", "side": "right", "angle": "90 deg"}
        | {"to": "1 N/mm", "step": "0.5 N/mm"},
    ]
    values = {"discretization.mesh": "60x2", "output": None, "drive": stages}
    smooth = {"adhesion.law": "exponential", "adhesion.rise": None}
    check(load_case("double-cantilever").with_values({**values, **smooth}), ["adhesion.strength"])


@pytest.mark.usefixtures("tightened")
def test_of_two_bodies() -> None:
    values = {"discretization.mesh": "36x1", "drive.to": "2 mm", "drive.step": "0.4 mm", "output": None}
    case = load_case("t-peel").with_values(values)
    check(case, ["interface.1.strength", "body.2.height"])


def test_a_length_by_which_tied_meshes_cease_to_match_is_refused() -> None:
    case = load_case("laminate").with_values({"body.1.mesh": "20x1", "body.2.mesh": "20x1", "output": None})
    with pytest.raises(InputError, match="the mesh or its unknowns change") as caught:
        Differentiation.of(case, ["body.2.length"]).of_stage(0, stage_runs(case, Path())[0])
    assert caught.value.field == "body.2.length"


@pytest.mark.usefixtures("tightened")
def test_of_a_joint_of_mixed_modes() -> None:
    """The history of its law has damage, mixity and dissipated energy."""
    values = {"discretization.mesh": "50x2", "drive.to": "0.3 mm", "drive.step": "0.1 mm", "output": None}
    case = load_case("mixed-mode-bending").with_values(values)
    check(case, ["interface.1.shear_work", "drive.on.1.factor"])


@pytest.mark.usefixtures("without_figures")
def test_a_run_stores_them(tmp_path: Path) -> None:
    case, keys = tape(), ["body.height", "adhesion.hamaker_constant"]
    run, folder = run_case(case, tmp_path, Console(quiet=True), sensitivities=keys)
    (in_memory,) = stage_results(case, keys)
    assert run.curve.sensitive_to == in_memory.run.curve.sensitive_to
    np.testing.assert_array_equal(run.curve.sensitivities, in_memory.run.curve.sensitivities)
    (plain,) = stage_results(case)
    np.testing.assert_array_equal(run.curve.reaction, plain.run.curve.reaction)
    with (folder / "curve.csv").open() as file:
        rows = list(csv.DictReader(file))
    # E0 L0 is 2 N/m
    column = [float(row["d force / d body.height [N/m per nm]"]) for row in rows]
    np.testing.assert_allclose(column, 2 * run.curve.sensitivities[:, 0], rtol=1e-15)
    readings = {
        one["quantity"]: one["value"] for one in json.loads((folder / "summary.json").read_text())["readings"]
    }
    k = int(np.argmax(run.curve.reaction))
    relative = 4 * run.curve.sensitivities[k, 0] / run.curve.reaction[k]
    assert readings["d ln largest force, body.height"] == pytest.approx(relative, rel=1e-14)
    assert (folder / "figures" / "sensitivities.png").exists()


@pytest.mark.usefixtures("without_figures")
def test_a_resumed_run_goes_on_with_them(tmp_path: Path) -> None:
    case, keys = tape(), ["body.height"]
    run_case(tape(**{"drive.to": "4 nm"}), tmp_path, Console(quiet=True), sensitivities=keys)
    run, _ = resume_case(tmp_path, Console(quiet=True), to="8 nm")
    (whole,) = stage_results(case, keys)
    np.testing.assert_array_equal(run.curve.sensitivities, whole.run.curve.sensitivities)


@pytest.mark.usefixtures("without_figures")
def test_a_run_with_damage_is_not_resumed_with_them(tmp_path: Path) -> None:
    values = {"discretization.mesh": "60x2", "drive.to": "0.1 mm", "drive.step": "0.05 mm", "output": None}
    case = load_case("double-cantilever").with_values(values)
    run_case(case, tmp_path, Console(quiet=True), sensitivities=["body.height"])
    with pytest.raises(InputError, match="run the case again"):
        resume_case(tmp_path, Console(quiet=True), to="0.2 mm")
    # a complete one only gets the files that it lacks
    (tmp_path / "curve.csv").unlink()
    resume_case(tmp_path, Console(quiet=True))
    assert "d force / d body.height" in (tmp_path / "curve.csv").read_text()
