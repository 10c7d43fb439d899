"""Drives: how one side of a body is moved or loaded by one parameter; one file each."""

from isopeel.problem.drives.base import Column, Drive, Freedom, Load, LoadControl
from isopeel.problem.drives.moved import MovedSide
from isopeel.problem.drives.pulled import PulledSide
from isopeel.problem.drives.rotated import RotatedSide

__all__ = ["Column", "Drive", "Freedom", "Load", "LoadControl", "MovedSide", "PulledSide", "RotatedSide"]
