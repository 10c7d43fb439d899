"""isopeel: peeling of soft solids off adhesive surfaces by isogeometric analysis."""

import sys

# `python -m isopeel` looks for modules first in the current folder, whoever wrote them. This folder is
# removed from the path. Until the module is found, the first argument is "-m".
if sys.argv[:1] == ["-m"] and not sys.flags.safe_path:
    del sys.path[:1]

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from isopeel.case import Case, load_case
    from isopeel.common.errors import InputError
    from isopeel.identification.measured import Measured, read_measured
    from isopeel.identification.result import FitResult
    from isopeel.identification.run import fit, fit_file
    from isopeel.physics.adhesion import (
        Bilinear,
        Contact,
        Dugdale,
        Exponential,
        LennardJones,
        Trapezoidal,
        VanDerWaals,
    )
    from isopeel.physics.adhesion.formula import FormulaAdhesion
    from isopeel.physics.adhesion.mirrored import Mirrored
    from isopeel.physics.joints import MixedModeBilinear, XuNeedleman
    from isopeel.physics.materials import MooneyRivlin, NeoHooke, SaintVenantKirchhoff, Yeoh
    from isopeel.physics.materials.formula import FormulaMaterial
    from isopeel.physics.materials.prestretched import Prestretched
    from isopeel.physics.substrates import Circle, Flat, Wavy
    from isopeel.physics.substrates.formula import FormulaSubstrate
    from isopeel.problem import (
        Body,
        Boundary,
        HeldLoad,
        Interface,
        MovedSide,
        Problem,
        PulledSide,
        RotatedSide,
        Support,
        Tie,
        strip,
    )
    from isopeel.problem.shapes import (
        CurvedStrip,
        HalfCylinder,
        Patch,
        QuarterCylinder,
        Strip,
        TaperedStrip,
    )
    from isopeel.results.curve import Curve
    from isopeel.results.run_file import StoredRun, read_run
    from isopeel.solve.convergence import ConvergenceError
    from isopeel.solve.newton import NewtonSettings
    from isopeel.solve.step import State, Step
    from isopeel.solve.supports import support_reactions
    from isopeel.solve.trace import trace
    from isopeel.splines.rows import RowSpace, row_space
    from isopeel.study.parameter_study import ParameterStudy, load_study, parameter_study
    from isopeel.study.sobol import variance_shares
    from isopeel.study.table import StudyResults

__version__ = "0.1.0"

__all__ = [
    "Bilinear",
    "Body",
    "Boundary",
    "Case",
    "Circle",
    "Contact",
    "ConvergenceError",
    "Curve",
    "CurvedStrip",
    "Dugdale",
    "Exponential",
    "FitResult",
    "Flat",
    "FormulaAdhesion",
    "FormulaMaterial",
    "FormulaSubstrate",
    "HalfCylinder",
    "HeldLoad",
    "InputError",
    "Interface",
    "LennardJones",
    "Measured",
    "Mirrored",
    "MixedModeBilinear",
    "MooneyRivlin",
    "MovedSide",
    "NeoHooke",
    "NewtonSettings",
    "ParameterStudy",
    "Patch",
    "Prestretched",
    "Problem",
    "PulledSide",
    "QuarterCylinder",
    "RotatedSide",
    "RowSpace",
    "SaintVenantKirchhoff",
    "State",
    "Step",
    "StoredRun",
    "Strip",
    "StudyResults",
    "Support",
    "TaperedStrip",
    "Tie",
    "Trapezoidal",
    "VanDerWaals",
    "Wavy",
    "XuNeedleman",
    "Yeoh",
    "fit",
    "fit_file",
    "load_case",
    "load_study",
    "parameter_study",
    "read_measured",
    "read_run",
    "row_space",
    "strip",
    "support_reactions",
    "trace",
    "variance_shares",
]

# Names are imported when they are first used, so that the help of the command line does not load a compiler.
_MODULES = {
    "case": ("Case", "load_case"),
    "common.errors": ("InputError",),
    "physics.adhesion": (
        "Bilinear",
        "Contact",
        "Dugdale",
        "Exponential",
        "LennardJones",
        "Trapezoidal",
        "VanDerWaals",
    ),
    "physics.adhesion.formula": ("FormulaAdhesion",),
    "physics.joints": ("MixedModeBilinear", "XuNeedleman"),
    "physics.materials": ("MooneyRivlin", "NeoHooke", "SaintVenantKirchhoff", "Yeoh"),
    "physics.materials.formula": ("FormulaMaterial",),
    "physics.substrates": ("Circle", "Flat", "Wavy"),
    "physics.substrates.formula": ("FormulaSubstrate",),
    "physics.adhesion.mirrored": ("Mirrored",),
    "physics.materials.prestretched": ("Prestretched",),
    "problem": (
        "Body",
        "Boundary",
        "HeldLoad",
        "Interface",
        "MovedSide",
        "Problem",
        "PulledSide",
        "RotatedSide",
        "Support",
        "Tie",
        "strip",
    ),
    "problem.shapes": (
        "CurvedStrip",
        "HalfCylinder",
        "Patch",
        "QuarterCylinder",
        "Strip",
        "TaperedStrip",
    ),
    "results.curve": ("Curve",),
    "results.run_file": ("StoredRun", "read_run"),
    "solve.convergence": ("ConvergenceError",),
    "solve.newton": ("NewtonSettings",),
    "solve.step": ("State", "Step"),
    "solve.supports": ("support_reactions",),
    "solve.trace": ("trace",),
    "splines.rows": ("RowSpace", "row_space"),
    "identification.measured": ("Measured", "read_measured"),
    "identification.result": ("FitResult",),
    "identification.run": ("fit", "fit_file"),
    "study.parameter_study": ("ParameterStudy", "load_study", "parameter_study"),
    "study.sobol": ("variance_shares",),
    "study.table": ("StudyResults",),
}
_HOMES = {name: module for module, names in _MODULES.items() for name in names}

if not TYPE_CHECKING:  # type checkers read the imports above

    def __getattr__(name: str) -> object:
        if name not in _HOMES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        value: object = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
        globals()[name] = value
        return value

    def __dir__() -> list[str]:
        return sorted({*globals(), *__all__})
