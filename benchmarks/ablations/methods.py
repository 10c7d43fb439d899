"""The methods that make a path fast: the code of each, and how it is switched off.

A method is switched off by a change of the package in a process of its own, before the first path. If
compiled code changes, the process has a cache of its own. The package itself has no such switches.
"""

import ast
import inspect
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from isopeel.common.arrays import FloatArray


@dataclass(frozen=True)
class Method:
    """One method: its name, its code, and the function that switches it off.

    The code is given by modules, or by names in modules: `isopeel.solve.predictor:Predictor.slope`.
    """

    name: str
    code: Sequence[str]
    switch_off: Callable[[], object]
    instead: str
    compiles: bool = False  # compiled functions change: they need a cache of their own
    extra_lines: int = 0  # inside of functions that stay, counted by hand

    @property
    def lines(self) -> int:
        """Lines of code, without docstrings, comments and blank lines."""
        return self.extra_lines + sum(_lines(one) for one in self.code)


def _lines(part: str) -> int:
    module, _, name = part.partition(":")
    file = Path(inspect.getsourcefile(import_module(module)) or "")
    tree: ast.AST = ast.parse(file.read_text(encoding="utf-8"))
    for word in name.split(".") if name else ():
        body = tree.body if isinstance(tree, ast.Module | ast.ClassDef) else []
        tree = next(node for node in body if getattr(node, "name", None) == word)
    code: set[int] = set()
    documentation: set[int] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.stmt):
            code.update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            documentation.update(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    text = file.read_text(encoding="utf-8").splitlines()
    return sum(
        1 for n in code - documentation if text[n - 1].strip() and not text[n - 1].strip().startswith("#")
    )


def _set(module: str, name: str, value: object) -> None:
    """Set a name of a module or of a class, which must exist."""
    place: object = import_module(module)
    *outer, last = name.split(".")
    for word in outer:
        place = getattr(place, word)
    if not hasattr(place, last):
        raise AttributeError(f"{module} has no {name}")
    setattr(place, last, value)


def _no_translation() -> None:
    _set("isopeel.solve.predictor", "TranslationPredictor.of", lambda *_: None)


def _fixed_polynomial(states: int) -> Callable[[], None]:
    def switch_off() -> None:
        from isopeel.solve.polynomials import lagrange

        def fixed(parameters: FloatArray, *others: Any) -> tuple[FloatArray, bool]:
            n, target = len(parameters), others[-1]
            count = min(n, states)
            weights, basis = np.zeros((2, n)), np.empty((2, count))
            lagrange(parameters, n - count, count, target, basis)
            weights[0, n - count :] = basis[0]
            return weights, False

        _no_translation()
        _set("isopeel.solve.predictor", "select_predictor", fixed)

    return switch_off


def _no_energy_measure() -> None:
    from isopeel.solve.predictor_selection import select_predictor

    def by_parameter(parameters: Any, ahead: Any, _energies: Any, *others: Any) -> Any:
        # the same measure twice: the second one is never better
        weights, _ = select_predictor(parameters, ahead, parameters, *others)
        return weights, False

    _set("isopeel.solve.predictor", "select_predictor", by_parameter)


def _every_evaluation() -> None:
    _set("isopeel.solve.quasi_newton", "_SKIP_SHARE", 0.0)


def _double_precision() -> None:
    from isopeel.matrix.cholesky import BandCholesky, energy
    from isopeel.matrix.mixed_precision import GOLDEN_RATIO, Approximate

    def doubled(matrix: Any) -> Approximate:
        factor = BandCholesky.of(matrix.entries, np.float64)
        anything = np.mod(np.arange(factor.count) * GOLDEN_RATIO, 1.0) - 0.5
        soft = factor.solve(factor.solve(anything))
        return Approximate(factor, soft, energy(matrix.entries, soft))

    _set("isopeel.solve.quasi_newton", "approximate", doubled)


def _plain_loops() -> None:
    """Replace the operations on vectors by loops, before the factor is imported."""
    sys.modules["isopeel.matrix.simd_kernels"] = plain = ModuleType("isopeel.matrix.simd_kernels")
    loops = import_module("ablations.plain_loops")
    for name in ("COLUMNS", "forward", "backward", "set_product", "take_off_product"):
        setattr(plain, name, getattr(loops, name))


def _full_reach() -> None:
    from isopeel.matrix.simd_kernels import COLUMNS

    def full(columns: Any, reach: Any) -> None:
        n, width = columns.shape
        for block in range(len(reach)):
            beyond = (block + 1) * COLUMNS
            last = min(beyond - 1, n - 1) + width - 1
            reach[block] = -(-max(min(last, n - 1) + 1 - beyond, 0) // COLUMNS) * COLUMNS

    _set("isopeel.matrix.cholesky", "_find_reach", full)


def _no_rectangles() -> None:
    _set("isopeel.assembly.tables", "_of_rectangles", lambda _maps, _weights: False)


def _no_pairs() -> None:
    from isopeel.common.compilation import compiled_reordered

    @compiled_reordered
    def none(_rows: Any, _products: Any, first: int, _end: int, _correction: Any, _change: Any) -> Any:
        return first, first

    _set("isopeel.solve.corrections", "follow", none)


def _plain_newton() -> None:
    _set("isopeel.solve.quasi_newton", "QuasiNewton.applies", lambda *_: False)


def _sums_in_order() -> None:
    compilation = import_module("isopeel.common.compilation")
    compilation.REORDERED.clear()
    compilation.REORDERED.update(compilation.EXACT)


def _no_stored_motion() -> None:
    for name in ("moved", "rate"):
        _set("isopeel.assembly.constraints", f"Constraints.{name}", _always_computed(name))


def _always_computed(name: str) -> Callable[..., Any]:
    from isopeel.assembly.constraints import Constraints

    method = vars(Constraints)[name]

    def computed(self: Any, parameter: float) -> Any:
        getattr(self, f"_{name}").clear()
        return method(self, parameter)

    return computed


METHODS = (
    Method(
        "chord tangent with L-BFGS",
        (
            "isopeel.solve.quasi_newton",
            "isopeel.solve.corrections",
            "isopeel.solve.lbfgs",
            "isopeel.matrix.mixed_precision",
            "isopeel.matrix.cholesky",
            "isopeel.matrix.simd_kernels",
        ),
        _plain_newton,
        "a tangent and a factor for each correction",
    ),
    Method(
        "L-BFGS pairs",
        ("isopeel.solve.lbfgs",),
        _no_pairs,
        "the chord tangent alone",
        compiles=True,
    ),
    Method(
        "all predictors but one",
        (
            "isopeel.solve.translation_predictor",
            "isopeel.solve.predictor_selection",
            "isopeel.solve.extrapolation",
            "isopeel.solve.period",
            "isopeel.solve.polynomials",
        ),
        _fixed_polynomial(4),
        "the cubic through four states",
    ),
    Method(
        "translation predictor",
        (
            "isopeel.solve.translation_predictor",
            "isopeel.solve.period",
            "isopeel.solve.polynomials:interpolate",
            "isopeel.solve.polynomials:nearest_nodes",
            "isopeel.solve.predictor_selection:_jumps",
        ),
        _no_translation,
        "polynomials alone",
        extra_lines=30,  # in `set_weights` and `select_predictor`
    ),
    Method(
        "energy as path measure",
        (),
        _no_energy_measure,
        "polynomials of the parameter, and translation",
        extra_lines=8,  # in `select_predictor`, `Predictor` and `AcceptedState`
    ),
    Method(
        "skipped last evaluation",
        (),
        _every_evaluation,
        "forces after each correction",
        extra_lines=8,  # in `corrected` and `QuasiNewton.equilibrium`
    ),
    Method(
        "single-precision factor",
        ("isopeel.matrix.mixed_precision",),
        _double_precision,
        "double precision",
    ),
    Method(
        "SIMD kernels",
        ("isopeel.matrix.simd_kernels",),
        _plain_loops,
        "the same loops, left to the compiler",
        compiles=True,
    ),
    Method(
        "reach of each block",
        ("isopeel.matrix.cholesky:_find_reach",),
        _full_reach,
        "the whole half-bandwidth",
    ),
    Method(
        "equal rectangles",
        (
            "isopeel.assembly.body_kernel:_deform_rectangles",
            "isopeel.assembly.body_kernel:_load_rectangles",
            "isopeel.assembly.body_tangent:add_rectangles_to_pairs",
            "isopeel.assembly.tables:_of_rectangles",
        ),
        _no_rectangles,
        "any quadrilaterals",
        extra_lines=12,  # in `add_body` and the tables
    ),
    Method(
        "stored prescribed motion",
        (),
        _no_stored_motion,
        "computed at each call",
        extra_lines=10,
    ),
    Method(
        "reordered sums",
        (),
        _sums_in_order,
        "sums in the order of the code",
        compiles=True,
        extra_lines=6,
    ),
)
