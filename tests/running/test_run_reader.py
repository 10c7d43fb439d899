"""The folder of a run is read back with its problem, or refused with one line."""

from dataclasses import replace
from pathlib import Path
from shutil import copytree

import h5py
import pytest
from rich.console import Console

import isopeel
from isopeel import InputError
from isopeel.case import with_options
from isopeel.results.run_file import read_run, write_run
from isopeel.running.folder import stage_files
from isopeel.running.run import run_case
from isopeel.running.run_reader import read_stages


@pytest.fixture(scope="module")
def staged(without_figures: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a case of two stages, of a few steps each."""
    folder = tmp_path_factory.mktemp("staged")
    case = with_options(isopeel.load_case("press-and-peel"), mesh="20x1", space="L1", to="1", step="0.5")
    run_case(case, folder, Console(quiet=True))
    return folder


def test_stages_come_in_their_order(staged: Path) -> None:
    press, peel = read_stages(staged)
    assert (press.title, peel.title) == ("press-and-peel, stage 1: press", "press-and-peel, stage 2: peel")
    assert peel.run.curve.parameter.tolist() == [0.0, 0.5, 1.0]
    assert press.stage.problem.driven_side == "top"
    assert {state.displacement.shape for state in peel.run.states} == {(peel.spaces["body"].size, 2)}


def test_the_folder_of_a_stage_holds_that_stage(staged: Path) -> None:
    (peel,) = read_stages(staged / "2-peel")
    assert (peel.title, peel.stage.name) == ("press-and-peel, stage 2: peel", "peel")


def test_what_is_no_folder_of_a_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="it is not a folder"):
        read_stages(tmp_path / "nowhere")
    with pytest.raises(InputError, match=r"there is no run\.h5 in it"):
        read_stages(tmp_path)
    (tmp_path / "run.h5").write_bytes(b"no HDF5")
    with pytest.raises(InputError, match="the file of a run is needed"):
        read_stages(tmp_path)


def test_a_file_that_does_not_fit_to_its_case_is_refused(staged: Path, tmp_path: Path) -> None:
    run = read_run(staged / "2-peel" / "run.h5")
    attributes = dict(run.attributes)
    del attributes["dofs"]
    other_states = (run.states[0]._replace(displacement=run.states[0].displacement[1:]),)
    for changed, message in (
        (replace(run, attributes=attributes), "it lacks dofs"),
        (replace(run, attributes={**run.attributes, "stage": "other"}), "of another case"),
        (replace(run, attributes={**run.attributes, "stage": "press"}), "belongs to another drive"),
        (replace(run, states=other_states, last=None, base=None), "of another case"),
        (replace(run, case_text="no TOML"), "the case in it cannot be read any more"),
    ):
        write_run(tmp_path / "run.h5", changed)
        with pytest.raises(InputError, match=message):
            read_stages(tmp_path)


@pytest.mark.parametrize(
    ("name", "value"), [("mesh", ""), ("mesh", "9x9"), ("mesh", "a\x1b[2Jb"), ("space", "N2"), ("space", "")]
)
def test_a_space_of_another_case_is_refused(name: str, value: str, staged: Path, tmp_path: Path) -> None:
    folder = tmp_path / "changed"
    copytree(staged, folder)
    with h5py.File(stage_files(folder)[0], "r+", libver="latest") as file:
        file.attrs[name] = value
    with pytest.raises(InputError, match="has fields, a space or a stage of another case"):
        read_stages(folder)
