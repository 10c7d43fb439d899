"""An adhesion law from one expression of its potential."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.quantities import LENGTH, SURFACE_ENERGY, Meaning
from isopeel.physics.adhesion.normal import law_kernel
from isopeel.physics.batch import BatchFunction
from isopeel.physics.formula import (
    check_constants,
    check_smooth,
    check_used,
    parse_formula,
    point_function,
)
from isopeel.physics.formula_dimensions import FormulaDimensions
from isopeel.physics.formula_poles import poles

if TYPE_CHECKING:
    import sympy

#: Gaps that the equilibrium is looked for at, 0.1 % apart: from 1 pm in metres to 1 m in nanometres. The
#: last one counts as infinite.
_GAPS = np.geomspace(1e-12, 1e9, 48_001)


_UNFINISHED = 1e-3  # of the work of adhesion, for gap times traction at the last gap
_ROUND_OFF = 1e-9  # of a gap, to which a pole is found


@dataclass(frozen=True)
class FormulaAdhesion:
    """Reversible adhesion law whose potential per area is one expression of the gap `r`.

    `potential` may use `r` and the names in `constants` (values in the units of the problem). T = -dPhi/dr
    (repulsion positive) and dT/dr are derived by SymPy. Phi counts from its value at infinity, which the
    formula may have. A potential that is not finite at r = 0 holds for positive gaps only, and one with a
    pole below the equilibrium for gaps beyond that. Raises InputError unless the traction turns from
    repulsion to attraction at some gap, the equilibrium gap, has finite values from there on, and it takes a
    positive, finite work to part the surfaces.
    """

    name: ClassVar[str] = "formula"
    dimensions: ClassVar[FormulaDimensions] = FormulaDimensions("potential", SURFACE_ENERGY, {"r": LENGTH})
    potential: Annotated[
        str,
        "a formula of the gap r is needed",
        Meaning(
            "energy per area, a formula of the gap r",
            "W*((s/r)**8/3 - 4/3*(s/r)**2)",
            see="howto/adhesion-law.md",
        ),
    ]
    constants: Annotated[
        Mapping[str, float],
        Meaning(
            "constants of the formula, numbers or texts with units",
            {"W": "0.03 J/m^2", "s": "0.25 nm"},
            usual="none",
        ),
    ] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check the formula, its equilibrium gap and its work of adhesion."""
        check_constants("adhesion.constants", self.constants, ("r",))
        object.__setattr__(self, "constants", dict(sorted(self.constants.items())))
        derived = _derive(self.potential, tuple(self.constants))
        check_smooth("adhesion.potential", self.potential, derived)
        if not np.isfinite(self.equilibrium_gap):
            allowed = "it must have a minimum over the gap r, the equilibrium"
            if len(self._poles):
                allowed += f"; it has a pole at the gap r = {self._poles[-1]:.6g}, in units of the problem"
            raise InputError("adhesion.potential", self.potential, allowed)
        self._check_values()
        if not 0 < self.work_of_adhesion < np.inf:
            allowed = f"its work of adhesion must be positive and finite, it is {self.work_of_adhesion:g}"
            raise InputError("adhesion.potential", self.potential, allowed)
        # the work to the last gap is that to infinity only where little is left to do there
        if abs(float(self._function(1)(_GAPS[-1:])[0])) * _GAPS[-1] > _UNFINISHED * self.work_of_adhesion:
            allowed = "its attraction must vanish with the gap, so that the surfaces can be parted"
            raise InputError("adhesion.potential", self.potential, allowed)
        check_used("adhesion.constants", self.constants, self.potential)

    @classmethod
    def like(cls, strength: float, work_of_adhesion: float, equilibrium_gap: float) -> Self:
        """The exponential law of this strength, work and gap; it stays exponential in compression."""
        length = float(work_of_adhesion / (np.e * strength))
        constants = {"W": work_of_adhesion, "gap": equilibrium_gap, "length": length}
        return cls("-W*(1 + (r - gap)/length)*exp(-(r - gap)/length)", constants)

    @property
    def parameters(self) -> FloatArray:
        """The equilibrium gap, the constants in the alphabetic order of their names, and Phi at infinity."""
        far = self._function(0)(_GAPS[-1:])
        return np.array([self.equilibrium_gap, *self.constants.values(), *far], dtype=np.float64)

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of potential, traction and its derivative."""
        return law_kernel(_formulas(self.potential, tuple(self.constants), self._least_gap))

    @cached_property
    def equilibrium_gap(self) -> float:
        """The smallest gap at which T falls from repulsion to attraction; nan where there is none."""
        from scipy.optimize import brentq

        traction = self._function(1)
        # a law that is finite at contact may have its equilibrium there, as the exponential one
        gaps = _GAPS if self._positive_gaps_only else np.concatenate([[-_GAPS[0], 0.0], _GAPS])
        values = traction(gaps)
        attractive = np.flatnonzero(values < 0)
        falls = np.flatnonzero((values[:-1] > 0) & (values[1:] <= 0))
        # where no attraction follows, the repulsion has only fallen below the round-off
        if not len(falls) or not (attractive > falls[0]).any():
            return float("nan")
        bracket = gaps[falls[0]], gaps[falls[0] + 1]
        return float(
            brentq(
                lambda gap: float(traction(np.array(gap))), *bracket, xtol=1e-300, rtol=1e-14, maxiter=2000
            )
        )

    @property
    def work_of_adhesion(self) -> float:
        """Phi(infinity) - Phi(r_eq)."""
        near, far = self._function(0)(np.array([self.equilibrium_gap, _GAPS[-1]]))
        return float(far - near)

    def _check_values(self) -> None:
        """Raise InputError where the traction has no value from the equilibrium on, or attracts to a pole."""
        gap, least = self.equilibrium_gap, self._least_gap
        beyond = self._poles[self._poles >= gap - _ROUND_OFF * abs(gap)]
        if len(beyond):
            allowed = (
                f"it has a pole at the gap r = {beyond[0]:.6g}, in units of the problem, where a joint opens"
            )
            raise InputError("adhesion.potential", self.potential, allowed)
        gaps = self._gaps
        values = self._function(1)(gaps)
        lost = gaps[(gaps > gap) & np.isnan(values)]
        if len(lost):
            allowed = f"it has no value at the gap r = {lost[0]:.6g}, in units of the problem"
            raise InputError("adhesion.potential", self.potential, f"{allowed}, where a joint opens")
        near = values[(gaps > (least if least is not None else -np.inf)) & np.isfinite(values)]
        if least is not None and near[0] < 0:
            allowed = f"it attracts without bound at the gap r = {least:.6g}, in units of the problem"
            raise InputError("adhesion.potential", self.potential, f"{allowed}; it must repel there")

    @cached_property
    def _poles(self) -> FloatArray:
        return poles(self._function(1), self._gaps)

    @property
    def _gaps(self) -> FloatArray:
        """The gaps that it is tried at, negative ones where it may be pressed so far."""
        return _GAPS if self._positive_gaps_only else np.concatenate([-_GAPS[::-1], [0.0], _GAPS])

    @property
    def _least_gap(self) -> float | None:
        """The gap that it holds beyond, the nearest pole below the equilibrium; None for any gap."""
        below = self._poles[self._poles < self.equilibrium_gap]
        ends = [*below[-1:], *([0.0] if self._positive_gaps_only else [])]
        return float(max(ends)) if ends else None

    @cached_property
    def _positive_gaps_only(self) -> bool:
        return not bool(np.isfinite(self._function(0)(np.array(0.0))))

    def _function(self, order: int) -> Callable[[FloatArray], FloatArray]:
        """Phi (order 0) or T (order 1) as a function of the gap; nan and inf where it has no value."""
        function = _numeric(self.potential, tuple(self.constants), order)
        # numbers of NumPy overflow to infinity, those of Python raise
        values = [np.float64(value) for value in self.constants.values()]

        def evaluate(gaps: FloatArray) -> FloatArray:
            with np.errstate(all="ignore"):
                return np.broadcast_to(np.asarray(function(gaps, *values), dtype=np.float64), gaps.shape)

        return evaluate


@cache
def _derive(potential: str, constants: tuple[str, ...]) -> "tuple[sympy.Expr, sympy.Expr, sympy.Expr]":
    """Phi(r), T(r) and T'(r)."""
    import sympy

    phi = parse_formula("adhesion.potential", potential, ("r", *constants))
    gap = sympy.Symbol("r", real=True)
    return phi, -phi.diff(gap), -phi.diff(gap, 2)


@cache
def _numeric(potential: str, constants: tuple[str, ...], order: int) -> Callable[..., Any]:
    """Phi (order 0) or T (order 1) as a function of the gap and the constants; a case makes its law often."""
    import sympy

    return sympy.lambdify(("r", *constants), _derive(potential, constants)[order], "numpy")  # type: ignore[no-any-return]


@cache
def _formulas(potential: str, constants: tuple[str, ...], least_gap: float | None) -> Callable[..., Any]:
    """Phi, T and T' at one point, as `NormalLaw.at_point` returns them."""
    import sympy

    guard = None if least_gap is None else f"gap > {least_gap!r}"
    phi, traction, derivative = _derive(potential, constants)
    # no constant of a user has a name that begins with a line
    results = phi - sympy.Symbol("_far", real=True), traction, derivative
    return point_function({"r": "gap"}, (*constants, "_far"), results, guard)
