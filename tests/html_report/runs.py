"""Runs that the tests of a page are about."""

from pathlib import Path

from rich.console import Console

import isopeel
from isopeel.case import with_options
from isopeel.running.run import run_case

_QUIET = Console(quiet=True)


def strip(folder: Path) -> Path:
    """The folder of a strip that is bent a little, with four stored states of seven steps."""
    case = with_options(isopeel.load_case("strip"), mesh="40x2", space="N2", to="30", step="5")
    run_case(case, folder, _QUIET)
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
