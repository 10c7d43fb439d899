"""The command: its files, for runs of each kind, and its errors for bad input."""

import shutil
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from vtk_files import ReadGrid, series

import isopeel
from isopeel.cli import main
from isopeel.post.fields import sample_fields
from isopeel.results.run_file import write_run

SMALL = ("--mesh", "20x2", "--space", "N2", "--to", "25", "--step", "5")
STAGES = """
[[drive]]
name = "lift"
kind = "displacement"
side = "right"
angle = "90 deg"
to = "1 nm"
step = "1 nm"

[[drive]]
name = "on"
kind = "displacement"
side = "right"
angle = "90 deg"
to = "2 nm"
step = "1 nm"
"""


@pytest.fixture(scope="module")
def finished(without_figures: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("finished")
    assert main(["run", "strip", *SMALL, "--out", str(folder)]) == 0
    return folder


@pytest.fixture
def run(finished: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A run of fields at 0, 10, 20 and 25 degrees, in the folder `out` of the current one."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(finished, "out")
    return Path("out")


def the_error(capsys: pytest.CaptureFixture[str]) -> str:
    error = capsys.readouterr().err
    assert error.startswith("isopeel: ")
    assert error.count("\n") == 1
    assert "Traceback" not in error
    return error


def test_a_series_along_the_parameter(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", "out"]) == 0
    shown = capsys.readouterr()
    assert (shown.out, shown.err) == (
        "4 states, to 25 deg: out/paraview/body.pvd and adhesive-side.pvd\n",
        "",
    )
    stored = isopeel.read_run(run / "run.h5")
    for name, cells in (("body", 40), ("adhesive-side", 15)):
        states = series(run / "paraview" / f"{name}.pvd")
        assert [time for time, _ in states] == [state.parameter for state in stored.states] == [0, 10, 20, 25]
        for time, file in states:
            read = ReadGrid(file)
            assert read.grid.GetNumberOfCells() == cells
            assert read.field_data["TimeValue"].GetTuple(0) == (time,)
            message = {text: read.field_data[text].GetValue(0) for text in ("case", "L0", "E0", "time")}
            assert message == {"case": "strip", "L0": "1 nm", "E0": "2 GPa", "time": "theta_deg [degree]"}
    assert len(list((run / "paraview").iterdir())) == 10


def test_the_boundary_is_in_equilibrium(run: Path) -> None:
    """The end is free to move, so that the substrate pulls the body with no force across it."""
    assert main(["export", "out"]) == 0
    read = ReadGrid(run / "paraview" / "adhesive-side-0003.vtu")
    points, weights = np.polynomial.legendre.leggauss(3)
    tractions = np.array(
        [
            [read.evaluate(cell, ((s + 1) / 2, 0.0), "adhesive traction [E0]")[1] for s in points]
            for cell in range(15)
        ]
    )
    # elements of 10 L0; the solver's forces converge to 1e-9 of them, and the peak is above 1e-3
    assert np.abs(5 * np.einsum("k,ekc->c", weights, tractions)).max() < 1e-8
    assert tractions[..., 1].min() < -1e-3


def test_straight_cells_have_exact_values_at_their_corners(run: Path) -> None:
    assert main(["export", "out", "--linear", "3", "--out", "here/straight"]) == 0
    stored = isopeel.read_run(run / "run.h5")
    case = isopeel.Case.parse(stored.case_text)
    read = ReadGrid(Path("here/straight/body-0003.vtu"))
    assert (read.grid.GetNumberOfCells(), read.grid.GetCellType(0)) == (40 * 9, 9)
    assert read.grid.GetPointData().GetRationalWeights() is None
    own = sample_fields(case.problem(), case.space(), stored.nearest(25.0).displacement, (3, 3))
    X, u = read.points, read.at_points("displacement [L0]")
    # one subtraction of lengths of up to 200
    assert np.abs(X[:, :2] + u[:, :2] - own.position.reshape(-1, 2)).max() < 1e-13
    np.testing.assert_array_equal(X[:, :2], own.reference_position.reshape(-1, 2))
    np.testing.assert_array_equal(read.at_points("I1 [1]"), own.first_invariant.ravel())
    P = read.at_points("first Piola-Kirchhoff stress [E0]")
    np.testing.assert_array_equal(P, own.nominal_stress.reshape(-1, 9))
    # all cells run anticlockwise, and fill the strip
    cells = read.cells.reshape(-1, 4)
    corners = X[cells, :2]
    one, other = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    areas = (one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]) / 2
    assert areas.min() > 0
    assert areas.sum() == pytest.approx(2000, rel=1e-12)  # round-off
    mean = read.at_points("I1 [1]")[cells]
    # the mean of corners misses the centre by the curvature of I1 in a third of an element
    assert np.abs(read.in_cells("I1 [1]") - mean.mean(axis=1)).max() < 0.02 * np.abs(mean).max()
    lines = ReadGrid(Path("here/straight/adhesive-side-0003.vtu"))
    assert (lines.grid.GetNumberOfCells(), lines.grid.GetCellType(0)) == (45, 3)
    x = lines.points[:, 0]
    assert (x[0], x[-1]) == (0, 150)


def test_files_of_an_earlier_export_are_removed(run: Path) -> None:
    folder = run / "paraview"
    folder.mkdir()
    for name in ("body-0007.vtu", "adhesive-side-12345.vtu", "body-mine.vtu", "body-0001.vtu"):
        (folder / name).write_text("<!-- isopeel -->")  # as it marks its own
    assert main(["export", "out"]) == 0
    names = {path.name for path in folder.iterdir()}
    assert "body-mine.vtu" in names
    assert not names & {"body-0007.vtu", "adhesive-side-12345.vtu"}
    assert ReadGrid(folder / "body-0001.vtu").grid.GetNumberOfCells() == 40


def test_each_stage_has_its_series(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    text = isopeel.load_case("strip").text.split("[drive]")[0].replace("200x10", "20x2")
    Path("stages.toml").write_text(text + STAGES)
    assert main(["run", "stages.toml", "--out", "out"]) == 0
    capsys.readouterr()
    assert main(["export", "out"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 2
    for stage, times in (("1-lift", [0, 1]), ("2-on", [0, 2])):
        states = series(Path("out") / stage / "paraview" / "body.pvd")
        assert [time for time, _ in states][:: len(states) - 1] == times
    last, first = (
        ReadGrid(Path("out") / stage / "paraview" / f"body-{number:04d}.vtu").at_points("displacement [L0]")
        for stage, number in (("1-lift", 1), ("2-on", 0))
    )
    # a stage begins where the one before ended; its first state is found anew, to the solver's tolerance
    assert np.abs(last - first).max() < 1e-6
    assert main(["export", "out", "--out", "both"]) == 0
    assert {path.name for path in Path("both").iterdir()} == {"1-lift", "2-on"}
    assert main(["export", "out/2-on", "--out", "one"]) == 0
    assert Path("one/body.pvd").exists()


@pytest.mark.parametrize("ending", ["running", "interrupted", "not converged"])
def test_a_run_that_did_not_end_is_written_as_far_as_it_got(
    run: Path, ending: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with h5py.File(run / "run.h5", "r+") as file:
        file.attrs["ending"] = ending
    assert main(["export", "out"]) == 0
    message = capsys.readouterr().out
    assert message.startswith("4 states, to 25 deg (the run ")
    assert len(series(run / "paraview" / "body.pvd")) == 4


def test_a_run_of_one_step(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["run", "strip", *SMALL[:4], "--to", "1", "--step", "1", "--out", "out"]) == 0
    assert main(["export", "out"]) == 0
    assert [time for time, _ in series(Path("out/paraview/body.pvd"))] == [0, 1]


def test_bad_input_is_one_line(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("empty").mkdir()
    Path("file").write_text("no folder")
    broken = Path("broken")
    broken.mkdir()
    (broken / "run.h5").write_bytes(b"nothing")
    for arguments, message in (
        (["none"], ["DIR", "'none'", "not a folder"]),
        (["file"], ["DIR", "'file'", "not a folder"]),
        (["empty"], ["DIR", "'empty'", "no run.h5"]),
        (["broken"], ["broken/run.h5", "the file of a run is needed"]),
        (["out", "--linear", "0"], ["--linear", "0", "1 to 20"]),
        (["out", "--linear", "21"], ["--linear", "21", "1 to 20"]),
        (["out", "--linear", "x"], ["--linear"]),
        (["out", "--out", "file"], ["--out", "'file'", "written"]),
        (["out", "--out", "file/in"], ["--out", "'file/in'", "written"]),
    ):
        assert main(["export", *arguments]) == 2
        error = the_error(capsys)
        for part in message:
            assert part in error
    assert not (run / "paraview").exists()


def test_files_that_lie_are_one_line(run: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stored = isopeel.read_run(run / "run.h5")
    text = stored.case_text
    for other, message in (
        (text.replace("20x2", "21x2"), "of another case"),
        (text.replace("neo-hooke", "other"), "cannot be read any more"),
    ):
        write_run(run / "run.h5", replace(stored, case_text=other))
        assert main(["export", "out"]) == 2
        assert message in the_error(capsys)
    write_run(run / "run.h5", replace(stored, states=(), last=None))
    assert main(["export", "out"]) == 2
    assert "has no converged step yet" in the_error(capsys)
