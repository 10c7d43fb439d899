"""The output of a symmetric problem, of which one half is modelled, states whether a value is of the half."""

import re
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console
from summaries import result_of

from isopeel.output.law import show_law

DCB = """
name = "dcb"
[units]
length = "1 mm"
stress = "1 GPa"
[body]
length = "60 mm"
height = "1.5 mm"
[material]
law = "neo-hooke"
youngs_modulus = "135.3 GPa"
poissons_ratio = 0.0
[adhesion]
law = {law}
length = "40 mm"
symmetric = {symmetric}
irreversible = true
[held]
left = "xy"
[discretization]
space = "N2.1"
mesh = "120x2"
[drive]
kind = "force"
side = "right"
angle = "90 deg"
to = "1 mm"
step = "0.05 mm"
"""

EXPONENTIAL = '"exponential"\nstrength = "25 MPa"\nwork_of_adhesion = "0.28 N/mm"'
LAWS = [
    (EXPONENTIAL, 280),
    ('"bilinear"\nstrength = "60 MPa"\nrise = 0.02\nwork_of_adhesion = "352 J/m^2"', 352),
    ('"dugdale"\nstrength = "2 MPa"\nwork_of_adhesion = "1500 J/m^2"\ntransition = 0.1', 1500),
]


@pytest.mark.parametrize(("law", "work"), LAWS)
@pytest.mark.parametrize("symmetric", ["true", "false"])
def test_a_law_is_that_of_the_whole_joint(law: str, work: int, symmetric: str, tmp_path: Path) -> None:
    file = tmp_path / "case.toml"
    file.write_text(DCB.format(law=law, symmetric=symmetric))
    console = Console(width=200, file=(out := StringIO()))
    show_law(str(file), tmp_path / "law.png", console)
    (row,) = re.findall(r"^ *work of adhesion .*$", out.getvalue(), re.MULTILINE)
    assert re.search(rf" {work}(\.0*)? J/m|{work / 1000:g} kJ/m", row)
    assert ("of the whole joint" in out.getvalue()) == (symmetric == "true")


def test_the_summary_states_whether_its_values_are_of_a_half() -> None:
    message = result_of(DCB.format(law=EXPONENTIAL, symmetric="true"))
    assert message.found.halves is not None
    assert "forces are those on each arm" in message.found.halves
    assert "largest force on each arm" in message.quantities
    release = message.reading("energy release rate")
    # of the whole joint, that of both halves: 280 J/m^2
    assert release["closed_form"]["value"] == pytest.approx(280)
    assert abs(release["deviation_percent"]) < 5
    assert abs(message.reading("force on each arm at the end")["deviation_percent"]) < 2


BLOCK = """
name = "block"
[units]
length = "1 mm"
stress = "1 MPa"
[body]
length = "10 mm"
height = "5 mm"
[material]
law = "neo-hooke"
youngs_modulus = "1 MPa"
poissons_ratio = 0.3
[adhesion]
law = "exponential"
strength = "0.01 MPa"
work_of_adhesion = "0.002 N/mm"
{held}
[discretization]
space = "L1"
mesh = "10x5"
[[drive]]
kind = "displacement"
side = "top"
angle = "{angle} deg"
to = "{to} mm"
step = "0.05 mm"
"""


@pytest.mark.parametrize(("held", "side"), [("", "left"), ('[held]\nright = "x"', "right")])
def test_a_side_that_is_a_line_of_symmetry_is_reported(held: str, side: str) -> None:
    message = result_of(BLOCK.format(held=held, angle=90, to=0.5))
    assert message.found.halves is not None
    assert f"the {side} side is held as a line of symmetry" in message.found.halves


@pytest.mark.parametrize(("angle", "to"), [(90, 0.5), (270, -0.5), (-90, -0.5)])
def test_a_pull_off_is_a_tension_whatever_the_sign_of_the_drive(angle: int, to: float) -> None:
    message = result_of(BLOCK.format(held="", angle=angle, to=to))
    pulled = message.reading("pull-off force")
    # 10 mm at 0.01 MPa are 100 N/m at most: the side comes off nearly at once, within a step
    assert 96.0 < pulled["value"] < 100.0
    assert pulled["unit"] == "N/m"
    assert "away from the substrate" in pulled["words"]
