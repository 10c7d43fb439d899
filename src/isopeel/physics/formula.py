"""User-written formulas: a parser that admits formulas only, and their translation to functions.

The text never reaches `eval`: Python's parser turns it into a tree, and only numbers, known names, the four
operations, powers and the functions in `FUNCTIONS` are translated to a SymPy expression. SymPy is
loaded only if there is a formula, as loading takes a second.
"""

import ast
import math
import operator
import re
from collections.abc import Callable, Iterable, Mapping
from keyword import iskeyword
from typing import TYPE_CHECKING, Any

import numpy as np

from isopeel.common.errors import InputError
from isopeel.physics.formula_size import VARIABLE, size_of

if TYPE_CHECKING:
    import sympy

#: Functions a formula may use.
FUNCTIONS = ("exp", "log", "sqrt", "sin", "cos", "tan", "atan", "sinh", "cosh", "tanh")
_OPERATIONS: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}
#: Most characters of a formula: far more than any law of the literature has, and parsed at once.
LONGEST = 2000
#: Most parts of a second derivative: a thousand of them take some seconds to derive and to compile.
_LARGEST = 2000
_MOST_CONSTANTS = 50
#: What varies in a formula.
_VARIABLES = dict.fromkeys(("r", "x", "I1", "I2", "J"), VARIABLE)
#: NumPy has had `atan` only since version 2.
_NAMESPACE = {name: getattr(np, {"atan": "arctan"}.get(name, name)) for name in (*FUNCTIONS, "pi", "nan")}


def parse_formula(field: str, text: str, names: tuple[str, ...]) -> "sympy.Expr":
    """Translate a formula of the given variable names to SymPy; InputError on anything that is not one."""
    import sympy

    if len(text) > LONGEST:
        raise InputError(field, text[:40] + "...", f"a formula has at most {LONGEST} characters")
    allowed = (
        f"a formula uses numbers, + - * / **, the names {', '.join([*names, 'pi'])} and the functions "
        f"{', '.join(FUNCTIONS)}"
    )
    try:
        tree = ast.parse(text.strip(), mode="eval").body
        size = size_of(tree, _VARIABLES).second
        if size > _LARGEST:
            allowed = f"its second derivative has about {size} parts, and {_LARGEST} are allowed"
            raise ValueError("too large")
        expression = _translate(tree, {name: sympy.Symbol(name, real=True) for name in names})
    except (SyntaxError, ValueError, TypeError, ArithmeticError, RecursionError, MemoryError) as error:
        raise InputError(field, text, allowed) from error
    if expression.has(sympy.zoo, sympy.nan, sympy.oo, -sympy.oo) or expression.has(sympy.I):
        raise InputError(field, text, "a formula must have finite real numbers")
    return expression


def _translate(node: ast.expr, symbols: "Mapping[str, sympy.Symbol]") -> "sympy.Expr":
    import sympy

    match node:
        case ast.Constant(value=bool()):
            raise ValueError("not a number")
        case ast.Constant(value=int() as value):
            # large whole numbers as floats: exact arithmetic with them could take forever
            return sympy.Integer(value) if abs(value) <= 1000 else sympy.Float(value)
        case ast.Constant(value=float() as value):
            return sympy.Float(value)
        case ast.Name(id="pi"):
            return sympy.pi
        case ast.Name(id=name) if name in symbols:
            return symbols[name]
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_translate(operand, symbols)
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return _translate(operand, symbols)
        case ast.BinOp(left=left, op=ast.Pow(), right=right):
            base, exponent = _translate(left, symbols), _translate(right, symbols)
            if base.is_number and exponent.is_number:
                return sympy.Float(float(base) ** float(exponent))
            return base**exponent
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATIONS:
            combine = _OPERATIONS[type(op)]
            return combine(_translate(left, symbols), _translate(right, symbols))
        case ast.Call(func=ast.Name(id=name), args=[argument], keywords=[]) if name in FUNCTIONS:
            inner = _translate(argument, symbols)
            # exactly, or to many digits, a number of a number could take forever
            return sympy.Float(getattr(math, name)(inner)) if inner.is_number else getattr(sympy, name)(inner)
    raise ValueError(f"{type(node).__name__} is not part of a formula")


def check_constants(field: str, constants: Mapping[str, float], reserved: tuple[str, ...]) -> None:
    """Raise InputError unless each of not too many constants has a usable name and a finite value."""
    if len(constants) > _MOST_CONSTANTS:
        raise InputError(field, f"{len(constants)} constants", f"at most {_MOST_CONSTANTS} are allowed")
    for name, value in constants.items():
        usable = re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) and not iskeyword(name)
        if not usable or name in (*reserved, *FUNCTIONS, "pi"):
            raise InputError(field, name, f"a constant needs a name of its own, not {', '.join(reserved)}")
        if not np.isfinite(value):
            raise InputError(f"{field}.{name}", value, "it must be finite")


def check_used(field: str, constants: Mapping[str, float], text: str) -> None:
    """Raise InputError where a formula, which has been parsed before, does not use one of the constants."""
    used = {node.id for node in ast.walk(ast.parse(text.strip(), mode="eval")) if isinstance(node, ast.Name)}
    for name, value in constants.items():
        if name not in used:
            allowed = "the formula does not use it; leave it out, or correct the formula"
            raise InputError(f"{field}.{name}", value, allowed)


def check_smooth(field: str, text: str, expressions: "Iterable[sympy.Expr]") -> None:
    """Raise InputError where derivatives of a formula have jumps, or functions that a formula has not."""
    import sympy

    for expression in expressions:
        functions = {type(part).__name__ for part in expression.atoms(sympy.Function)}
        if functions - set(FUNCTIONS) or expression.has(sympy.zoo, sympy.nan, sympy.I):
            raise InputError(field, text, "its second derivatives must be smooth, without jumps")


def point_function(
    inputs: Mapping[str, str],
    constants: tuple[str, ...],
    results: "Iterable[sympy.Expr]",
    guard: str | None = None,
) -> Callable[..., Any]:
    """Write formulas at one point as a function that returns their results, or the result of the only one.

    `inputs` maps names of variables to those of its first arguments; the others are the constants. Where
    `guard`, a condition on the arguments, does not hold, the results are nan.
    """
    import sympy

    expressions = list(results)
    # the user's names get a prefix, so that they cannot meet those of the function itself
    private = {symbol: sympy.Symbol(f"user_{symbol}") for e in expressions for symbol in e.free_symbols}
    shared, reduced = sympy.cse([e.xreplace(private) for e in expressions], sympy.numbered_symbols("shared_"))
    lines = [f"def formulas({', '.join([*inputs.values(), *(f'user_{name}' for name in constants)])}):"]
    if guard is not None:
        lines += [f"    if not ({guard}):", f"        return {', '.join(['nan'] * len(expressions))}"]
    lines += [f"    user_{name} = {argument}" for name, argument in inputs.items()]
    lines += [f"    {symbol} = {_code(expression)}" for symbol, expression in shared]
    lines += [f"    return {', '.join(map(_code, reduced))}"]
    namespace = dict(_NAMESPACE)
    exec("\n".join(lines), namespace)
    function: Callable[..., Any] = namespace["formulas"]
    return function


def _code(expression: "sympy.Expr") -> str:
    import sympy
    from sympy.printing.pycode import pycode

    # floats throughout: a whole number would give the array entry of an integer type
    text: str = pycode(sympy.N(expression, 17), fully_qualified_modules=False)
    return text
