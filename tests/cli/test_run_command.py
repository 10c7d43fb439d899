"""`isopeel run`: its files, its summary, its exit codes, and input that it refuses."""

import io
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from command_output import FILES, SI, SMALL, summary, table, the_error
from scipy.integrate import trapezoid

import isopeel
from isopeel.cli import main

pytestmark = pytest.mark.usefixtures("in_own_folder", "without_figures")


@pytest.mark.usefixtures("with_figures")
def test_a_run_leaves_its_files(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "strip", *SMALL]) == 0
    out = Path("out/strip")
    assert {path.name for path in out.iterdir()} == FILES
    heading, rows = table(out / "curve.csv")
    assert heading[:4] == ["theta [deg]", "moment [N m/m]", "iterations", "stored_energy [J/m]"]
    assert rows[:, 0].tolist() == [0, 1, 2, 3]
    stored = isopeel.read_run(out / "run.h5")
    curve = stored.curve
    same = (curve.parameter, curve.reaction, curve.iterations, curve.stored_energy, curve.adhesive_energy)
    # both files hold all digits, the table in SI units
    assert rows[:, :5] == pytest.approx(np.stack(same, axis=1) * [1, SI, 1, SI, SI], rel=1e-15)
    # the moment's work, by the trapezoidal rule on a curve that is straight to 3e-4, is the energy gained
    energy = curve.stored_energy + curve.adhesive_energy
    work = trapezoid(curve.reaction, np.radians(curve.parameter))
    assert energy[-1] - energy[0] == pytest.approx(work, rel=1e-3)
    assert isopeel.Case.parse(stored.case_text).discretization.mesh == "20x2"
    assert stored.nearest(3.0).displacement.shape == (21 * 3, 2)
    for figure in ("curve.png", "shapes.png"):
        assert (out / figure).read_bytes().startswith(b"\x89PNG")
    shown = capsys.readouterr()
    assert "L1, 20x2, 126 DOFs" in shown.out
    assert shown.err == ""


def test_the_summary_has_readings_and_reasons_of_missing_ones() -> None:
    assert main(["run", "strip", *SMALL]) == 0
    found = summary(Path("out/strip"))
    assert (found["case"], found["space"], found["mesh"], found["dofs"]) == ("strip", "L1", "20x2", 126)
    assert (found["theta_deg"], found["completed"], found["failure"]) == (3.0, True, None)
    for name in ("plateau", "amplitude", "slopes", "window", "onset"):
        assert found[name] is None
    assert any("98 deg to 101.4 deg" in note["text"] for note in found["notes"])
    # sqrt(2 E' I W) and its onset, as published, rounded
    assert found["closed_form"]["reaction"] == pytest.approx(1.6315, abs=5e-5)
    assert found["closed_form"]["onset"] == pytest.approx(53.8, abs=0.05)
    assert found["closed_form"]["source"] == "beam theory"
    _, rows = table(Path("out/strip/curve.csv"))
    assert found["corrections"] == rows[:, 2].sum()
    assert found["corrections_per_step"] == rows[:, 2].mean()
    assert found["wall_time_s"] > rows[:, 7].sum()
    assert set(found["versions"]) == {"isopeel", "python", "numpy", "scipy", "numba"}


def test_a_plateau_is_read_in_the_window_of_the_case(tmp_path: Path) -> None:
    text = isopeel.load_case("strip").text
    Path("mine.toml").write_text(text.replace('"98 deg"', '"2 deg"').replace('"101.4 deg"', '"10 deg"'))
    arguments = ("--mesh", "40x2", "--space", "N2", "--to", "10", "--step", "0.5", "--traction", "projected")
    assert main(["run", "mine.toml", "--out", str(tmp_path / "a" / "b"), *arguments]) == 0
    found = summary(tmp_path / "a" / "b")
    _, rows = table(tmp_path / "a" / "b" / "curve.csv")
    assert SI * found["plateau"] == pytest.approx(rows[4:, 1].mean(), rel=1e-14)  # the order of a sum
    assert (found["window"], found["traction"]) == ([2.0, 10.0], "projected")
    assert not any("plateau" in note["text"] for note in found["notes"])


def test_no_equilibrium_ends_with_3_and_stores_the_converged_steps(
    capsys: pytest.CaptureFixture[str],
) -> None:
    # elements of 20 nm bend so badly that 20 degrees more need several states at once
    arguments = ("--mesh", "10x1", "--space", "L1", "--to", "80", "--step", "20", "--control", "newton")
    assert main(["run", "strip", *arguments]) == 3
    out = Path("out/strip")
    assert {path.name for path in out.iterdir()} == FILES
    _, rows = table(out / "curve.csv")
    stored, found = isopeel.read_run(out / "run.h5"), summary(out)
    assert stored.failure is not None
    assert 1 <= len(rows) < 5
    assert stored.curve.parameter.tolist() == rows[:, 0].tolist() == [20.0 * k for k in range(len(rows))]
    assert stored.ending == "not converged"
    assert stored.failure.parameter == found["failure"]["theta_deg"] == 20.0 * len(rows)
    assert (found["completed"], found["theta_deg"]) == (False, rows[-1, 0])
    error = capsys.readouterr().err
    reason = stored.failure.reason.replace("degrees", "deg")
    assert f"no equilibrium at {20 * len(rows)} deg: {reason}" in error
    assert f"cause: {stored.failure.cause}; {stored.failure.hint}" in error
    assert found["failure"]["cause"] == stored.failure.cause
    for measure in stored.failure.iterations:
        assert f"{measure:.3e}" in error
    assert "Traceback" not in error


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["strip", "--mesh", "0x10"], ["--mesh", "'0x10'", "1 to 100000 elements"]),
        (["strip", "--mesh", "200"], ["--mesh", "'200'", "200x10"]),
        (["strip", "--mesh", "1e9x10"], ["--mesh", "'1e9x10'", "200x10"]),
        (["strip", "--mesh", "1000000x10"], ["--mesh", "'1000000x10'", "1 to 100000 elements"]),
        (["strip", "--mesh", "100000x1000"], ["--mesh", "'100000x1000'", "GiB"]),
        (["large.toml"], ["discretization.mesh", "'100000x1000'", "GiB"]),
        (["strip", "--space", "X3"], ["--space", "'X3'", "L2, N4, N2.1"]),
        (["strip", "--step", "0"], ["--step", "'0'", "positive"]),
        (["strip", "--step", "-0.1"], ["--step", "-0.1", "positive"]),
        (["strip", "--step", "nan"], ["--step", "nan", "finite"]),
        (["strip", "--step", "1e-9"], ["--step", "'1e-9'", "100000 steps"]),
        (["strip", "--to", "181"], ["--to", "'181'", "180 degrees"]),
        (["strip", "--to", "inf"], ["--to", "inf", "finite"]),
        (["strip", "--traction", "x"], ["--traction", "'x'", "'projected'"]),
        (["strip", "--contact-points", "0"], ["--contact-points", "0", "Gauss points"]),
        (["strip", "--contact-points", "1000"], ["--contact-points", "1000", "1 to 100"]),
        (["strip", "--out", "file"], ["--out", "'file'", "written"]),
        (["strip", "--out", "file/x"], ["--out", "'file/x'", "written"]),
        (["none.toml"], ["CASE", "'none.toml'", "shipped case: curved-substrate"]),
        (["."], ["CASE", "'.'", "TOML file"]),
        (["file"], ["CASE", "'file'", "line 1"]),
        (["bad.toml"], ["body.length", "'2 GPa'", "a length is needed, such as '200 nm'"]),
        (["strip", "--steps", "3"], ["--steps"]),
        (["strip", "--step", "abc"], ["--step"]),
        (["strip", "more"], ["more"]),
        ([], ["CASE"]),
    ],
)
def test_bad_input_ends_with_2_and_one_line(
    arguments: list[str], message: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    Path("file").write_text("no TOML")
    text = isopeel.load_case("strip").text
    Path("bad.toml").write_text(text.replace('length = "200 nm"', 'length = "2 GPa"'))
    Path("large.toml").write_text(text.replace("200x10", "100000x1000"))
    assert main(["run", *arguments]) == 2
    error = the_error(capsys)
    for words in message:
        assert words in error
    assert not Path("out").exists()


@pytest.mark.parametrize("folder", ["a[b]", "a[/b]", ":x:"])
def test_paths_are_no_markup(folder: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "strip", *SMALL, "--to", "1", "--out", folder]) == 0
    assert folder in capsys.readouterr().out
    assert main(["spaces", "L2", "--out", f"{folder}/L2.png"]) == 0
    assert folder in capsys.readouterr().out.replace("/L2.png", "")


@pytest.mark.parametrize("folder", ["ü", "\udcff"])
def test_paths_may_be_no_text_of_the_terminal(folder: str, monkeypatch: pytest.MonkeyPatch) -> None:
    printed, error = io.BytesIO(), io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(printed, "ascii", write_through=True))
    monkeypatch.setattr(sys, "stderr", io.TextIOWrapper(error, "ascii", write_through=True))
    assert main(["run", "strip", *SMALL, "--to", "1", "--out", folder]) == 0
    assert error.getvalue() == b""
    # what is no text at all is shown by its escape
    assert re.search(rb"files in ([?]|.udcff)", printed.getvalue())
    assert {path.name for path in Path(folder).iterdir()} == FILES


def test_a_full_disk_ends_with_2(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    def fill_up(*_: object) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", fill_up)
    assert main(["run", "strip", *SMALL]) == 2
    assert "No space left on device" in the_error(capsys)
