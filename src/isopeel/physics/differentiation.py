"""First and second derivatives of a formula, by forward differentiation.

The formula is a Python function of numbers. A `Jet` in the place of a number has a value and its derivatives
with respect to some variables, and computes those of sums, products and functions by the rules for these.
The value is a float, an array, or a `Term`, which writes the code of what is computed.
"""

from collections.abc import Callable, Mapping
from itertools import combinations_with_replacement
from typing import Any, TypeAlias

import numpy as np

#: A float, an array or a `Term`.
Scalar: TypeAlias = Any

#: The functions of NumPy that a formula may use, each with f'(x) and f''(x) as a function of x and y = f(x).
FUNCTIONS: dict[str, Callable[[Scalar, Scalar], tuple[Scalar, Scalar]]] = {
    "exp": lambda _x, y: (y, y),
    "log": lambda x, _y: (1.0 / x, -1.0 / (x * x)),
    "sqrt": lambda x, y: (0.5 / y, -0.25 / (x * y)),
    "sin": lambda x, y: (np.cos(x), -y),
    "cos": lambda x, y: (-np.sin(x), -y),
    "tan": lambda _x, y: (1.0 + y * y, 2.0 * y * (1.0 + y * y)),
    "arctan": lambda x, _y: (1.0 / (1.0 + x * x), -2.0 * x / (1.0 + x * x) ** 2),
    "sinh": lambda x, y: (np.cosh(x), y),
    "cosh": lambda x, y: (np.sinh(x), y),
    "tanh": lambda _x, y: (1.0 - y * y, -2.0 * y * (1.0 - y * y)),
}


class _Differentiated:
    """A formula is called once for all numbers, so it must not compare them."""

    def __bool__(self) -> bool:
        raise TypeError("a formula that is differentiated must not compare numbers: it has one form for all")

    def __eq__(self, _other: object) -> bool:
        return bool(self)

    def __hash__(self) -> int:
        return id(self)


class Jet(_Differentiated):
    """A number and its derivatives, by variables i and by pairs i <= j of them; those not given are zero."""

    def __init__(
        self,
        value: Scalar,
        first: Mapping[int, Scalar] | None = None,
        second: Mapping[tuple[int, int], Scalar] | None = None,
    ) -> None:
        self.value, self.first, self.second = value, first or {}, second or {}

    def __add__(self, other: Any) -> Any:
        if not isinstance(other, Jet):
            return Jet(self.value + other, self.first, self.second)
        first, second = _sum(self.first, other.first), _sum(self.second, other.second)
        return Jet(self.value + other.value, first, second)

    def __mul__(self, other: Any) -> Any:
        if not isinstance(other, Jet):
            first, second = _scaled(self.first, other), _scaled(self.second, other)
            return Jet(self.value * other, first, second)
        u, v = self.value, other.value
        first = _sum(_scaled(self.first, v), _scaled(other.first, u))
        second = _sum(_scaled(self.second, v), _scaled(other.second, u), _mixed(self.first, other.first))
        return Jet(u * v, first, second)

    def __pow__(self, exponent: Any) -> Any:
        if isinstance(exponent, Jet):
            return np.exp(np.log(self) * exponent)
        x = self.value
        if isinstance(exponent, int | float) and exponent in (1, 2):
            return self * self if exponent == 2 else self
        # one power for all three: it exists at x = 0 for exponents from 2 on
        power = x ** (exponent - 2)
        slope = exponent * power * x
        return self._chain(power * x * x, slope, exponent * (exponent - 1) * power)

    def __rpow__(self, base: Any) -> Any:
        return np.exp(self * np.log(base))

    def __rtruediv__(self, other: Any) -> Any:
        inverse = 1.0 / self.value
        square = inverse * inverse
        return self._chain(inverse, -square, 2.0 * square * inverse) * other

    def __truediv__(self, other: Any) -> Any:
        return self * (1.0 / other)

    def __neg__(self) -> Any:
        return self * -1.0

    def __sub__(self, other: Any) -> Any:
        return self + -other

    def __rsub__(self, other: Any) -> Any:
        return -self + other

    __radd__, __rmul__ = __add__, __mul__

    def __getattr__(self, name: str) -> Any:
        """Return what NumPy calls for its function of that name: `np.log(jet)` is `jet.log()`."""
        if name not in FUNCTIONS:
            raise AttributeError(name)
        value = getattr(np, name)(self.value)
        slope, curvature = FUNCTIONS[name](self.value, value)
        return lambda: self._chain(value, slope, curvature)

    def _chain(self, value: Scalar, slope: Scalar, curvature: Scalar) -> "Jet":
        """Return a function of this number, from its value and derivatives."""
        pairs = combinations_with_replacement(sorted(self.first.items()), 2)
        bent = {(i, j): curvature * x * y for (i, x), (j, y) in pairs}
        return Jet(value, _scaled(self.first, slope), _sum(_scaled(self.second, slope), bent))


class Term(_Differentiated):
    """A number of the code in `lines`: each operation adds a line, unless the code has it already."""

    def __init__(self, name: str, lines: dict[str, str]) -> None:
        self.name, self.lines = name, lines

    def __repr__(self) -> str:
        return self.name

    def __add__(self, other: Any) -> Any:
        return self._binary("{0!r} + {1!r}", other)

    def __radd__(self, other: Any) -> Any:
        return self._binary("{1!r} + {0!r}", other)

    def __sub__(self, other: Any) -> Any:
        return self._binary("{0!r} - {1!r}", other)

    def __rsub__(self, other: Any) -> Any:
        return self._binary("{1!r} - {0!r}", other)

    def __mul__(self, other: Any) -> Any:
        return self._binary("{0!r} * {1!r}", other)

    def __rmul__(self, other: Any) -> Any:
        return self._binary("{1!r} * {0!r}", other)

    def __truediv__(self, other: Any) -> Any:
        return self._binary("{0!r} / {1!r}", other)

    def __rtruediv__(self, other: Any) -> Any:
        return self._binary("{1!r} / {0!r}", other)

    def __pow__(self, other: Any) -> Any:
        return self._binary("{0!r} ** {1!r}", other)

    def __neg__(self) -> Any:
        return self._line(f"-{self}")

    def __getattr__(self, name: str) -> Any:
        """Return what NumPy calls for its function of that name."""
        if name not in FUNCTIONS:
            raise AttributeError(name)
        return lambda: self._line(f"{name}({self})")

    def _binary(self, text: str, other: Any) -> Any:
        if isinstance(other, Jet):
            return NotImplemented
        return self._line(text.format(self, other.item() if isinstance(other, np.generic) else other))

    def _line(self, text: str) -> "Term":
        return Term(self.lines.setdefault(text, f"t{len(self.lines)}"), self.lines)


def _scaled(values: Mapping[Any, Scalar], factor: Scalar) -> dict[Any, Scalar]:
    return {key: value * factor for key, value in values.items()}


def _sum(*parts: Mapping[Any, Scalar]) -> dict[Any, Scalar]:
    total: dict[Any, Scalar] = {}
    for part in parts:
        for key, value in part.items():
            total[key] = total[key] + value if key in total else value
    return total


def _mixed(one: Mapping[int, Scalar], other: Mapping[int, Scalar]) -> dict[tuple[int, int], Scalar]:
    """Return the sum of one_i other_j and one_j other_i for i <= j."""
    products = [{(i, j): x * y} for i, x in one.items() for j, y in other.items()]
    swapped = [{(j, i): value} for product in products for (i, j), value in product.items()]
    ordered = [{ij: v} for product in [*products, *swapped] for ij, v in product.items() if ij[0] <= ij[1]]
    return _sum(*ordered)
