"""Cases that `isopeel new` writes: their mesh, what they are compared with, and what is refused."""

import json
import shlex
from collections.abc import Callable
from pathlib import Path

import pytest
from rich.console import Console

from isopeel.case import load_case
from isopeel.cli import main
from isopeel.common.errors import InputError
from isopeel.output.asked import write_new_case
from isopeel.output.new_case import TESTS
from isopeel.post.resolution import estimated

pytestmark = pytest.mark.usefixtures("in_own_folder", "without_figures")

PET = "--thickness 25um --modulus 4GPa --force 25N/m"
COMMANDS = {
    "PET tape, 90 degrees": f"tape {PET} --force-angle 90deg --angle 90deg",
    "PET tape, 180 degrees": f"tape {PET} --force-angle 180deg --angle 180deg",
    "T-peel": "t-peel --thickness 0.1mm --modulus 1GPa --poissons-ratio 0.3 --work 200J/m^2",
    "double cantilever": "double-cantilever --thickness 2mm --modulus 70GPa --work 500J/m^2 --crack 20mm",
    "film": "film --thickness 25um --modulus 4GPa --work 0.05J/m^2",
}
#: Steady reactions in SI units, by hand: F (1 - cos angle) of the data sheet, W/2, sqrt(2 E' I W).
BY_HAND = {"PET tape, 90 degrees": 25.0, "PET tape, 180 degrees": 25.0, "film": 7.802e-4}


def written(command: str) -> Path:
    assert main(["new", *shlex.split(command), "--out", "case.toml"]) == 0
    return Path("case.toml")


@pytest.mark.parametrize("name", COMMANDS)
def test_the_mesh_has_three_elements_in_the_estimated_process_zone(name: str) -> None:
    case = load_case(written(COMMANDS[name]))
    found = estimated(case.problem(), case.spaces(), case.problem().interface_names[0])
    assert found is not None
    # a whole number of elements along, of at least 50, makes each a little shorter; the strength has 3 digits
    assert 2.9 < found.elements < 3.15
    assert found.is_enough


@pytest.mark.parametrize("strength", ["0.5 MPa", "4 MPa"])
def test_a_given_strength_determines_the_mesh(strength: str) -> None:
    case = load_case(written(f"{COMMANDS['PET tape, 90 degrees']} --strength '{strength}'"))
    found = estimated(case.problem(), case.spaces())
    assert found is not None
    assert 2.9 < found.elements < 3.15
    assert "chosen" not in Path("case.toml").read_text()


def run(name: str) -> list[dict[str, object]]:
    written(COMMANDS[name])
    assert main(["run", "case.toml", "--out", "out", "-q"]) == 0
    found = json.loads(Path("out/summary.json").read_text())
    readings: list[dict[str, object]] = found["readings"]
    return readings


def check(name: str) -> None:
    """Run a case, and compare each reading that has a closed form, and the reaction by hand."""
    readings = run(name)
    compared = {str(one["quantity"]): one["deviation_percent"] for one in readings if one["closed_form"]}
    steady = [one for one in compared if one.startswith(("steady", "force on each arm"))]
    assert len(steady) == 1
    # the onset is that of a joint that does not give way before it; this joint does, by its decay length
    compared.pop("onset", None)
    for deviation in compared.values():
        assert isinstance(deviation, float)
        assert abs(deviation) < 1  # percent, what the issue of this command asks for
    if name in BY_HAND:
        (value,) = [one["value"] for one in readings if one["quantity"] == steady[0]]
        assert value == pytest.approx(BY_HAND[name], rel=0.01)


def test_a_tape_at_90_degrees_peels_at_the_force_of_its_data_sheet() -> None:
    check("PET tape, 90 degrees")


@pytest.mark.long
@pytest.mark.parametrize("name", [name for name in COMMANDS if name != "PET tape, 90 degrees"])
def test_each_case_is_within_one_percent_of_its_closed_form(name: str) -> None:
    check(name)


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("tape", "--thickness: the option is missing; a length is needed"),
        ("tape --thickness 25um", "--modulus: the option is missing; a stress is needed"),
        (f"tape {PET} --thickness 25", "--thickness: '25' cannot be used"),
        (f"tape {PET} --angle 200deg", "--angle: '200deg' cannot be used; it must be at most 180 degrees"),
        (f"tape {PET} --poissons-ratio 0.5", "--poissons-ratio: '0.5' cannot be used; it must lie below 0.5"),
        (f"tape {PET} --poissons-ratio x", "--poissons-ratio: 'x' cannot be used; a number is needed"),
        (f"tape {PET} --crack 1mm", "--crack: '1mm' cannot be used; tape has no such option"),
        (f"tape {PET} --strength 1GPa", "--strength: '1e+09 Pa' cannot be used; the process zone of"),
        (f"tape {PET} --strength -1MPa", "--strength: '-1MPa' cannot be used; it must be positive"),
        ("film --thickness 1mm --modulus 1MPa --work 1kJ/m^2", "--thickness: '1mm' cannot be used; the film"),
        ("sphere", "TEST: 'sphere' cannot be used; one of these tests is needed: tape, t-peel"),
        ("", "TEST: one of these tests is needed"),
    ],
)
def test_without_a_terminal_it_names_what_is_missing_or_wrong(
    command: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["new", *shlex.split(command)]) == 2
    error = capsys.readouterr().err
    assert error.startswith(f"isopeel: {message}")
    assert error.count("\n") == 1
    assert list(Path().iterdir()) == []


def test_no_file_is_replaced(capsys: pytest.CaptureFixture[str]) -> None:
    Path("tape.toml").write_text("mine")
    assert main(["new", *shlex.split(COMMANDS["PET tape, 90 degrees"])]) == 2
    assert "'tape.toml' cannot be used; it exists" in capsys.readouterr().err
    assert Path("tape.toml").read_text() == "mine"


def answering(answers: list[str]) -> Callable[[str, str | None], str]:
    """What a user types: an empty answer takes the default."""

    def ask(text: str, usual: str | None) -> str:
        return answers.pop(0) or str(usual)

    return ask


def test_a_terminal_asks_until_an_answer_can_be_used() -> None:
    console = Console(quiet=True)
    answers = ["tape", "25", "25 um", "4 GPa", "", "25 N/m", "90 deg", ""]
    write_new_case(None, {}, None, console, answering(answers))
    assert answers == []
    asked = Path("tape.toml").read_text()
    options = "--thickness '25 um' --modulus '4 GPa' --force '25 N/m' --force-angle '90 deg'"
    assert main(["new", "tape", *shlex.split(options), "--out", "by-options.toml"]) == 0
    assert Path("by-options.toml").read_text() == asked


def test_an_option_is_not_asked_for() -> None:
    given = {"thickness": "25 um", "modulus": "4 GPa", "work": "0.05 J/m^2", "width": "25 mm"}
    write_new_case("film", given, Path("f.toml"), Console(quiet=True), answering(["0.3"]))
    case = load_case("f.toml")
    assert case.width == pytest.approx(25e-3 / 25e-6)
    assert "poissons_ratio = 0.3" in case.text


def test_an_unknown_test_is_refused_on_a_terminal_too() -> None:
    with pytest.raises(InputError, match="one of these tests is needed"):
        write_new_case(None, {}, None, Console(quiet=True), answering(["cone"]))


def test_the_command_offers_all_tests() -> None:
    assert list(TESTS) == ["tape", "t-peel", "double-cantilever", "film"]
