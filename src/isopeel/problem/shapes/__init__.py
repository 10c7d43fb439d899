"""Shapes of bodies: one patch each, by a few lengths or from a file."""

from isopeel.problem.shapes.base import Shape
from isopeel.problem.shapes.curved_strip import Bend, CurvedStrip
from isopeel.problem.shapes.half_cylinder import HalfCylinder
from isopeel.problem.shapes.patch import Patch
from isopeel.problem.shapes.quarter_cylinder import QuarterCylinder
from isopeel.problem.shapes.strip import Strip
from isopeel.problem.shapes.tapered_strip import TaperedStrip

__all__ = [
    "Bend",
    "CurvedStrip",
    "HalfCylinder",
    "Patch",
    "QuarterCylinder",
    "Shape",
    "Strip",
    "TaperedStrip",
]
