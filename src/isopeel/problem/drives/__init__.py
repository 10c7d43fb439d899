"""Drives: how boundaries are moved or loaded by one parameter; one file each."""

from isopeel.problem.drives.base import (
    Column,
    Constraint,
    Drive,
    Freedom,
    Load,
    LoadControl,
    raises_load,
)
from isopeel.problem.drives.moved import MovedSide
from isopeel.problem.drives.pulled import PulledSide
from isopeel.problem.drives.rotated import RotatedSide

__all__ = [
    "Column",
    "Constraint",
    "Drive",
    "Freedom",
    "Load",
    "LoadControl",
    "MovedSide",
    "PulledSide",
    "RotatedSide",
    "raises_load",
]
