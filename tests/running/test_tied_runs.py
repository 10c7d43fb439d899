"""Runs of tied layers whose meshes do not match, from the case file to results, in two stages."""

import json
from pathlib import Path

import numpy as np
import pytest
from interrupted_runs import QUIET, check_resumed_run

from isopeel.assembly.system import System
from isopeel.case import Case
from isopeel.cli import main
from isopeel.results.run_file import read_run
from isopeel.running.run import run_case

pytestmark = pytest.mark.usefixtures("without_figures")
STAGE = """
[[drive]]
name = "{name}"
kind = "force"
angle = "90 deg"
boundary = "backing.right"
to = "{to}"
step = "0.25 nm"
"""
CASE = Case.parse(
    """
name = "layers"

[discretization]
space = "N2"

[[body]]
name = "adhesive"
length = "20 nm"
height = "1 nm"
material = { law = "neo-hooke", youngs_modulus = "0.5 GPa", poissons_ratio = 0.3 }
mesh = "20x1"

[[body]]
name = "backing"
on = "adhesive.top"
length = "20 nm"
height = "1 nm"
material = { law = "neo-hooke", youngs_modulus = "2 GPa", poissons_ratio = 0.3 }
mesh = "13x1"

[[tie]]
between = ["adhesive.top", "backing.bottom"]

[[interface]]
boundary = "adhesive.bottom"
length = "12 nm"
law = "exponential"
strength = "60 MPa"
work_of_adhesion = "0.1 J/m^2"
irreversible = true

[[support]]
boundary = "adhesive.left"
holds = "x"

[[support]]
boundary = "backing.left"
holds = "x"
"""
    + STAGE.format(name="open", to="3 nm")
    + STAGE.format(name="close", to="-1 nm")
)
STAGES = ("1-open", "2-close")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the whole run."""
    place = tmp_path_factory.mktemp("layers")
    assert run_case(CASE, place, QUIET).run.ending == "completed"
    return place


def test_the_layers_stay_tied_in_all_stages(folder: Path) -> None:
    spaces = CASE.spaces()
    followers = System(CASE.problem(), spaces).constraints.tied.followers
    for stage in STAGES:
        for state in read_run(folder / stage / "run.h5").states:
            u = state.displacement
            led = np.add.reduceat(followers.shares[:, None] * u[followers.leaders], followers.starts[:-1])
            np.testing.assert_allclose(u[followers.functions], led, rtol=0, atol=1e-14)


def test_a_stage_begins_where_the_last_one_ended(folder: Path) -> None:
    opened, closed = (read_run(folder / stage / "run.h5").curve for stage in STAGES)
    assert closed.reaction[0] == pytest.approx(opened.reaction[-1], rel=1e-8)  # both converged
    assert opened.dissipated_energy[-1] > 0


def test_the_energies_of_layers_and_interface_take_the_work(folder: Path) -> None:
    summary = json.loads((folder / STAGES[0] / "summary.json").read_text("utf-8"))
    taken = {one["quantity"]: one["value"] for one in summary["readings"]}
    parts = [taken[f"energy of {name}"] for name in ("adhesive", "backing", "adhesive.bottom")]
    assert min(parts) > 0
    # the work is integrated by the trapezoidal rule, with steps of a twelfth of the path
    assert sum(parts) == pytest.approx(taken["work of the drive"], rel=0.01)


@pytest.mark.parametrize("taken", [5, 14])
def test_an_interrupted_run_continues_bit_for_bit(
    taken: int, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the first stage of 13 steps, and in the second one."""
    check_resumed_run(CASE, folder, STAGES, taken, tmp_path, monkeypatch)


def test_figures_and_files_for_other_programs(folder: Path, tmp_path: Path) -> None:
    stage = str(folder / STAGES[0])
    assert main(["plot", stage, "--only", "tractions", "--out", str(tmp_path / "figures")]) == 0
    assert main(["export", str(folder), "--out", str(tmp_path / "files")]) == 0
    assert (tmp_path / "figures" / "tractions.png").exists()
    assert any((tmp_path / "files").iterdir())
