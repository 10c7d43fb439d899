"""A substrate from one expression of its height."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.quantities import LENGTH, Meaning
from isopeel.physics.batch import BatchFunction
from isopeel.physics.formula import (
    check_constants,
    check_smooth,
    check_used,
    parse_formula,
    point_function,
)
from isopeel.physics.formula_dimensions import FormulaDimensions
from isopeel.physics.substrates.closest_point import curve_kernel, graph_kernel

if TYPE_CHECKING:
    import sympy

#: Places that a formula is tried at: from 1 pm in metres to 1 m in nanometres, on both sides.
_PLACES = np.concatenate([-np.geomspace(1e-12, 1e9, 211), [0.0], np.geomspace(1e-12, 1e9, 211)])


@dataclass(frozen=True)
class FormulaSubstrate:
    """Solid below y = f(x), f one expression of `x` and of the names in `constants` (in the problem's units).

    f' and f'' are derived by SymPy; `graph_kernel` says how far the closest point can be trusted. A graph
    cannot fold on itself; where f has no value is not known beforehand, and there the gap is nan. Raises
    InputError unless f'' is free of jumps and f has a value somewhere.
    """

    name: ClassVar[str] = "formula"
    dimensions: ClassVar[FormulaDimensions] = FormulaDimensions("formula", LENGTH, {"x": LENGTH})
    formula: Annotated[
        str, "a formula of the place x is needed", Meaning("height, a formula of the place x", "-x**2/(2*R)")
    ]
    constants: Annotated[
        Mapping[str, float],
        Meaning("constants of the formula, numbers or texts with units", {"R": "1 um"}, usual="none"),
    ] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check the formula."""
        import sympy

        check_constants("substrate.constants", self.constants, ("x",))
        object.__setattr__(self, "constants", dict(sorted(self.constants.items())))
        curve = _derive(self.formula, tuple(self.constants))
        check_smooth("substrate.formula", self.formula, curve)
        height = sympy.lambdify(("x", *self.constants), curve[0], "numpy")
        with np.errstate(all="ignore"):
            heights = height(_PLACES, *map(np.float64, self.constants.values()))
        if not np.isfinite(heights).any():
            raise InputError("substrate.formula", self.formula, "it must have finite real values")
        check_used("substrate.constants", self.constants, self.formula)

    @property
    def parameters(self) -> FloatArray:
        """The address of the curve, and the constants in the alphabetic order of their names."""
        curve = curve_kernel(_graph(self.formula, tuple(self.constants)))
        return np.array([curve.address, *self.constants.values()], dtype=np.float64)

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of gap, normal and curvature."""
        return graph_kernel()

    @property
    def constant_curvature(self) -> bool:
        """No, but for formulas that had better be written as another substrate."""
        return False

    def receded(self, gap: float) -> Self:
        """Lower by a gap (length)."""
        return replace(self, formula=f"({self.formula}) - ({float(gap)!r})")


@cache
def _graph(formula: str, constants: tuple[str, ...]) -> Callable[..., Any]:
    return point_function({"x": "x"}, constants, _derive(formula, constants))


@cache
def _derive(formula: str, constants: tuple[str, ...]) -> "tuple[sympy.Expr, sympy.Expr, sympy.Expr]":
    """f, f' and f''."""
    import sympy

    height = parse_formula("substrate.formula", formula, ("x", *constants))
    place = sympy.Symbol("x", real=True)
    return height, height.diff(place), height.diff(place, 2)
