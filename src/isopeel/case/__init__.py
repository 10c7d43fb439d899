"""The case file: keys, units and stages. Each stage is converted to a problem and its parameters."""

from isopeel.case.case import Case, load_case, parse_mesh, shipped_cases
from isopeel.case.changes import assignment
from isopeel.case.stages import Stage

__all__ = ["Case", "Stage", "assignment", "load_case", "parse_mesh", "shipped_cases"]
