"""Forward differentiation against derivatives by SymPy, as numbers and as the code that is written."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import sympy

from isopeel.physics.differentiation import FUNCTIONS, Jet, Term

X, Y = 1.3, 0.7
#: Each a formula of two variables, for numbers and for symbols alike.
FORMULAS: dict[str, Callable[[Any, Any], Any]] = {
    "sum": lambda x, y: 2 + x - 3 * y - (5 - x) + -y,
    "product": lambda x, y: (x * y) * (x - y) * x,
    "quotient": lambda x, y: 1 / x + y / (x + 2 * y) + x / 3,
    "powers": lambda x, y: x**3 * y**2 + (x * y) ** -2 + (x + y) ** 0.25 + x**1,
    "power of a variable": lambda x, y: x**y + 2**x,
    "nested": lambda x, y: ((x * y) ** 2 + 1) ** 0.5 / (1 + x**4),
}


def by_sympy(formula: Callable[[Any, Any], Any]) -> list[float]:
    x, y = sympy.symbols("x y")
    f = formula(x, y)
    every = [f, f.diff(x), f.diff(y), f.diff(x, 2), f.diff(x, y), f.diff(y, 2)]
    return [float(one.subs({x: X, y: Y})) for one in every]


def parts(jet: Jet) -> list[Any]:
    first = [jet.first.get(i, 0.0) for i in (0, 1)]
    return [jet.value, *first, *(jet.second.get(ij, 0.0) for ij in ((0, 0), (0, 1), (1, 1)))]


@pytest.mark.parametrize("formula", FORMULAS.values(), ids=FORMULAS)
def test_derivatives_of_formulas_are_those_of_sympy(formula: Callable[[Any, Any], Any]) -> None:
    expected = by_sympy(formula)
    numbers = parts(formula(Jet(X, {0: 1.0}), Jet(Y, {1: 1.0})))
    # some ten operations
    np.testing.assert_allclose(numbers, expected, rtol=1e-13, atol=1e-14)
    lines: dict[str, str] = {}
    written = parts(formula(Jet(Term("x", lines), {0: 1.0}), Jet(Term("y", lines), {1: 1.0})))
    code = "\n".join(f"{name} = {text}" for text, name in lines.items())
    names: dict[str, Any] = {"x": X, "y": Y} | {name: getattr(np, name) for name in FUNCTIONS}
    exec(code, names)
    computed = [eval(repr(one), names) for one in written]
    np.testing.assert_allclose(computed, expected, rtol=1e-13, atol=1e-14)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_derivatives_of_functions_are_those_of_sympy(name: str) -> None:
    ours, theirs = getattr(np, name), getattr(sympy, {"arctan": "atan"}.get(name, name))
    numbers = parts(ours(Jet(X, {0: 1.0}) * Jet(Y, {1: 1.0})))
    np.testing.assert_allclose(numbers, by_sympy(lambda x, y: theirs(x * y)), rtol=1e-13)  # few operations


@pytest.mark.parametrize("exponent", [1, 1.0, 2, 2.0, 3, 2.5])
def test_powers_exist_at_zero(exponent: float) -> None:
    expected = [0.0, float(exponent == 1), 2.0 * (exponent == 2)]
    at_zero = Jet(0.0, {0: 1.0}) ** exponent
    assert [at_zero.value, at_zero.first[0], at_zero.second.get((0, 0), 0.0)] == expected


def test_a_derivative_that_vanishes_is_not_computed() -> None:
    lines: dict[str, str] = {}
    x, y = Jet(Term("x", lines), {0: 1.0}), Jet(Term("y", lines), {1: 1.0})
    assert set((x + 3 * y).second) == set()
    assert set((np.log(x) + y**2).second) == {(0, 0), (1, 1)}


def test_a_formula_must_not_compare_numbers() -> None:
    x = Jet(1.0, {0: 1.0})
    for compare in (lambda: x == 1.0, lambda: 1.0 if x else 0.0, lambda: Term("x", {}) == 0):
        with pytest.raises(TypeError, match="must not compare numbers"):
            compare()
    with pytest.raises(TypeError, match="not supported"):
        assert x > 0  # type: ignore[operator]
