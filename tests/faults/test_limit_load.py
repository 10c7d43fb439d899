"""A dead load beyond the largest one that has an equilibrium is named as that, and located."""

import json
import re
from math import cos, radians, sqrt
from pathlib import Path

import pytest
from paths import as_far_as_it_goes, paths

from isopeel.cli import main
from isopeel.common.path_control import PathControl
from isopeel.common.units import UnitSystem
from isopeel.post.laboratory import Laboratory
from isopeel.solve.convergence import ConvergenceError

pytestmark = pytest.mark.usefixtures("without_figures")

TAPE = """
name = "weight"
[units]
length = "1 mm"
stress = "1 MPa"
[body]
length = "20 mm"
height = "0.1 mm"
[material]
law = "neo-hooke"
youngs_modulus = "300 MPa"
poissons_ratio = 0.3
[adhesion]
law = "exponential"
strength = "0.5 MPa"
work_of_adhesion = "0.1 N/mm"
length = "15 mm"
sliding_length = "0.1 mm"
[discretization]
space = "N2.1"
mesh = "80x2"
[drive]
kind = "force"
side = "right"
angle = "{angle} deg"
control = "force"
to = "{to} N/mm"
step = "{step} N/mm"
path_control = "{path_control}"
"""

BLOCK = """
name = "block"
[units]
length = "1 mm"
stress = "1 MPa"
[body]
length = "2 mm"
height = "4 mm"
[material]
law = "neo-hooke"
youngs_modulus = "1 MPa"
poissons_ratio = 0.0
[adhesion]
law = "exponential"
strength = "0.05 MPa"
work_of_adhesion = "0.01 N/mm"
[held]
left = "x"
[discretization]
space = "N2"
mesh = "2x4"
[drive]
kind = "force"
side = "top"
angle = "90 deg"
control = "force"
to = "1 N/mm"
step = "0.03 N/mm"
"""


def largest(error: ConvergenceError) -> float:
    """The load that the message names."""
    assert error.cause == "limit load"
    assert "smaller steps" not in error.hint
    words = error.reason.split()
    return float(words[words.index("beyond") + 1])


def kendall(angle: float) -> float:
    stiffness, a = 300 / (1 - 0.3**2) * 0.1, 1 - cos(radians(angle))
    return stiffness * (sqrt(a * a + 2 * 0.1 / stiffness) - a)


@pytest.mark.parametrize(
    ("angle", "to", "step"), [(90.0, 0.2, 0.02), (100.0, 0.3, 0.06), (120.0, 0.1, 0.005), (90.0, 5.0, 0.07)]
)
def test_a_weight_that_peels_a_tape_off(angle: float, to: float, step: float) -> None:
    """It used to end with a stalled residual, and advice to take smaller steps."""
    with pytest.raises(ConvergenceError) as caught:
        paths(TAPE.format(angle=angle, to=to, step=step, path_control="auto"))
    # the joint is ten process zones long, of which the front takes one: some tenths of a percent
    assert largest(caught.value) == pytest.approx(kendall(angle), rel=0.005)


@pytest.mark.parametrize("path_control", ["newton", "auto"])
def test_the_cause_does_not_depend_on_the_path_control(path_control: PathControl) -> None:
    with pytest.raises(ConvergenceError) as caught:
        paths(BLOCK.replace("[drive]", f'[drive]\npath_control = "{path_control}"'))
    # the whole block comes off at once, at its strength times its length
    assert largest(caught.value) == pytest.approx(0.05 * 2, rel=1e-4)


def test_continuation_ends_where_the_body_has_come_off() -> None:
    """Its load stayed zero to round-off, whose equal values ended the search for a crossing with an error."""
    steps, error = as_far_as_it_goes(BLOCK, "continuation")
    assert error is not None
    assert error.cause == "limit load"
    # the first requested load without an equilibrium
    assert error.parameter == pytest.approx(0.12)
    # the largest load is the strength times the length; the force of the joint decays exponentially
    assert max(step.parameter for step in steps) == pytest.approx(0.05 * 2, rel=1e-4)
    assert abs(steps[-1].parameter) < 1e-12


def test_below_the_largest_load_all_states_are_stable() -> None:
    (steps,) = paths(BLOCK.replace('to = "1 N/mm"', 'to = "0.0999 N/mm"'))
    assert steps[-1].parameter == pytest.approx(0.0999)
    assert {step.negative_eigenvalues for step in steps} <= {0, None}


def test_a_load_that_snaps_the_body_on_is_no_limit() -> None:
    """Pushed towards the substrate by a dead load it snaps on, where it comes to rest."""
    text = BLOCK.replace('angle = "90 deg"', 'angle = "270 deg"').replace(
        "[held]", '[substrate]\ngap = "0.1 mm"\n[held]'
    )
    (steps,) = paths(text.replace('to = "1 N/mm"', 'to = "0.06 N/mm"'))
    assert steps[-1].parameter == pytest.approx(0.06)


@pytest.mark.parametrize(("width", "shown"), [(None, (100.0, "N/m")), ("20 mm", (2.0, "N"))])
def test_the_largest_load_is_in_the_units_of_the_readings(
    width: str | None, shown: tuple[float, str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """In the terminal, in the summary and in the report."""
    text = BLOCK if width is None else BLOCK.replace("[material]", f'width = "{width}"\n[material]')
    (tmp_path / "case.toml").write_text(text, "utf-8")
    out = tmp_path / "out"
    assert main(["run", str(tmp_path / "case.toml"), "--out", str(out)]) == 3
    summary = json.loads((out / "summary.json").read_text("utf-8"))
    assert main(["report", str(out)]) == 0
    page = (out / "report.html").read_text("utf-8")
    page = page[: page.index("[material]")]
    for text in (capsys.readouterr().err, summary["failure"]["reason"], page):
        assert "E0 L0," not in text
        (value,) = re.findall(rf"beyond ([\d.]+) {shown[1]},", text)
        assert float(value) == pytest.approx(shown[0], rel=1e-4)


@pytest.mark.parametrize(
    ("internal", "shown"),
    [
        ("beyond 0.0998532 E0 L0, a limit", "beyond 0.199706 N/m, a limit"),
        ("turns back at 12.5 L0; x", "turns back at 12.5 nm; x"),
        ("turns back at -54.3 degree; x", "turns back at -54.3 deg; x"),
        ("grows by 1.2e-05 E0 L0^3 without", "grows by 2.4e-14 J/m without"),
        ("a stress of -3e-4 E0.", "a stress of -600 kPa."),
        ("3 L0s, and v1.2 L0", "3 L0s, and v1.2 L0"),
    ],
)
def test_sentences_are_in_laboratory_units(internal: str, shown: str) -> None:
    # 1 nm and 2 GPa
    assert Laboratory(UnitSystem(), 100.0).sentence(internal) == shown
