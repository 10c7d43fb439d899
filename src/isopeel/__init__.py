"""isopeel: peeling of soft solids off adhesive surfaces by isogeometric analysis."""

from isopeel.errors import InputError
from isopeel.physics.adhesion import FormulaAdhesion, VanDerWaals
from isopeel.physics.materials import FormulaMaterial, NeoHooke
from isopeel.physics.substrates import Flat
from isopeel.problem import AdhesiveSide, Body, FixedSide, Problem, RotatedSide, strip
from isopeel.results.curve import Curve
from isopeel.solve.newton import ConvergenceError, NewtonSettings
from isopeel.solve.trace import Step, trace
from isopeel.splines.rows import RowSpace, row_space

__version__ = "0.1.0"

__all__ = [
    "AdhesiveSide",
    "Body",
    "ConvergenceError",
    "Curve",
    "FixedSide",
    "Flat",
    "FormulaAdhesion",
    "FormulaMaterial",
    "InputError",
    "NeoHooke",
    "NewtonSettings",
    "Problem",
    "RotatedSide",
    "RowSpace",
    "Step",
    "VanDerWaals",
    "row_space",
    "strip",
    "trace",
]
