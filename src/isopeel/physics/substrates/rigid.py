"""Substrates written as formulas at one point, or as the graph of a function."""

from collections.abc import Callable
from dataclasses import fields, replace
from functools import cache
from typing import Any, ClassVar, Self, TypeVar, dataclass_transform

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.components import Component, named_dataclass
from isopeel.physics.batch import BatchFunction
from isopeel.physics.points import SUBSTRATE_LOOP, check_arguments, compile_points
from isopeel.physics.substrates.closest_point import GRAPH_LOOP, curve_kernel, graph_kernel

Kind = TypeVar("Kind", bound="type[RigidSubstrate]")


class RigidSubstrate(Component):
    """The base of a rigid body, which `substrate` makes of its fields and its formulas.

    The formulas are those of one point, compiled: `at_point` returns the gap from (x, y) to the closest point
    of the substrate, the outward normal there (its two components) and the curvature there (positive where
    the substrate bulges). Its arguments are `x`, `y` and the numbers of `constants`. The solid below a graph
    y = f(x) has a `graph` instead, which returns f, f' and f'' at `x`, or a text `formula` of f; it may use
    the names of fields, and SymPy derives f' and f'' when the substrate is first used. `graph_kernel` says
    how far its closest point can be trusted. Where a value does not exist it is nan.
    """

    table: ClassVar[str] = "substrate"
    needed: ClassVar[tuple[tuple[str, ...], ...]] = (("at_point", "graph", "formula"),)
    at_point: ClassVar[Callable[..., tuple[float, float, float, float]]]
    graph: ClassVar[Callable[..., tuple[float, float, float]]]
    formula: ClassVar[str]
    #: Whether the curvature is the same all along the substrate, as `VanDerWaals` assumes.
    constant_curvature: ClassVar[bool] = False

    def receded(self, gap: float) -> Self:
        """Lower by a gap (length), for a substrate with a field `height`."""
        here: Any = self
        lower: Self = replace(here, height=here.height - gap)
        return lower

    def constants(self) -> tuple[float, ...]:
        """Numbers that the formulas need, in the order of their arguments: by default the fields."""
        here: Any = self
        return tuple(getattr(self, field.name) for field in fields(here))

    @property
    def parameters(self) -> FloatArray:
        """Numbers handed to the kernel: the constants, after the address of the curve of a graph."""
        kind: Any = type(self)
        constants = self.constants()
        if hasattr(kind, "at_point"):
            check_arguments(kind.at_point, SUBSTRATE_LOOP.inputs, constants)
            return np.array(constants, dtype=np.float64)
        graph = kind.graph if hasattr(kind, "graph") else _graph(kind)
        check_arguments(graph, GRAPH_LOOP.inputs, constants)
        return np.array([curve_kernel(graph).address, *constants], dtype=np.float64)

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of gap, normal and curvature."""
        kind: Any = type(self)
        return substrate_kernel(kind.at_point) if hasattr(kind, "at_point") else graph_kernel()


@dataclass_transform(frozen_default=True)
def substrate(kind: Kind) -> Kind:
    """Make a subclass of `RigidSubstrate` a substrate: a frozen dataclass with a name for case files."""
    return named_dataclass(kind)


@cache
def substrate_kernel(at_point: Callable[..., Any]) -> BatchFunction:
    """Batch function of formulas at one point, see `RigidSubstrate`."""
    return compile_points(SUBSTRATE_LOOP, at_point)


@cache
def _graph(kind: type[Any]) -> Callable[..., Any]:
    """f, f' and f'' of a substrate with a formula."""
    # SymPy takes a second to load
    import sympy

    from isopeel.physics.formula import check_smooth, parse_formula, point_function

    field, constants = f"{kind.__name__}.formula", tuple(one.name for one in fields(kind))
    height = parse_formula(field, kind.formula, ("x", *constants))
    x = sympy.Symbol("x", real=True)
    results = height, height.diff(x), height.diff(x, 2)
    check_smooth(field, kind.formula, results)
    return point_function({"x": "x"}, constants, results)
