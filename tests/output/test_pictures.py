"""Pictures of stored runs, drawn by the command line: what is in them, their formats, and what is refused."""

import csv
import os
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from subprocess import PIPE, Popen
from time import sleep

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

from isopeel.cli import main
from isopeel.output.view import Viewer
from isopeel.results.run_file import read_run, write_run
from isopeel.running.run_reader import read_stages

COARSE = ("--mesh", "40x2", "--to", "20", "--step", "1")


@pytest.fixture(scope="module")
def runs(without_figures: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folders of a strip in two spaces, 20 steps each, and of a tape that is pressed and peeled."""
    folder = tmp_path_factory.mktemp("runs")
    for space in ("L1", "N2"):
        assert main(["run", "strip", *COARSE, "--space", space, "--out", str(folder / space)]) == 0
    staged = ("--mesh", "20x1", "--space", "L1", "--to", "1", "--step", "0.5")
    assert main(["run", "press-and-peel", *staged, "--out", str(folder / "staged")]) == 0
    return folder


def refused(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> str:
    """The one line that a command ends with."""
    capsys.readouterr()
    assert main([str(argument) for argument in arguments]) == 2
    error = capsys.readouterr().err
    assert error.startswith("isopeel: ")
    assert error.count("\n") == 1
    return error


def test_all_figures_are_drawn_beside_the_run(runs: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plot", str(runs / "L1")]) == 0
    drawn = {path.name for path in (runs / "L1" / "figures").iterdir()}
    assert drawn >= {"curve.png", "shapes.png", "front.png", "tractions.png"}
    # the plateau is read between 98 and 101.4 degrees
    assert "plateau.png" not in drawn
    assert "no plateau of strip: the window is 98 deg to 101.4 deg" in capsys.readouterr().out


@pytest.mark.parametrize(("suffix", "begin"), [("svg", b"<?xml"), ("pdf", b"%PDF"), ("png", b"\x89PNG")])
def test_a_part_is_drawn_in_a_format(runs: Path, tmp_path: Path, suffix: str, begin: bytes) -> None:
    arguments = ("--only", "curve", "--format", suffix, "--out", str(tmp_path / "new"))
    assert main(["plot", str(runs / "L1"), *arguments]) == 0
    (path,) = (tmp_path / "new").iterdir()
    assert path.name == f"curve.{suffix}"
    assert path.read_bytes().startswith(begin)


def test_chosen_states_are_shown(runs: Path, tmp_path: Path) -> None:
    # fields are kept at 0, 10 and 20 degrees: the nearest ones are taken
    at = ("--at", "1", "--at", "12 deg")
    parts = ("--only", "shapes", "--only", "front", "--only", "tractions")
    assert main(["plot", str(runs / "L1"), *at, *parts, "--format", "svg", "--out", str(tmp_path)]) == 0
    shapes, front, tractions = (
        (tmp_path / f"{part}.svg").read_text() for part in ("shapes", "front", "tractions")
    )
    for drawing in (shapes, tractions):
        assert ">0°<" in drawing
        assert ">10°<" in drawing
        assert ">20°<" not in drawing
    assert "front at 10°" in front


def test_stages_have_figures_each(runs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["plot", str(runs / "staged"), "--only", "curve", "--out", str(tmp_path)]) == 0
    assert sorted(str(path.relative_to(tmp_path)) for path in tmp_path.glob("*/*")) == [
        "1-press/curve.png",
        "2-peel/curve.png",
    ]
    assert main(["plot", str(runs / "staged" / "1-press"), "--only", "tractions", "--at", "2 N/m"]) == 0
    assert (runs / "staged" / "1-press" / "figures" / "tractions.png").is_file()
    assert "give the folder of one stage" in refused(capsys, "plot", runs / "staged", "--at", "1")
    assert "give the folder of one" in refused(capsys, "compare", runs / "staged", runs / "L1")
    assert "give the folder of one" in refused(capsys, "view", runs / "staged")


def test_runs_are_compared(runs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ("--out", str(tmp_path), "--format", "svg")
    assert main(["compare", str(runs / "L1"), str(runs / "N2"), *arguments]) == 0
    shown = capsys.readouterr().out
    assert "forces, moments and energies per width" in shown
    with (tmp_path / "compare.csv").open(newline="") as file:
        one, other = csv.DictReader(file)
    assert (one["run"], one["space"], one["dofs"]) == ("L1", "L1", "246")
    assert (other["run"], other["space"], other["dofs"]) == ("N2", "N2", "252")
    assert (one["plateau [N m/m]"], one["amplitude [N m/m]"]) == ("", "")
    first, second = (read_run(runs / name / "run.h5").curve for name in ("L1", "N2"))
    # E0 L0^2 = 2 GPa nm^2, in N m/m
    difference = (second.reaction - first.reaction) * 2e-9
    with (tmp_path / "differences.csv").open(newline="") as file:
        heading, *rows = csv.reader(file)
    assert heading == ["theta [deg]", "N2 [N m/m]"]
    # by the round-off of moments, of which differences are small ones
    expected = np.stack([first.parameter, difference], 1)
    np.testing.assert_allclose(np.array(rows, dtype=np.float64), expected, rtol=1e-9, atol=1e-24)
    largest = float(other["largest_difference [N m/m]"])
    assert largest == pytest.approx(difference[np.abs(difference).argmax()], rel=1e-9)
    assert "less that of L1" in (tmp_path / "compare.svg").read_text()


def test_runs_that_cannot_be_compared(runs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    one, press = runs / "L1", runs / "staged" / "1-press"
    assert "two or more folders of runs" in refused(capsys, "compare", one)
    assert "only once" in refused(capsys, "compare", one, one)
    assert "that of the first run is moment (N m/m)" in refused(capsys, "compare", one, press)
    assert "--format: 'doc' cannot be used" in refused(capsys, "compare", one, runs / "N2", "--format", "doc")
    (tmp_path / "file").touch()
    error = refused(capsys, "compare", one, runs / "N2", "--out", tmp_path / "file")
    assert "a folder that can be written is needed" in error


def test_a_gif_has_a_picture_for_each_state(runs: Path, tmp_path: Path) -> None:
    arguments = ("--format", "gif", "--fps", "5", "--size", "400x200", "--out", str(tmp_path))
    assert main(["animate", str(runs / "L1"), *arguments]) == 0
    with Image.open(tmp_path / "animation.gif") as image:
        assert image.n_frames == 3  # type: ignore[attr-defined]
        assert image.size == (400, 200)
        assert image.info["duration"] == 200  # ms
        last = np.asarray(image.convert("RGB"))
    assert (last[0, -1] == 255).all()  # white stays white


def test_an_mp4_has_a_picture_for_each_state(runs: Path) -> None:
    assert main(["animate", str(runs / "L1"), "--fps", "2", "--size", "640x302"]) == 0
    path = runs / "L1" / "figures" / "animation.mp4"
    assert imageio_ffmpeg.count_frames_and_secs(path) == (3, 1.5)
    decode = [imageio_ffmpeg.get_ffmpeg_exe(), "-v", "error", "-i", str(path)]
    raw = subprocess.run(
        [*decode, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"], stdout=PIPE, check=True
    ).stdout
    first, _, last = np.frombuffer(raw, np.uint8).reshape(3, 302, 640, 3).astype(int)
    # the body and the mark have moved
    assert (np.abs(first - last).max(axis=2) > 100).sum() > 300


def test_more_states_are_stored_for_an_animation(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = ("run", "strip", "--mesh", "20x2", "--space", "L1", "--to", "2", "--step", "0.5")
    assert main([*run, "--fields-every", "0.5", "--out", str(tmp_path)]) == 0
    assert [state.parameter for state in read_run(tmp_path / "run.h5").states] == [0.0, 0.5, 1.0, 1.5, 2.0]
    assert main(["animate", str(tmp_path), "--format", "gif", "--size", "400x200"]) == 0
    with Image.open(tmp_path / "figures" / "animation.gif") as image:
        assert image.n_frames == 5  # type: ignore[attr-defined]
    for value in ("0", "2 nm"):
        assert f"--fields-every: '{value}' cannot be used" in refused(capsys, *run, "--fields-every", value)


def test_animations_that_cannot_be_made(
    runs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for option, value in (("--format", "avi"), ("--fps", "0"), ("--size", "641x302"), ("--size", "9x9")):
        assert f"{option}: " in refused(capsys, "animate", runs / "L1", option, value)
    stored = read_run(runs / "L1" / "run.h5")
    one_state = replace(stored, states=stored.states[:1])
    write_run(tmp_path / "run.h5", one_state)
    assert "two or more stored states" in refused(capsys, "animate", tmp_path)


@pytest.mark.parametrize("suffix", ["mp4", "gif"])
def test_ctrl_c_leaves_no_half_animation(runs: Path, tmp_path: Path, suffix: str) -> None:
    program = (
        "import sys; import isopeel.output.animate as a; from isopeel.cli import main\n"
        "picture = a.MovingFigure.picture\n"
        "def slow(self, number):\n"
        "    if number == 1: print('begun', flush=True); import time; time.sleep(60)\n"
        "    return picture(self, number)\n"
        "a.MovingFigure.picture = slow\n"
        "sys.exit(main())"  # a process of its own, which ends in time whatever it waits for
    )
    arguments = (str(runs / "N2"), "--format", suffix, "--out", str(tmp_path))
    command = [sys.executable, "-c", program, "animate", *arguments]
    with Popen(command, stdout=PIPE, stderr=PIPE, text=True, start_new_session=True) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        assert process.stdout.readline() == "begun\n"
        sleep(0.1)  # so that it sleeps
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does, which reaches ffmpeg, too
        assert process.wait(30) == 130
        assert process.stderr.read() == "isopeel: interrupted\n"
    assert list(tmp_path.iterdir()) == []


def test_a_state_is_viewed(runs: Path, tmp_path: Path) -> None:
    path = tmp_path / "state.png"
    assert main(["view", str(runs / "L1"), "--at", "10", "--screenshot", str(path)]) == 0
    with Image.open(path) as image:
        assert image.size == (1280, 720)
        pixels = np.asarray(image.convert("RGB"), dtype=int)
    # the middle of viridis, where there is no stress, on a white ground
    assert (np.abs(pixels - (33, 145, 140)).max(axis=2) < 12).sum() > 10_000
    assert (pixels[350, 5] == 255).all()


def test_the_slider_shows_the_states(runs: Path) -> None:
    import pyvista

    (stage,) = read_stages(runs / "L1")
    with pyvista.vtk_verbosity("off"):
        viewer = Viewer(pyvista, stage, off_screen=True)
        viewer.add_slider(2)
        assert viewer.shown == 2
        viewer.slider.GetRepresentation().SetValue(0.8)
        viewer.slider.InvokeEvent("InteractionEvent")
        viewer.slider.InvokeEvent("EndInteractionEvent")
        assert viewer.shown == 1
        for by, shown in ((1, 2), (1, 2), (-1, 1)):
            viewer.move(by)
            assert viewer.shown == viewer.slider.GetRepresentation().GetValue() == shown
        viewer.plotter.close()


def test_what_cannot_be_viewed(
    runs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    one = runs / "L1"
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    assert "there is no display for a window" in refused(capsys, "view", one)
    assert "must end in .png" in refused(capsys, "view", one, "--screenshot", tmp_path / "a.jpg")
    assert "the path goes from 0 deg to 20 deg" in refused(capsys, "view", one, "--at", "26")
    monkeypatch.setitem(sys.modules, "pyvista", None)
    error = refused(capsys, "view", one, "--screenshot", tmp_path / "a.png")
    assert "pip install 'isopeel[view]'" in error


@pytest.mark.parametrize("command", ["plot", "animate", "view"])
def test_what_is_no_run_is_refused(
    command: str, runs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "it is not a folder" in refused(capsys, command, tmp_path / "nowhere")
    assert "there is no run.h5 in it" in refused(capsys, command, tmp_path)
    stored = read_run(runs / "L1" / "run.h5")
    last = stored.states[-1]
    no_numbers = last._replace(displacement=last.displacement * np.nan)
    for changed, message in (
        (replace(stored, states=(*stored.states[:-1], no_numbers)), "not finite"),
        (replace(stored, states=()), "its run has no converged step"),
    ):
        write_run(tmp_path / "run.h5", changed)
        assert message in refused(capsys, command, tmp_path)
    (tmp_path / "run.h5").write_bytes(b"broken")
    assert "the file of a run is needed" in refused(capsys, command, tmp_path)


def test_figures_that_make_no_sense(runs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    one = runs / "L1"
    assert "curve, plateau, shapes, front, tractions" in refused(capsys, "plot", one, "--only", "shape")
    assert "--only: 'plateau' cannot be used; the window" in refused(capsys, "plot", one, "--only", "plateau")
    assert "png, pdf, svg" in refused(capsys, "plot", one, "--format", "doc")
    assert "--at: '40' cannot be used; the path goes from 0 deg to 20 deg" in refused(
        capsys, "plot", one, "--at", "40"
    )
    assert "--at: '5 nm' cannot be used" in refused(capsys, "plot", one, "--at", "5 nm")
    (tmp_path / "file").touch()
    error = refused(capsys, "plot", one, "--out", tmp_path / "file")
    assert "--out" in error
    assert "a folder that can be written is needed" in error


def test_a_run_of_one_step_has_figures(runs: Path, tmp_path: Path) -> None:
    stored = read_run(runs / "L1" / "run.h5")
    curve = stored.curve
    first = replace(
        curve,
        energy_residuals=curve.residuals_of(0),
        **{
            name: getattr(curve, name)[:1]
            for name in (
                *("parameter", "reaction", "iterations", "stored_energy", "adhesive_energy"),
                *("dissipated_energy", "released_energy", "seconds", "kind", "negative_eigenvalues"),
            )
        },
    )
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        write_run(tmp_path / name / "run.h5", replace(stored, curve=first, states=stored.states[:1]))
    assert main(["plot", str(tmp_path / "one")]) == 0
    drawn = {path.name for path in (tmp_path / "one" / "figures").iterdir()}
    assert drawn == {"curve.png", "shapes.png", "front.png", "tractions.png"}
    out = tmp_path / "out"
    assert main(["compare", str(tmp_path / "one"), str(tmp_path / "two"), "--out", str(out)]) == 0
    assert (out / "compare.png").is_file()


def test_a_new_run_removes_the_figures_of_the_old_one(tmp_path: Path) -> None:
    run = [
        "run",
        "strip",
        "--mesh",
        "20x2",
        "--space",
        "L1",
        "--to",
        "2",
        "--step",
        "1",
        "--out",
        str(tmp_path),
    ]
    assert main(run) == 0
    assert main(["plot", str(tmp_path), "--only", "curve", "--format", "pdf"]) == 0
    mine = tmp_path / "figures" / "mine.pdf"
    mine.touch()
    assert main(run) == 2  # as it holds a file that is not part of a run
    assert main([*run, "--force"]) == 0
    assert list((tmp_path / "figures").iterdir()) == [mine]
