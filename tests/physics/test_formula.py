"""The parser of user formulas: what it computes, and what it refuses."""

import ast
import math
from runpy import run_path

import numpy as np
import pytest
import sympy

from isopeel import InputError
from isopeel.physics import formula
from isopeel.physics.adhesion.formula import FormulaAdhesion
from isopeel.physics.formula import parse_formula
from isopeel.physics.formula_size import VARIABLE, size_of
from isopeel.physics.materials.formula import FormulaMaterial


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2*r**3 - 1", 15.0),
        ("-(r + 1)/4", -0.75),
        ("exp(-r) + log(r)*sqrt(r)", math.exp(-2) + math.log(2) * math.sqrt(2)),
        ("+tanh(r)*cos(pi*r)", math.tanh(2)),
        ("2**0.5*r", 2 * math.sqrt(2)),
        ("1e3*r", 2000.0),
    ],
)
def test_value(text: str, value: float) -> None:
    expression = parse_formula("law", text, ("r",))
    (symbol,) = expression.free_symbols
    assert float(expression.subs(symbol, 2)) == pytest.approx(value, rel=1e-14)  # round-off


@pytest.mark.parametrize(
    "text",
    [
        '__import__("os").system("x")',
        "().__class__.__bases__[0].__subclasses__()",
        "open('/etc/passwd').read()",
        "eval('r')",
        "exec('r')",
        "r.__class__",
        "lambda: r",
        "[r for r in (1, 2)]",
        "(r := 3)",
        "r if r else 1",
        "'a' * 1000000000",
        "exp(r, r)",
        "exp(*[r])",
        "getattr(r, 'x')",
        "r; r",
        "r\nimport os",
        "True",
        "1j*r",
        "x + r",
        "r and r",
        "r == 1",
        "r // 2",
        "r % 2",
        "exp",
        "",
        "1/0",
        "sqrt(-1)",
        "r +",
        "(" * 500 + "r" + ")" * 500,
        "factorial(10**9)",
        "Integral(r)",
        "Sum(r)",
        "Symbol('r')",
        "sympify('r')",
        "r.subs(r, 1)",
        "{r: r}",
        "{r}",
        "(r,)",
        "r[0]",
        "f'{r}'",
        "...",
        "None",
        "not r",
        "~r",
        "r @ r",
        "r << r",
        "r ^ 2",
        "r < 1",
        "await r",
        "(yield r)",
        "__builtins__",
        "exp.__globals__",
        "exp(r, evaluate=False)",
        "print(r)",
        "#",
        "r\x00",
    ],
)
def test_anything_but_a_formula_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="law"):
        parse_formula("law", text, ("r",))


HUGE = [
    "9**9**9**9*r",
    "r + 99999999999999999999**999999",
    "r*" * 1100 + "r",
    "exp(exp(exp(exp(100))))*r",
    "exp(1e300)*r",
    "exp(" * 60 + "r" + ")" * 60,
    "sin(" * 30 + "r" + ")" * 30,
    "r**" * 90 + "r",
    "*".join(f"(r + {k})" for k in range(40)),
    "*".join(f"sin(r + {k})" for k in range(30)),
    "/".join(["(1 + r)"] * 100),
    "-" * 1500 + "r",
]


@pytest.mark.parametrize("text", HUGE)
def test_huge_formulas_end_at_once(text: str) -> None:
    with pytest.raises(InputError, match="law"):
        parse_formula("law", text, ("r",))


@pytest.mark.parametrize("text", ["I1**I1**I1**I1", "exp(exp(exp(I1)))", "exp(W*exp(W*exp(W*I1)))"])
def test_numbers_that_overflow_are_refused(text: str) -> None:
    """Where a formula is evaluated: as NumPy does, and not with as many digits as the number has."""
    with pytest.raises(InputError, match=r"material\.energy"):
        FormulaMaterial(text, {"W": 1e300})
    with pytest.raises(InputError, match=r"adhesion\.potential"):
        FormulaAdhesion(text.replace("I1", "r"), {"W": 1e300})


def test_many_constants_are_refused() -> None:
    with pytest.raises(InputError, match="at most 50"):
        FormulaAdhesion("r", {f"c{k}": 1.0 for k in range(51)})


def test_the_size_of_a_second_derivative_is_of_the_order_of_what_sympy_finds() -> None:
    r = sympy.Symbol("r", real=True)
    for text in (
        "r**2*exp(r)",
        "sin(r)*cos(r)*log(r)",
        "*".join(f"(r + {k})" for k in range(9)),
        "exp(exp(exp(r)))",
    ):
        expression = parse_formula("law", text, ("r",))
        found = sum(1 for _ in sympy.preorder_traversal(expression.diff(r, 2)))
        estimate = size_of(ast.parse(text, mode="eval").body, {"r": VARIABLE}).second
        # a rough count of parts, for a limit that is rough too
        assert found / 4 < estimate < 4 * found


def test_it_can_be_loaded_with_the_oldest_numpy(monkeypatch: pytest.MonkeyPatch) -> None:
    """NumPy 1.26 has no `atan`."""
    monkeypatch.delattr(np, "atan")
    assert run_path(formula.__file__)["_NAMESPACE"]["atan"](1.0) == math.pi / 4
