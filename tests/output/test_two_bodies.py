"""Outputs of a run of two tapes side by side: all of them show both bodies and both interfaces."""

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista
from PIL import Image
from vtk_files import ReadGrid, series

from isopeel.cli import main
from isopeel.html_report.content import stage_content
from isopeel.post.fields import sample_fields
from isopeel.post.front import front_profile
from isopeel.running.run_reader import StoredStage, read_stages

TAPES = """
name = "two-tapes"

[[body]]
name = "upper"
length = "40 nm"
height = "2 nm"
material = { law = "neo-hooke", youngs_modulus = "2 GPa", poissons_ratio = 0.2 }
space = "N2.1"
mesh = "20x2"

[[body]]
name = "lower"
length = "20 nm"
height = "1 nm"
at = ["60 nm", "0 nm"]
material = { law = "neo-hooke", youngs_modulus = "1 GPa", poissons_ratio = 0.3 }
space = "N3"
mesh = "10x1"

[[interface]]
boundary = "upper.bottom"
length = "30 nm"
law = "exponential"
strength = "60 MPa"
work_of_adhesion = "0.03 J/m^2"
substrate = { kind = "flat" }

[[interface]]
boundary = "lower.bottom"
length = "15 nm"
law = "exponential"
strength = "40 MPa"
work_of_adhesion = "0.02 J/m^2"
irreversible = true
substrate = { kind = "flat" }

[[support]]
boundary = "upper.left"
holds = "x"

[[support]]
boundary = "lower.left"
holds = "x"

[drive]
boundary = "upper.right"
to = "150 deg"
step = "5 deg"

[output]
fields_every = "50 deg"
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("two")
    (place / "case.toml").write_text(TAPES, "utf-8")
    assert main(["run", str(place / "case.toml"), "--out", str(place / "out")]) == 0
    return place / "out"


@pytest.fixture(scope="module")
def stage(folder: Path) -> StoredStage:
    (one,) = read_stages(folder)
    return one


def test_the_grids_of_both_bodies_are_read_back(
    folder: Path, stage: StoredStage, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["export", str(folder), "--out", str(tmp_path), "--linear", "2"]) == 0
    assert "4 states, to 150 deg" in capsys.readouterr().out
    last = stage.run.states[-1]
    for name, cells in (("upper", 160), ("lower", 40)):
        read = ReadGrid(tmp_path / f"body-{name}-0003.vtu")
        assert read.grid.GetNumberOfCells() == cells
        assert read.field_data["part"].GetValue(0) == name
        fields = sample_fields(stage.stage.problem, stage.spaces, last.displacement, (2, 2), name)
        rest = fields.reference_position.reshape(-1, 2)
        np.testing.assert_array_equal(read.points[:, :2], rest)
        # sums in another order
        moved = read.points + read.at_points("displacement [L0]")
        np.testing.assert_allclose(moved[:, :2], fields.position.reshape(-1, 2), rtol=1e-12, atol=1e-12)
        invariant = read.at_points("I1 [1]")
        np.testing.assert_allclose(invariant, fields.first_invariant.ravel(), rtol=1e-12, atol=1e-14)
    (body, side) = (series(tmp_path / f"{name}.pvd") for name in ("body", "adhesive-side"))
    assert [time for time, _ in body] == [time for time, _ in side] == 2 * [0, 50, 100, 150]
    assert len(list(tmp_path.iterdir())) == 2 + 16


def test_paraview_s_series_has_both_bodies_at_each_time(folder: Path, tmp_path: Path) -> None:
    assert main(["export", str(folder), "--out", str(tmp_path), "--linear", "1"]) == 0
    reader = pyvista.PVDReader(str(tmp_path / "body.pvd"))
    assert reader.time_values == [0, 50, 100, 150]
    reader.set_active_time_value(150)
    found: Any = reader.read()
    assert [block.n_cells for block in found] == [40, 10]
    # the second lies 60 beside the first
    assert found[1].bounds[0] == pytest.approx(60.0)


def test_the_summary_and_the_curve_name_each_interface(folder: Path, stage: StoredStage) -> None:
    summary = json.loads((folder / "summary.json").read_text("utf-8"))
    zones = summary["process_zone"]
    assert list(zones) == ["upper.bottom", "lower.bottom"]
    assert zones["upper.bottom"]["measured"]["length"] > 0
    assert zones["lower.bottom"]["measured"] is None
    quantities = {one["quantity"]: one["value"] for one in summary["readings"]}
    with (folder / "curve.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    # of the body that is pulled alone
    columns = [name for name in rows[0] if name.startswith("crack_length")]
    assert columns == ["crack_length upper.bottom [nm]"]
    assert float(rows[-1][columns[0]]) == quantities["crack length, upper.bottom"] > 10
    assert stage.found().closed_form is None


@pytest.mark.parametrize("command", ["plot", "animate", "report"])
def test_each_command_draws_the_run(command: str, folder: Path) -> None:
    arguments = ["--format", "gif"] if command == "animate" else []
    assert main([command, str(folder), *arguments]) == 0
    drawn = {path.name for path in (folder / "figures").glob("*")} | {path.name for path in folder.glob("*")}
    expected = {"plot": "tractions.png", "animate": "animation.gif", "report": "report.html"}
    assert expected[command] in drawn


def test_a_window_shows_both_bodies(folder: Path, tmp_path: Path) -> None:
    picture = tmp_path / "view.png"
    assert main(["view", str(folder), "--screenshot", str(picture)]) == 0
    pixels = np.asarray(Image.open(picture).convert("RGB")).astype(int)
    # vermilion faces of both, with nothing between them
    red = np.flatnonzero((np.abs(pixels - (213, 94, 0)).sum(axis=2) < 60).any(axis=0))
    assert np.diff(red).max() > 0.1 * np.ptp(red)


def test_the_page_has_both(stage: StoredStage) -> None:
    content = stage_content(stage, stage.found(), 10_000_000)
    assert [side["name"] for side in content["sides"]] == ["upper.bottom", "lower.bottom"]
    assert [grid[:2] for grid in content["grids"]] == [[20, 2], [10, 1]]
    assert all(len(state["bodies"]) == len(state["faces"]) == 2 for state in content["states"])
    profile = front_profile(
        stage.stage.problem, stage.spaces, stage.run.states[-1].displacement, interface="upper.bottom"
    )
    assert np.abs(profile.adhesive_traction).max() == pytest.approx(0.03, rel=0.02)  # at points of elements


def test_laws_of_both_are_shown(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = folder.parent / "case.toml"
    assert main(["law", str(case), "--out", str(tmp_path / "law.png")]) == 0
    text = capsys.readouterr().out
    assert "upper.bottom" in text
    assert "lower.bottom" in text
    assert {path.name for path in tmp_path.iterdir()} == {"law-upper.bottom.png", "law-lower.bottom.png"}
