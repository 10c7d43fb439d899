"""Runs of two bodies that adhere to each other, from the case file to results, with damage and two stages."""

import json
from pathlib import Path

import numpy as np
import pytest
from interrupted_runs import QUIET, check_resumed_run

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
to = "{to}"
step = "0.25 nm"

[[drive.on]]
boundary = "upper.right"

[[drive.on]]
boundary = "lower.right"
factor = -1.0
"""
BODY = """
[[body]]
name = "{name}"
length = "20 nm"
height = "2 nm"
material = {{ law = "neo-hooke", youngs_modulus = "2 GPa", poissons_ratio = 0.3 }}
mesh = "{mesh}"
"""
#: Damage that is done in the first stage is there in the second one. The meshes do not match.
CASE = Case.parse(
    'name = "between"\n[discretization]\nspace = "N2"\n'
    + BODY.format(name="lower", mesh="20x1")
    + BODY.format(name="upper", mesh="16x1")
    + 'on = "lower.top"\n'
    + """
[[interface]]
between = ["upper.bottom", "lower.top"]
length = "12 nm"
law = "exponential"
strength = "60 MPa"
work_of_adhesion = "0.1 J/m^2"
irreversible = true

[[support]]
boundary = "upper.left"
holds = "xy"

[[support]]
boundary = "lower.left"
holds = "x"
"""
    + STAGE.format(name="open", to="2 nm")
    + STAGE.format(name="close", to="-1 nm")
)
STAGES = ("1-open", "2-close")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the whole run."""
    place = tmp_path_factory.mktemp("between")
    assert run_case(CASE, place, QUIET).run.ending == "completed"
    return place


def test_the_damaged_joint_closes_with_less_force(folder: Path) -> None:
    opened, closed = (read_run(folder / stage / "run.h5") for stage in STAGES)
    assert closed.curve.reaction[0] == pytest.approx(opened.curve.reaction[-1], rel=1e-8)  # both converged
    assert opened.curve.dissipated_energy[-1] > 0
    np.testing.assert_allclose(closed.curve.dissipated_energy, opened.curve.dissipated_energy[-1], rtol=1e-8)
    # at the opening of 1 nm, along the secant of the law
    assert 0 < closed.curve.reaction[-1] < opened.curve.reaction[4]


def test_energies_take_the_work(folder: Path) -> None:
    """The trapezoidal rule is exact to second order in the step: an eighth of the opening."""
    curve = read_run(folder / STAGES[0] / "run.h5").curve
    work = float(np.sum((curve.reaction[1:] + curve.reaction[:-1]) / 2)) * 0.25
    energy = curve.stored_energy + curve.adhesive_energy + curve.dissipated_energy
    assert energy[-1] - energy[0] == pytest.approx(work, rel=0.01)


def test_both_faces_have_results(folder: Path) -> None:
    summary = json.loads((folder / STAGES[0] / "summary.json").read_text("utf-8"))
    assert summary["completed"]
    assert {"upper.bottom", "lower.top"} <= set(summary["process_zone"])


@pytest.mark.parametrize("taken", [4, 11])
def test_an_interrupted_run_continues_bit_for_bit(
    taken: int, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the first stage of 9 steps, and in the second one."""
    check_resumed_run(CASE, folder, STAGES, taken, tmp_path, monkeypatch)


def test_figures_and_files_for_other_programs(folder: Path, tmp_path: Path) -> None:
    stage = str(folder / STAGES[0])
    assert main(["plot", stage, "--only", "tractions", "--out", str(tmp_path / "figures")]) == 0
    assert main(["export", str(folder), "--out", str(tmp_path / "files")]) == 0
    assert (tmp_path / "figures" / "tractions.png").exists()
    assert any((tmp_path / "files").iterdir())
