import csv
import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from time import sleep
from typing import Any

import numpy as np
import pytest
from psutil import Process, wait_procs
from scipy.integrate import trapezoid

import isopeel
from isopeel.cli import main
from isopeel.common.processes import cores
from isopeel.output.law import LAWS
from isopeel.results.run_writer import RunWriter
from isopeel.solve.newton import ConvergenceError
from isopeel.solve.step import KINDS

SMALL = ("--mesh", "20x2", "--space", "L1", "--to", "3", "--step", "1")
FILES = {"curve.csv", "run.h5", "summary.json", "curve.png", "shapes.png"}


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def table(path: Path) -> tuple[list[str], np.ndarray[Any, np.dtype[np.float64]]]:
    with path.open(newline="") as file:
        heading, *rows = csv.reader(file)
    kind = heading.index("kind")  # the only column of words
    for row in (heading, *rows):
        assert row.pop(kind) in ("kind", *KINDS)
    values = [[cell or "nan" for cell in row] for row in rows]  # what was not measured is left empty
    return heading, np.array(values, dtype=np.float64).reshape(len(rows), len(heading))


#: Moment per width of E0 L0^3 for a width of L0, 2 GPa nm^2, and an energy likewise.
SI = 2e9 * 1e-18


def summary(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "summary.json").read_text())
    return found


def the_error(capsys: pytest.CaptureFixture[str]) -> str:
    """Return the one line on standard error."""
    error = capsys.readouterr().err
    assert error.startswith("isopeel: ")
    assert error.endswith("\n")
    assert error.count("\n") == 1
    assert "Traceback" not in error
    return error


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
    reason = stored.failure.reason.replace("degree", "deg")
    assert f"no equilibrium at {20 * len(rows)} deg: {reason}" in error
    assert f"cause: {stored.failure.cause}; {stored.failure.hint}" in error
    assert found["failure"]["cause"] == stored.failure.cause
    for measure in stored.failure.iterations:
        assert f"{measure:.3e}" in error
    assert "Traceback" not in error


def test_ctrl_c_ends_with_130_and_stores_the_converged_steps(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    append = RunWriter.append

    def interrupted(self: RunWriter, step: isopeel.Step) -> None:
        append(self, step)
        if step.number == 2:
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(RunWriter, "append", interrupted)
    assert main(["run", "strip", *SMALL]) == 130
    assert "interrupted" in (error := the_error(capsys))
    assert "`isopeel resume out/strip` continues the run" in error
    out = Path("out/strip")
    # figures take longer than one who pressed Ctrl-C should wait
    assert {path.name for path in out.iterdir()} == {"curve.csv", "run.h5", "summary.json"}
    _, rows = table(out / "curve.csv")
    assert rows[:, 0].tolist() == isopeel.read_run(out / "run.h5").curve.parameter.tolist() == [0, 1, 2]
    assert (summary(out)["completed"], summary(out)["failure"]) == (False, None)


def test_ctrl_c_before_the_first_step_ends_with_130(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(_: RunWriter, step: isopeel.Step) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(RunWriter, "append", interrupted)
    assert main(["run", "strip", *SMALL]) == 130
    the_error(capsys)
    assert list(Path("out/strip").iterdir()) == []


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


def test_an_earlier_run_stays_until_the_new_one_starts(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "strip", *SMALL]) == 0
    before = {path: path.read_bytes() for path in Path("out/strip").iterdir()}
    assert main(["run", "strip", "--mesh", "0x1"]) == 2
    assert {path: path.read_bytes() for path in Path("out/strip").iterdir()} == before
    assert main(["run", "strip", *SMALL, "--to", "4"]) == 0
    assert summary(Path("out/strip"))["theta_deg"] == 4.0


def fail_at(number: int, monkeypatch: pytest.MonkeyPatch, error: BaseException) -> None:
    """Let an error come where the step of this number should."""

    def failing(*arguments: Any, **options: Any) -> Iterator[isopeel.Step]:
        yield from islice(isopeel.trace(*arguments, **options), number)
        raise error

    monkeypatch.setattr("isopeel.running.stage_steps.trace", failing)


@pytest.mark.parametrize("error", [KeyboardInterrupt(), ZeroDivisionError()])
def test_an_earlier_run_stays_until_the_first_step(
    error: BaseException, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert main(["run", "strip", *SMALL]) == 0
    before = {path: path.read_bytes() for path in Path("out/strip").iterdir()}
    fail_at(0, monkeypatch, error)
    if isinstance(error, KeyboardInterrupt):
        assert main(["run", "strip", *SMALL, "--to", "4"]) == 130
    else:
        with pytest.raises(ZeroDivisionError):
            main(["run", "strip", *SMALL, "--to", "4"])
    assert {path: path.read_bytes() for path in Path("out/strip").iterdir()} == before


def test_no_equilibrium_at_first_replaces_an_earlier_run(monkeypatch: pytest.MonkeyPatch) -> None:
    assert main(["run", "strip", *SMALL]) == 0
    fail_at(0, monkeypatch, ConvergenceError("because", (1.0,), np.radians(0.3)))
    assert main(["run", "strip", *SMALL]) == 3
    left = {"run.h5", "curve.csv", "summary.json", "run.earlier.h5"}  # the last one is the finished run
    assert {path.name for path in Path("out/strip").iterdir()} == left
    assert summary(Path("out/strip"))["failure"]["theta_deg"] == 0.3  # as requested, to the last bit
    assert len(table(Path("out/strip/curve.csv"))[1]) == 0


def test_after_an_unexpected_error_the_converged_steps_are_stored(monkeypatch: pytest.MonkeyPatch) -> None:
    assert main(["run", "strip", *SMALL]) == 0
    fail_at(2, monkeypatch, ZeroDivisionError())
    with pytest.raises(ZeroDivisionError):
        main(["run", "strip", *SMALL])
    left = {"run.h5", "curve.csv", "run.earlier.h5"}  # the last one is the finished run
    assert {path.name for path in Path("out/strip").iterdir()} == left
    _, rows = table(Path("out/strip/curve.csv"))
    assert (
        rows[:, 0].tolist() == isopeel.read_run(Path("out/strip/run.h5")).curve.parameter.tolist() == [0, 1]
    )


def test_a_folder_in_place_of_a_file_is_refused_beforehand(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "strip", *SMALL]) == 0
    Path("out/strip/summary.json").unlink()
    Path("out/strip/summary.json").mkdir()
    before = Path("out/strip/run.h5").read_bytes()
    capsys.readouterr()
    assert main(["run", "strip", *SMALL]) == 2
    assert "summary.json" in the_error(capsys)
    assert Path("out/strip/run.h5").read_bytes() == before
    assert Path("out/strip/curve.csv").exists()


@pytest.mark.parametrize("folder", ["a[b]", "a[/b]", ":x:"])
def test_paths_are_no_markup(folder: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "strip", *SMALL, "--to", "1", "--out", folder]) == 0
    assert folder in capsys.readouterr().out
    assert main(["spaces", "L2", "--out", f"{folder}/L2.png"]) == 0
    assert folder in capsys.readouterr().out.replace("/L2.png", "")


@pytest.mark.parametrize("folder", ["ü", "\udcff"])
def test_paths_may_be_no_text_of_the_terminal(folder: str) -> None:
    command = [sys.executable, "-c", "import sys; from isopeel.cli import main; sys.exit(main())"]
    message = subprocess.run(
        [*command, "run", "strip", *SMALL, "--to", "1", "--out", folder],
        env=os.environ | {"PYTHONIOENCODING": "ascii"},
        capture_output=True,
        check=True,
    )
    assert message.stderr == b""
    # what is no text at all is shown by its escape
    assert re.search(rb"files in ([?]|.udcff)", message.stdout)
    assert {path.name for path in Path(folder).iterdir()} == FILES


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--only", "table9"], ["--only", "'table9'", "table2, table3, literature"]),
        (["--mesh", "m4"], ["--mesh", "'m4'", "m1, m2, m3"]),
        (["--out", "file"], ["--out", "'file'", "folder"]),
        (["--out", "file/x"], ["--out", "'file/x'", "folder"]),
    ],
)
def test_the_paper_refuses_what_makes_no_sense(
    arguments: list[str], message: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    Path("file").write_text("no folder")
    assert main(["paper", *arguments]) == 2
    error = the_error(capsys)
    for words in message:
        assert words in error


def test_the_paper_without_runs_is_quick(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["paper", "--only", "spaces"]) == 0
    assert capsys.readouterr().out == "the report is out/paper/spaces/report.html\n"
    assert {path.name for path in Path("out/paper/spaces/figures").iterdir()} == {
        f"{name}.{suffix}" for name in ("bases", "refinement") for suffix in ("png", "pdf")
    }


PAPER = [
    sys.executable,
    "-c",
    "import sys; from isopeel.cli import main; sys.exit(main())",
    *("paper", "--only", "table2", "--mesh", "m1"),
]


@pytest.fixture
def paper() -> Iterator[subprocess.Popen[bytes]]:
    """A study under way, with all its workers, and alone in its group of processes."""
    process = subprocess.Popen(
        PAPER, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, start_new_session=True
    )
    try:
        # workers, and a keeper of resources
        while len(Process(process.pid).children()) <= cores():
            assert process.poll() is None
            sleep(0.05)
        yield process
    finally:
        process.kill()
        if process.stderr is not None:
            process.stderr.close()
        process.wait()


# its pending runs are minutes; a loaded machine may take a while to end processes
PATIENCE = 30


@pytest.mark.posix
@pytest.mark.parametrize("wait", [0.0, 2.0])  # while workers start, and later
def test_ctrl_c_ends_the_paper_at_once(paper: subprocess.Popen[bytes], wait: float) -> None:
    sleep(wait)
    os.killpg(paper.pid, signal.SIGINT)
    _, error = paper.communicate(timeout=PATIENCE)
    assert paper.returncode == 130
    assert (
        error
        == b"isopeel: interrupted; finished runs are in out/paper; the same command continues the study\n"
    )


def test_a_killed_worker_ends_the_paper_with_one_line(paper: subprocess.Popen[bytes]) -> None:
    workers = [p for p in Process(paper.pid).children() if "spawn_main" in " ".join(p.cmdline())]
    workers[0].kill()
    _, error = paper.communicate(timeout=PATIENCE)
    assert paper.returncode == 2
    assert error.startswith(b"isopeel: a process was ended from outside")
    assert error.count(b"\n") == 1


def test_a_killed_paper_leaves_no_process_behind(paper: subprocess.Popen[bytes]) -> None:
    sleep(2.0)  # until the workers know their parent
    children = Process(paper.pid).children()
    paper.kill()
    _, alive = wait_procs(children, timeout=PATIENCE)
    assert alive == []


def test_two_papers_in_one_folder_are_refused(
    paper: subprocess.Popen[bytes], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["paper", "--only", "table2", "--mesh", "m1"]) == 2
    assert "another process" in the_error(capsys)


def test_a_full_disk_ends_with_2(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    def fill_up(*_: object) -> int:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", fill_up)
    assert main(["run", "strip", *SMALL]) == 2
    assert "No space left on device" in the_error(capsys)


def test_spaces_draws_and_prints(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["spaces", "L1+N2.1@2", "--mesh", "20x4", "--out", "figures/space.png"]) == 0
    assert Path("figures/space.png").read_bytes().startswith(b"\x89PNG")
    lines = [" ".join(line.split()) for line in capsys.readouterr().out.splitlines()]
    # 2 rows of (n - 1)(p - c) + p + 1 = 19 x 2 + 4 cubics on 2 elements each, 3 rows of 20 + 1 hats
    assert "contact 2 3 C1 2 elements 84 168" in lines
    assert "bulk 3 1 C0 2 elements 63 126" in lines
    assert "a displacement field has 294 DOFs on 20x4 elements" in lines
    assert main(["spaces", "H3"]) == 0
    assert Path("out/N2.1.png").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["L0"], ["NAME", "'L0'"]),
        (["L2", "--mesh", "0x1"], ["--mesh", "'0x1'"]),
        (["L2", "--mesh", "3"], ["--mesh", "'3'"]),
        (["L2", "--out", "a.xyz"], ["--out", "'a.xyz'", ".png"]),
        (["L2", "--out", "file/a.png"], ["file", "written"]),
    ],
)
def test_spaces_refuses_what_makes_no_sense(
    arguments: list[str], message: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    Path("file").touch()
    assert main(["spaces", *arguments]) == 2
    error = the_error(capsys)
    for words in message:
        assert words in error


@pytest.mark.parametrize("name", LAWS)
def test_law_draws_and_prints(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["law", name, "--out", "law.svg"]) == 0
    message = capsys.readouterr().out
    # all have the strip's strength and work
    assert "123.57 MPa" in message
    assert "0.030665 J/m^2" in message
    assert Path("law.svg").stat().st_size > 1000


def test_law_shows_that_of_a_case() -> None:
    assert main(["law", "strip"]) == 0
    assert Path("out/strip.png").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["exponentil"], ["NAME", "'exponentil'", "van-der-waals", "strip"]),
        (["dugdale", "--out", "law.gif"], ["--out", "'law.gif'", ".png"]),
        ([], ["NAME"]),
    ],
)
def test_law_refuses_what_makes_no_sense(
    arguments: list[str], message: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["law", *arguments]) == 2
    error = the_error(capsys)
    for words in message:
        assert words in error


def test_version_help_and_unknown_commands(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"isopeel {isopeel.__version__}\n"
    assert main([]) == 0
    assert "spaces" in capsys.readouterr().out
    assert main(["peel"]) == 2
    assert "'peel'" in the_error(capsys)


def test_help_does_not_wait_for_a_compiler() -> None:
    script = (
        "import sys; from isopeel.cli import main; main(['run', '--help']); print('numba' in sys.modules)"
    )
    message = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    ).stdout
    assert "--traction" in message
    assert message.splitlines()[-1] == "False"


def test_the_package_gives_all_its_names() -> None:
    for name in isopeel.__all__:
        assert getattr(isopeel, name).__name__ == name
    assert set(isopeel.__all__) <= set(dir(isopeel))
    with pytest.raises(AttributeError, match="no attribute 'peel'"):
        _ = isopeel.peel  # type: ignore[attr-defined]
