"""A body and its shape, where it adheres, what is held, the drive; no meshes, no solvers."""

from isopeel.problem.drives import Column, Drive, Load, MovedSide, PulledSide, RotatedSide
from isopeel.problem.problem import AdhesiveSide, Body, FixedSide, Problem, Traction
from isopeel.problem.strip import strip

__all__ = [
    "AdhesiveSide",
    "Body",
    "Column",
    "Drive",
    "FixedSide",
    "Load",
    "MovedSide",
    "Problem",
    "PulledSide",
    "RotatedSide",
    "Traction",
    "strip",
]
