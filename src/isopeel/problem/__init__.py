"""Bodies and their shapes, interfaces, supports and the drive, as data; no meshes, no solvers."""

from isopeel.problem.drives import Column, Drive, Load, MovedSide, PulledSide, RotatedSide
from isopeel.problem.problem import Body, Boundary, Interface, Problem, Support, Traction
from isopeel.problem.strip import strip

__all__ = [
    "Body",
    "Boundary",
    "Column",
    "Drive",
    "Interface",
    "Load",
    "MovedSide",
    "Problem",
    "PulledSide",
    "RotatedSide",
    "Support",
    "Traction",
    "strip",
]
