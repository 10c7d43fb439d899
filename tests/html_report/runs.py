"""Runs that the tests of a page are about."""

from pathlib import Path

from rich.console import Console

import isopeel
from isopeel.case import Case, with_options
from isopeel.running.run import run_case

_QUIET = Console(quiet=True)


def strip(folder: Path) -> Path:
    """The folder of a strip that is bent a little, with four stored states of seven steps."""
    case = with_options(isopeel.load_case("strip"), mesh="40x2", space="N2", to="30", step="5")
    run_case(case, folder, _QUIET)
    return folder


def two_bodies(folder: Path) -> Path:
    """The folder of a strip that is peeled beside one that rests on the same substrate."""
    text = 'name = "two"\n[drive]\nboundary = "one.right"\nto = "60 deg"\nstep = "20 deg"\n'
    for name, x in (("one", 0), ("other", 50)):
        text += (
            f'[[body]]\nname = "{name}"\nlength = "30 nm"\nheight = "2 nm"\nat = ["{x} nm", "0 nm"]\n'
            'material = { law = "neo-hooke", youngs_modulus = "2 GPa", poissons_ratio = 0.2 }\n'
            f'space = "N2"\nmesh = "20x2"\n[[support]]\nboundary = "{name}.left"\nholds = "x"\n'
            f'[[interface]]\nboundary = "{name}.bottom"\nlength = "20 nm"\nlaw = "exponential"\n'
            'strength = "60 MPa"\nwork_of_adhesion = "0.03 J/m^2"\nsubstrate = { kind = "flat" }\n'
        )
    run_case(Case.parse(text), folder, _QUIET)
    return folder


def staged(folder: Path) -> Path:
    """The folder of a case of two stages on a wavy substrate, of a few steps each."""
    case = with_options(isopeel.load_case("press-and-peel"), mesh="20x1", space="L1", to="1", step="0.5")
    run_case(case, folder, _QUIET)
    return folder


def failed(folder: Path) -> Path:
    """The folder of a strip whose elements are so large that a step finds no equilibrium."""
    case = with_options(
        isopeel.load_case("strip"), mesh="10x1", space="L1", to="80", step="20", path_control="newton"
    )
    run_case(case, folder, _QUIET)
    return folder
