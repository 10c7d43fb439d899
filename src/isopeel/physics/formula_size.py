"""How large a formula and its derivatives are, before any of them is made."""

import ast
from collections.abc import Mapping
from typing import NamedTuple


class Size(NamedTuple):
    """About how many parts an expression, its derivative and its second one have; zero where they vanish."""

    value: int
    first: int = 0
    second: int = 0


_NUMBER = Size(1)
VARIABLE = Size(1, 1)


def size_of(node: ast.expr, names: Mapping[str, Size]) -> Size:
    """Estimate the size of a formula from those of the names in it; constants may be left out."""
    match node:
        case ast.Name(id=name):
            return names.get(name, _NUMBER)
        case ast.UnaryOp(operand=operand):
            return size_of(operand, names)
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub(), right=right):
            return Size(*map(sum, zip(size_of(left, names), size_of(right, names), strict=True)))
        case ast.BinOp(left=left, op=ast.Pow(), right=right):
            base, exponent = size_of(left, names), size_of(right, names)
            # a**b = exp(b log(a))
            return _function(_product(_function(base), exponent) if exponent.first else base)
        case ast.BinOp(left=left, right=right):
            return _product(size_of(left, names), size_of(right, names))
        case ast.Call(args=[argument]):
            return _function(size_of(argument, names))
    return _NUMBER


def _product(a: Size, b: Size) -> Size:
    first = (a.first and a.first + b.value) + (b.first and a.value + b.first)
    mixed = 2 * (a.first + b.first) if a.first and b.first else 0
    second = (a.second and a.second + b.value) + mixed + (b.second and a.value + b.second)
    return Size(a.value + b.value, first, second)


def _function(a: Size) -> Size:
    first = a.first and a.value + a.first + 1
    second = (a.first and a.value + 2 * a.first + 1) + (a.second and a.value + a.second + 1)
    return Size(a.value + 1, first, second)
