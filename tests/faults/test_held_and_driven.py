"""A side that is held and driven: one line before the first step, whatever holds and drives it."""

from pathlib import Path

import pytest

from isopeel.assembly.system import System
from isopeel.case import Case
from isopeel.cli import main

CASE = """
name = "held"
held = {held}
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
mesh = "{mesh}"
space = "L1"
across_degree = 1
[drive]
side = "{side}"
{drive}
"""
PULLED = 'kind = "force"\nangle = "{} deg"\nto = "1 nm"\nstep = "0.25 nm"'
LOADED = 'kind = "force"\ncontrol = "force"\nangle = "{} deg"\nto = "0.01 N/m"\nstep = "0.01 N/m"'
MOVED = 'kind = "displacement"\nangle = "{} deg"\nto = "1 nm"\nstep = "0.25 nm"\ntransverse = "held"'
TURNED = 'kind = "rotation"\nto = "2 deg"\nstep = "1 deg"'


@pytest.mark.parametrize(
    ("held", "mesh", "side", "drive", "message"),
    [
        # the given one: a tangent of zeros, and ZeroDivisionError
        ('{ right = "xy" }', "20x2", "right", PULLED.format(45), "held along x; hold another side"),
        (
            '{ left = "x", right = "y" }',
            "20x2",
            "right",
            PULLED.format(45),
            "held along y; hold another side",
        ),
        ('{ right = "x" }', "20x2", "right", PULLED.format(180), "held along x; hold another side"),
        ('{ top = "xy" }', "20x2", "top", PULLED.format(90), "held along y; hold another side"),
        # a dead load that only presses on the support: zero displacement, and exit 0
        ('{ right = "xy" }', "20x2", "right", LOADED.format(60), "held along x; hold another side"),
        ('{ left = "xy", right = "y" }', "20x2", "right", LOADED.format(90), "held along y; hold another"),
        ('{ left = "xy" }', "20x2", "left", PULLED.format(0) + "\nfollows = true", "held along x; hold"),
        # no side alone holds it, but all of its two corners are
        (
            '{ bottom = "y", top = "y" }',
            "20x1",
            "right",
            PULLED.format(90),
            "held along y; hold another side",
        ),
        ('{ right = "y" }', "20x2", "right", MOVED.format(90), "the drive moves the side right"),
        ('{ bottom = "x" }', "20x2", "right", MOVED.format(30), "the drive moves the side right"),
        ('{ top = "y" }', "20x2", "right", TURNED, "the drive moves the side right"),
        ('{ left = "xy" }', "1x1", "right", MOVED.format(0), "on this mesh the whole body is held"),
    ],
)
def test_what_is_held_and_driven_is_refused(
    held: str,
    mesh: str,
    side: str,
    drive: str,
    message: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    file = tmp_path / "held.toml"
    file.write_text(CASE.format(held=held, mesh=mesh, side=side, drive=drive))
    assert main(["run", str(file), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert error.startswith("isopeel: held: ")
    assert message in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("held", "side", "drive"),
    [
        ('{ left = "x", right = "y" }', "right", PULLED.format(0)),  # a guided end
        ('{ left = "x" }', "top", PULLED.format(45)),  # a corner of the loaded side is held
        ('{ left = "x", right = "y" }', "right", MOVED.format(0)),  # held across by both
    ],
)
def test_what_can_still_move_is_driven(held: str, side: str, drive: str) -> None:
    case = Case.parse(CASE.format(held=held, mesh="8x2", side=side, drive=drive))
    assert System(case.problem(), case.space()).count > 0
