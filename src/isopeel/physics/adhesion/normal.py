"""Adhesion laws written as formulas at one point."""

from collections.abc import Callable
from dataclasses import fields
from functools import cache
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeVar, dataclass_transform

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.components import Component, named_dataclass
from isopeel.physics.batch import BatchFunction
from isopeel.physics.points import LAW_LOOP, check_arguments, compile_points

Law = TypeVar("Law", bound="type[NormalLaw]")


class NormalLaw(Component):
    """The base of a law T(g) of the gap g, which `normal_law` makes of its fields and its formulas.

    The formulas are those of one point, compiled: `at_point` returns the potential Phi, the traction
    T = -dPhi/dg (repulsion positive) and dT/dg. Its arguments are what it needs of `gap`, `opening` (the gap
    less the equilibrium gap), `equilibrium_gap` and `curvature` (of the substrate, positive where it bulges),
    and the numbers of `constants`, under names of their own. Where a value does not exist it returns nan. In
    place of `at_point` a text `potential` may be Phi as a formula of the former and of the names of fields;
    SymPy derives T and dT/dg when the law is first used, which takes a second.

    A law has an `equilibrium_gap` and a `work_of_adhesion`, as fields or as properties.
    """

    table: ClassVar[str] = "adhesion"
    needed: ClassVar[tuple[tuple[str, ...], ...]] = (
        ("equilibrium_gap",),
        ("work_of_adhesion",),
        ("at_point", "potential"),
    )
    at_point: ClassVar[Callable[..., tuple[float, float, float]]]
    potential: ClassVar[str]

    if TYPE_CHECKING:

        @property
        def equilibrium_gap(self) -> float:
            """Gap (length) at which a flat substrate neither pulls nor pushes."""

        @property
        def work_of_adhesion(self) -> float:
            """Energy per area to take flat surfaces from the equilibrium gap to infinity."""

    @classmethod
    def like(cls, strength: float, work_of_adhesion: float, equilibrium_gap: float) -> Self:
        """The law of this strength, work and gap, or of those of them that are fields."""
        known = {
            "strength": strength,
            "work_of_adhesion": work_of_adhesion,
            "equilibrium_gap": equilibrium_gap,
        }
        names = [field.name for field in fields(cls)]  # type: ignore[arg-type]
        return cls(**{name: value for name, value in known.items() if name in names})

    def constants(self) -> tuple[float, ...]:
        """Numbers that the formulas need, in the order of their arguments: by default the fields."""
        return tuple(getattr(self, name) for name in _constant_fields(type(self)))

    @property
    def parameters(self) -> FloatArray:
        """Numbers handed to the kernel: the equilibrium gap and the constants."""
        return np.array([self.equilibrium_gap, *self.constants()], dtype=np.float64)

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of potential, traction and its derivative."""
        kind: Any = type(self)
        formulas = _formulas(kind)
        check_arguments(formulas, LAW_LOOP.inputs, self.constants())
        return law_kernel(formulas)


@dataclass_transform(frozen_default=True)
def normal_law(law: Law) -> Law:
    """Make a subclass of `NormalLaw` a law: a frozen dataclass with a name for case files."""
    return named_dataclass(law)


@cache
def law_kernel(formulas: Callable[..., Any]) -> BatchFunction:
    """Batch function of formulas at one point, see `NormalLaw`."""
    return compile_points(LAW_LOOP, formulas)


@cache
def _formulas(law: type[Any]) -> Callable[..., Any]:
    """The formulas of a law, as they are written or derived from its potential."""
    if hasattr(law, "at_point"):
        return law.at_point  # type: ignore[no-any-return]
    # SymPy takes a second to load
    import sympy

    from isopeel.physics.formula import check_smooth, parse_formula, point_function

    field, constants = f"{law.__name__}.potential", _constant_fields(law)
    potential = parse_formula(field, law.potential, (*LAW_LOOP.inputs, *constants))

    def less_slope(of: "sympy.Expr") -> "sympy.Expr":
        return -sum(of.diff(sympy.Symbol(name, real=True)) for name in ("gap", "opening"))

    traction = less_slope(potential)
    results = potential, traction, -less_slope(traction)
    check_smooth(field, law.potential, results)
    return point_function({name: name for name in LAW_LOOP.inputs}, constants, results)


def _constant_fields(law: type[Any]) -> tuple[str, ...]:
    return tuple(field.name for field in fields(law) if field.name not in LAW_LOOP.inputs)
