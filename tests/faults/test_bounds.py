"""Too much work for a run, and stages that cannot begin, are reported before the first step."""

from pathlib import Path
from time import perf_counter

import pytest

from isopeel.case import Case, load_case, with_options
from isopeel.case.stages import MOST_STAGES, MOST_STEPS_IN_ALL
from isopeel.cli import main
from isopeel.common.errors import InputError

BODY = """
name = "many"
[body]
length = "200 nm"
height = "10 nm"
[material]
law = "neo-hooke"
youngs_modulus = "2 GPa"
poissons_ratio = 0.2
[adhesion]
law = "van-der-waals"
hamaker_constant = "1e-19 J"
equilibrium_distance = "0.4 nm"
[discretization]
mesh = "4x1"
"""
FINE = '[[drive]]\nto = "100 deg"\nstep = "1e-3 deg"\n'
COARSE = '[[drive]]\nto = "2 deg"\nstep = "1 deg"\n'
UP = '[[drive]]\nkind = "displacement"\nside = "right"\nangle = "90 deg"\nto = "1 nm"\nstep = "0.5 nm"\n'


def refused(text: str, folder: Path, capsys: pytest.CaptureFixture[str], *options: str) -> str:
    """The one line that a case is refused with, which leaves no folder."""
    file = folder / "case.toml"
    file.write_text(text)
    assert main(["run", str(file), "--out", str(folder / "out"), *options]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert not (folder / "out").exists()
    return error


@pytest.mark.parametrize(
    ("stages", "message"),
    [
        (400 * FINE, "drive: '400 stages' cannot be used; a case has at most 100 stages"),  # as given
        ((MOST_STAGES + 1) * COARSE, f"drive: '{MOST_STAGES + 1} stages' cannot be used; a case has at most"),
        (3 * FINE, f"'3 stages of 300000 steps in all' cannot be used; at most {MOST_STEPS_IN_ALL} steps"),
        (2 * FINE + COARSE, "'3 stages of 200002 steps in all' cannot be used"),
        (100 * FINE, "'100 stages of 10000000 steps in all' cannot be used"),
        (
            COARSE.replace("1 deg", "1e-5 deg"),
            "drive.1.step: '1e-5 deg' cannot be used; at most 100000 steps",
        ),
    ],
)
def test_the_work_has_a_bound(
    stages: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    began = perf_counter()
    assert message in refused(BODY + stages, tmp_path, capsys)
    assert perf_counter() - began < 10  # it takes a tenth of a second; the given one took over a minute


def test_as_much_work_as_is_allowed_is_read() -> None:
    assert len(Case.parse(BODY + MOST_STAGES * COARSE).drive) == MOST_STAGES


def test_the_error_names_the_option_that_makes_too_many_steps() -> None:
    case = Case.parse(BODY + FINE + FINE.replace("1e-3", "2e-3") + COARSE)
    with pytest.raises(InputError, match="at most 200000 steps") as caught:
        with_options(case, to="100 deg", step="1e-3 deg")
    assert caught.value.field == "--to"


@pytest.mark.parametrize(
    ("later", "message"),
    [
        (
            UP.replace("[[drive]]", '[[drive]]\npath_control = "jump"').replace(
                '"displacement"', '"force"\nfollows = true'
            ),
            "drive.3.path_control: 'jump' cannot be used; in stage 3, projected and following forces",
        ),
        (
            UP.replace('"displacement"', '"force"')
            .replace('side = "right"', 'side = "left"')
            .replace("90", "0"),
            "held: 'left' cannot be used; in stage 3, the drive loads the side left along x",
        ),
        (
            UP.replace('side = "right"', 'side = "left"').replace("90", "0"),
            "held: 'left' cannot be used; in stage 3",
        ),
        (COARSE.replace("[[drive]]", '[[drive]]\nside = "left"'), "the drive moves the side left"),
        (UP.replace('"1 nm"', '"0 nm"'), "drive.3.to: '0 nm' cannot be used; it must not be zero"),
    ],
)
def test_later_stages_are_checked_before_the_first_runs(
    later: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert message in refused(BODY + UP + COARSE + later, tmp_path, capsys)


def test_a_control_that_a_later_stage_cannot_have_is_refused_on_resuming(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, out = tmp_path / "case.toml", str(tmp_path / "out")
    pulls = 2 * UP.replace('"1 nm"', '"0.01 nm"').replace('"0.5 nm"', '"0.01 nm"')
    projected = BODY.replace('distance = "0.4 nm"', 'distance = "0.4 nm"\ntraction = "projected"')
    file.write_text(projected.replace("4x1", "20x1") + pulls)
    assert main(["run", str(file), "--out", out]) == 0
    capsys.readouterr()
    assert main(["resume", out, "--control", "jump"]) == 2
    assert "drive.2.path_control: 'jump' cannot be used; in stage 2" in capsys.readouterr().err


def test_shipped_cases_of_several_stages_pass() -> None:
    assert len(load_case("press-and-peel").stages()) == 2
