"""An adhesion law from one expression of its potential."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from types import MappingProxyType

import numpy as np
import sympy
from scipy.optimize import brentq

from isopeel.arrays import FloatArray
from isopeel.errors import InputError
from isopeel.physics.batch import ADHESION_SIGNATURE, BatchFunction
from isopeel.physics.formula import batch_source, check_constants, compile_source, parse_formula


@dataclass(frozen=True)
class FormulaAdhesion:
    """Reversible adhesion law whose potential per area is one expression of the gap `r`.

    `potential` may use `r` and the names in `constants` (values in the units of the problem). T = -dPhi/dr
    (repulsion positive) and dT/dr are derived by SymPy. Raises InputError unless the traction turns from
    repulsion to attraction at some gap, the equilibrium gap.
    """

    potential: str
    constants: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check the formula and that it has an equilibrium gap."""
        check_constants("adhesion.constants", self.constants, ("r",))
        object.__setattr__(self, "constants", MappingProxyType(dict(sorted(self.constants.items()))))
        if not np.isfinite(self.equilibrium_gap):
            raise InputError(
                "adhesion.potential", self.potential, "it must have a minimum over the gap r, its equilibrium"
            )

    @property
    def parameters(self) -> FloatArray:
        """Values of the constants, in the alphabetic order of their names."""
        return np.array(list(self.constants.values()), dtype=np.float64)

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of potential, traction and its derivative."""
        return compile_source(_source(self.potential, tuple(self.constants)), ADHESION_SIGNATURE)

    @cached_property
    def equilibrium_gap(self) -> float:
        """The smallest gap at which T falls through zero; nan where there is none."""
        traction = self._function(1)
        gaps = np.geomspace(1e-6, 1e6, 24_001)  # twelve decades of the problem's length, 0.1 % apart
        with np.errstate(all="ignore"):
            values = np.array([traction(gap) for gap in gaps])
        falls = np.flatnonzero((values[:-1] > 0) & (values[1:] <= 0))
        if not len(falls):
            return float("nan")
        first = falls[0]
        return float(brentq(traction, gaps[first], gaps[first + 1], xtol=1e-15, rtol=1e-14))

    @property
    def work_of_adhesion(self) -> float:
        """Phi(infinity) - Phi(r_eq), infinity being a gap of 10^6 lengths."""
        potential = self._function(0)
        return float(potential(1e6) - potential(self.equilibrium_gap))

    def _function(self, order: int) -> "sympy.core.function.FunctionClass":
        """Phi (order 0) or T (order 1) as a function of the gap."""
        expression = _derive(self.potential, tuple(self.constants))[order]
        values = {sympy.Symbol(name, real=True): value for name, value in self.constants.items()}
        return sympy.lambdify("r", expression.subs(values), "numpy")


@cache
def _derive(potential: str, constants: tuple[str, ...]) -> tuple[sympy.Expr, sympy.Expr, sympy.Expr]:
    """Phi(r), T(r) and T'(r)."""
    phi = parse_formula("adhesion.potential", potential, ("r", *constants))
    gap = sympy.Symbol("r", real=True)
    return phi, -phi.diff(gap), -phi.diff(gap, 2)


@cache
def _source(potential: str, constants: tuple[str, ...]) -> str:
    arguments = "gap, curvature, parameters, count, potential, traction, derivative"
    entries = ("potential[n]", "traction[n]", "derivative[n]")
    outputs = dict(zip(entries, _derive(potential, constants), strict=True))
    return batch_source(arguments, {"r": "gap[n]"}, constants, outputs)
