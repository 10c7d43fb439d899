"""The case file: what is peeled, on which space, how far and in which steps, in TOML with units."""

from isopeel.case.case import Case, load_case, parse_mesh, shipped_cases
from isopeel.case.changes import assignment
from isopeel.case.stages import Stage

__all__ = ["Case", "Stage", "assignment", "load_case", "parse_mesh", "shipped_cases"]
