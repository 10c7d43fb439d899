"""Bodies and their shapes, interfaces, supports, the drive and loads, as data; no meshes, no solvers."""

from isopeel.problem.boundary import Boundary, Driven, Place
from isopeel.problem.drives import (
    Column,
    Constraint,
    Drive,
    Load,
    MovedSide,
    PulledSide,
    RotatedSide,
    raises_load,
)
from isopeel.problem.interface import Interface, Scheme, Traction
from isopeel.problem.loads import HeldLoad
from isopeel.problem.problem import Body, Problem, Support
from isopeel.problem.strip import strip
from isopeel.problem.tie import Tie

__all__ = [
    "Body",
    "Boundary",
    "Column",
    "Constraint",
    "Drive",
    "Driven",
    "HeldLoad",
    "Interface",
    "Load",
    "MovedSide",
    "Place",
    "Problem",
    "PulledSide",
    "RotatedSide",
    "Scheme",
    "Support",
    "Tie",
    "Traction",
    "raises_load",
    "strip",
]
