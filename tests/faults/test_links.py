"""A link, a pipe or a device in place of a file is refused, at once, and stays as it is."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

import isopeel
from isopeel.cli import main
from isopeel.results.files import new_file, part_of, replacing

pytestmark = [pytest.mark.posix, pytest.mark.usefixtures("without_figures")]

SMALL = ("--mesh", "10x1", "--space", "L1", "--to", "2", "--step", "1")


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("thesis.h5").write_text("three years")


@pytest.fixture(autouse=True)
def _thesis_stays() -> object:
    yield
    assert Path("thesis.h5").read_text() == "three years"


def link(path: Path) -> None:
    path.symlink_to(Path("thesis.h5").absolute())


def broken_link(path: Path) -> None:
    path.symlink_to("nowhere")


def pipe(path: Path) -> None:
    os.mkfifo(path)


def folder(path: Path) -> None:
    path.mkdir()


KINDS = [link, broken_link, pipe, folder]


def the_error(capsys: pytest.CaptureFixture[str]) -> str:
    error = capsys.readouterr().err
    assert error.startswith("isopeel: ")
    assert error.count("\n") == 1
    return error


@pytest.mark.parametrize("plant", KINDS)
@pytest.mark.parametrize("name", ["run.h5", "run.journal", "curve.csv", "summary.json", ".lock"])
def test_no_file_of_a_run_is_written_through(
    name: str, plant: Callable[[Path], None], capsys: pytest.CaptureFixture[str]
) -> None:
    Path("out").mkdir()
    plant(Path("out", name))
    for options in ((), ("--force",)):
        assert main(["run", "strip", *SMALL, "--out", "out", *options]) == 2
        assert name in the_error(capsys)
    assert os.path.lexists(Path("out", name))
    assert not Path("nowhere").exists()


@pytest.mark.parametrize("name", [".run.part.h5", ".curve.part.csv", ".summary.part.json", ".curve.part.png"])
def test_a_link_in_place_of_a_partial_file_is_removed(name: str) -> None:
    Path("out").mkdir()
    link(Path("out", name))
    assert main(["run", "strip", *SMALL, "--out", "out"]) == 0
    assert not os.path.lexists(Path("out", name))
    assert len(isopeel.read_run(Path("out/run.h5")).curve) == 3


@pytest.mark.parametrize("plant", [link, broken_link, pipe, folder])
def test_replacing_refuses_what_is_no_file(plant: Callable[[Path], None]) -> None:
    plant(Path("figure.png"))
    refused = pytest.raises(OSError, match=r"(link|pipe|folder).*and no file: 'figure.png'")
    with refused, replacing(Path("figure.png")):
        pass
    assert not part_of(Path("figure.png")).exists()


@pytest.mark.parametrize("plant", [link, broken_link, pipe, folder])
def test_a_new_file_is_made_nowhere_else(plant: Callable[[Path], None]) -> None:
    plant(Path("part"))
    with pytest.raises(FileExistsError):
        new_file(Path("part"))


@pytest.mark.parametrize("command", ["plot", "report", "export", "resume"])
def test_a_pipe_in_place_of_a_run_is_not_waited_for(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    Path("out").mkdir()
    pipe(Path("out/run.h5"))
    assert main([command, "out"]) == 2
    assert "it is a pipe, and no file" in the_error(capsys)


def test_a_device_is_no_run(capsys: pytest.CaptureFixture[str]) -> None:
    Path("out").mkdir()
    Path("out/run.h5").symlink_to("/dev/zero")
    assert main(["report", "out"]) == 2
    assert "it is a device, and no file" in the_error(capsys)


def test_a_pipe_in_place_of_a_journal_is_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    assert main(["run", "strip", *SMALL, "--out", "out"]) == 0
    pipe(Path("out/run.journal"))
    assert len(isopeel.read_run(Path("out/run.h5")).curve) == 3
    assert main(["resume", "out", "--to", "3"]) == 2
