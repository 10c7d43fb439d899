"""The case file: keys, units and stages. Each stage is converted to a problem and its parameters."""

from isopeel.case.case import Case
from isopeel.case.changes import assignment
from isopeel.case.discretization import parse_mesh
from isopeel.case.load import load_case, shipped_cases
from isopeel.case.one_body import OneBody
from isopeel.case.options import with_options
from isopeel.case.several_bodies import SeveralBodies
from isopeel.case.stages import Stage

__all__ = [
    "Case",
    "OneBody",
    "SeveralBodies",
    "Stage",
    "assignment",
    "load_case",
    "parse_mesh",
    "shipped_cases",
    "with_options",
]
