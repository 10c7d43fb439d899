"""Values of options have a unit, and are read in those of the run's case; plain numbers are degrees only."""

from importlib.util import find_spec
from pathlib import Path

import pytest
from rich.console import Console

from isopeel.case import Case, with_options
from isopeel.cli import main
from isopeel.common.errors import InputError
from isopeel.output.selection import chosen_states, shown_stage

CASE = """
name = "micro"
units = { length = "1 um", stress = "1 MPa" }
[body]
length = "20 um"
height = "1 um"
[material]
law = "neo-hooke"
youngs_modulus = "10 MPa"
poissons_ratio = 0.3
[adhesion]
law = "exponential"
strength = "1 MPa"
work_of_adhesion = "0.3 J/m^2"
length = "15 um"
[discretization]
space = "L1"
mesh = "20x1"
across_degree = 1
[drive]
kind = "displacement"
side = "right"
angle = "90 deg"
to = "0.1 um"
step = "0.05 um"
[output]
fields_every = "0.05 um"
"""


@pytest.fixture(scope="module")
def folder(without_figures: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run that measures in micrometres."""
    home = tmp_path_factory.mktemp("micro")
    (home / "case.toml").write_text(CASE)
    assert main(["run", str(home / "case.toml"), "--out", str(home / "out")]) == 0
    return home / "out"


@pytest.mark.parametrize("written", ["0.05 um", "50 nm", "5e-8 m", "50e-6 mm"])
def test_a_state_is_chosen_in_any_unit(folder: Path, written: str) -> None:
    console = Console(record=True)
    (chosen,) = chosen_states(shown_stage(folder), [written], console)
    assert console.export_text() == ""
    assert chosen.parameter == pytest.approx(0.05, rel=1e-12)  # in micrometres


@pytest.mark.parametrize(
    ("written", "taken"),
    [("30 nm", "50 nm"), ("0.02 um", "0 um"), ("99 nm", "100 nm"), ("5.0001e-8 m", "50 nm")],
)
def test_another_state_than_the_requested_one_is_reported(
    folder: Path, written: str, taken: str, capsys: pytest.CaptureFixture[str]
) -> None:
    commands = [["plot", str(folder), "--only", "front", "--at", written]]
    if find_spec("pyvista"):
        commands.append(
            ["view", str(folder), "--at", written, "--screenshot", str(folder / "figures/shapes.png")]
        )
    for command in commands:
        capsys.readouterr()
        assert main(command) == 0
        message = (
            f"--at {written}: the nearest state that is stored is at {taken}; `isopeel run --fields-every`"
        )
        assert message in capsys.readouterr().out


@pytest.mark.parametrize(
    ("written", "why"),
    [
        ("50", "it has no unit; a length is needed, such as '200 nm'"),
        ("0.05", "it has no unit; a length is needed, such as '200 nm'"),
        ("50 mm", "the path goes from 0 um to 100 nm"),
        ("-1 nm", "the path goes from 0 um to 100 nm"),
        ("100.1 nm", "the path goes from 0 um to 100 nm"),
        ("120 nm", "the path goes from 0 um to 100 nm"),
        ("1 N/m", "a length is needed, such as '200 nm'"),
        ("30 deg", "a length is needed, such as '200 nm'"),
        ("nan", "it has no unit; a length is needed"),
    ],
)
def test_a_plain_number_is_no_length(
    folder: Path, written: str, why: str, capsys: pytest.CaptureFixture[str]
) -> None:
    capsys.readouterr()
    for command in (["plot", str(folder), "--only", "front"], ["view", str(folder)]):
        if command[0] == "view":
            pytest.importorskip("pyvista")
        assert main([*command, "--at", written]) == 2
        error = capsys.readouterr().err
        assert error.startswith(f"isopeel: --at: '{written}' cannot be used; ")
        assert why in error
        assert error.count("\n") == 1


@pytest.mark.parametrize("option", ["to", "step", "fields_every"])
@pytest.mark.parametrize("written", ["0.1", "5", "1e-3", "inf"])
def test_options_of_a_run_take_no_plain_length(option: str, written: str) -> None:
    with pytest.raises(InputError, match="a length is needed, such as '200 nm'") as caught:
        with_options(Case.parse(CASE), **{option: written})  # type: ignore[arg-type]
    assert caught.value.field == f"--{option.replace('_', '-')}"


def test_options_of_a_run_are_read_in_the_units_of_the_case() -> None:
    (stage,) = with_options(Case.parse(CASE), to="200 nm", step="1e-7 m", fields_every="0.1 um").stages()
    assert stage.parameters.tolist() == [0.0, 0.1, 0.2]
    assert stage.fields_every == 0.1


def test_resuming_further_takes_a_unit(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["resume", str(folder), "--to", "0.15"]) == 2
    assert (
        "isopeel: --to: '0.15' cannot be used; it has no unit; a length is needed" in capsys.readouterr().err
    )
