"""The dimensions that the constants of a formula must have, from those of its variables and its result.

A dimension is stress^a length^b. In a formula the terms of a sum have the same one, arguments of functions
and exponents are numbers, and a power multiplies exponents. So each rule is a linear equation in the
exponents of the constants, with rational coefficients, and the equations are solved exactly. Numbers that are
written in a formula have no dimension, but for zero, which has any.
"""

import ast
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple, TypeAlias

from isopeel.common.errors import InputError
from isopeel.common.quantities import (
    ENERGY,
    FORCE_PER_WIDTH,
    LENGTH,
    NUMBER,
    STRESS,
    SURFACE_ENERGY,
    Dimension,
)
from isopeel.physics.formula import LONGEST

#: Exponents of a stress and a length.
Powers: TypeAlias = tuple[Fraction, Fraction]

_NONE: Powers = (Fraction(0), Fraction(0))
_KNOWN: dict[tuple[Fraction | int, Fraction | int], Dimension] = {
    (d.stress, d.length): d for d in (FORCE_PER_WIDTH, SURFACE_ENERGY, ENERGY, STRESS, LENGTH, NUMBER)
}
#: Exponents that are no whole numbers are those of fractions with denominators up to this one, such as 1/3.
_LARGEST_DENOMINATOR = 1000
_LARGEST_EXPONENT = 1000


@dataclass(frozen=True)
class FormulaDimensions:
    """The field that holds a formula, the dimension of its value and those of its variables."""

    field: str
    result: Dimension
    variables: Mapping[str, Dimension]


class _Form(NamedTuple):
    """A dimension that depends on those of constants: their powers, and what is known."""

    of: Mapping[str, Fraction]
    known: Powers

    def times(self, power: Fraction) -> "_Form":
        """The dimension of a power."""
        of = {name: power * own for name, own in self.of.items() if power}
        return _Form(of, (power * self.known[0], power * self.known[1]))

    def plus(self, other: "_Form") -> "_Form":
        """The dimension of a product."""
        of = {n: self.of.get(n, Fraction(0)) + other.of.get(n, Fraction(0)) for n in {**self.of, **other.of}}
        known = (self.known[0] + other.known[0], self.known[1] + other.known[1])
        return _Form({name: power for name, power in of.items() if power}, known)

    def minus(self, other: "_Form") -> "_Form":
        """The dimension of a quotient."""
        return self.plus(other.times(Fraction(-1)))


class _Rule(NamedTuple):
    """A form that must have no dimension, the part of the formula that requires this, and the error else."""

    form: _Form
    place: ast.expr
    wrong: str

    @property
    def message(self) -> str:
        """The error, with the part of the formula."""
        try:
            place = ast.unparse(self.place)
        except RecursionError:
            place = "a part of it"
        return f"{_short(place)} {self.wrong}"


_A_NUMBER = _Form({}, _NONE)


class _NoFormulaError(ValueError):
    """A text that is no formula: its parser reports it."""


def check_dimensions(
    table: str,
    dimensions: FormulaDimensions,
    text: str,
    constants: Mapping[str, tuple[float, Powers]],
) -> None:
    """Check the dimensions of a formula with constants, each a value and its powers of stress and length.

    Raises InputError that names a constant, TABLE.constants.NAME, and the dimension that it needs, or the
    part of the formula that cannot have one. A text that is no formula passes: its parser reports more.
    """
    try:
        rules = _rules(text, dimensions, constants)
    except (_NoFormulaError, SyntaxError, ValueError, ArithmeticError, RecursionError, MemoryError):
        return
    solver = _Solver([], {})
    for rule in rules:
        if not solver.add(rule.form):
            allowed = (
                f"{rule.message}, whatever its constants; numbers with a dimension must be constants with a "
                "unit, or the result would depend on [units]"
            )
            raise InputError(f"{table}.{dimensions.field}", text, allowed)
    given = {name: powers for name, (_, powers) in constants.items()}
    wrong = _wrong_constant(solver.equations, given)
    if wrong is not None:
        name, needed = wrong
        allowed = f"in {dimensions.field} = {_short(text)} {needed_for(needed)}"
        raise InputError(f"{table}.constants.{name}", constants[name][0], allowed)


def needed_for(powers: Powers) -> str:
    """Say that a dimension is needed, with an example."""
    stress, length = powers
    if (stress, length) in _KNOWN:
        return _KNOWN[stress, length].needed
    unit = " ".join(name + _exponent(power) for name, power in (("Pa", stress), ("m", length)) if power)
    return f"a quantity in {unit} is needed, such as '1 {unit}'"


def _exponent(power: Fraction) -> str:
    if power == 1:
        return ""
    return f"^{power}" if power.denominator == 1 else f"^({power})"


def _rules(
    text: str, dimensions: FormulaDimensions, constants: Mapping[str, tuple[float, Powers]]
) -> list[_Rule]:
    if len(text) > LONGEST:
        raise _NoFormulaError
    tree = ast.parse(text.strip(), mode="eval").body
    variables = {name: (Fraction(d.stress), Fraction(d.length)) for name, d in dimensions.variables.items()}
    if set(variables) & set(constants):
        raise _NoFormulaError
    walk = _Walk(variables, {name: value for name, (value, _) in constants.items()}, [])
    form = walk.form(tree)
    result = dimensions.result
    wanted = _Form({}, (Fraction(result.stress), Fraction(result.length)))
    kind = result.needed.partition(" is needed")[0]
    return [*walk.rules, _Rule(form.minus(wanted), tree, f"is not {kind}")]


class _Walk(NamedTuple):
    """A walk through the tree of a formula, which gathers its rules."""

    variables: Mapping[str, Powers]
    values: Mapping[str, float]
    rules: list[_Rule]

    def form(self, node: ast.expr) -> _Form:
        """The dimension of a part of the formula."""
        match node:
            case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
                # zero may have any dimension, a number of its own
                return (
                    _A_NUMBER
                    if value
                    else _Form({f"0 at {node.lineno}:{node.col_offset}": Fraction(1)}, _NONE)
                )
            case ast.Name(id="pi"):
                return _A_NUMBER
            case ast.Name(id=name) if name in self.variables:
                return _Form({}, self.variables[name])
            case ast.Name(id=name) if name in self.values:
                return _Form({name: Fraction(1)}, _NONE)
            case ast.UnaryOp(op=ast.USub() | ast.UAdd(), operand=operand):
                return self.form(operand)
            case ast.BinOp(left=left, op=ast.Add() | ast.Sub(), right=right):
                one, other = self.form(left), self.form(right)
                self.rules.append(_Rule(one.minus(other), node, "adds different dimensions"))
                # zero takes the dimension of what it is added to
                return other if any(name[:1] == "0" for name in one.of) else one
            case ast.BinOp(left=left, op=ast.Mult(), right=right):
                return self.form(left).plus(self.form(right))
            case ast.BinOp(left=left, op=ast.Div(), right=right):
                return self.form(left).minus(self.form(right))
            case ast.BinOp(left=left, op=ast.Pow(), right=right):
                return self._power(left, right)
            case ast.Call(func=ast.Name(id="sqrt"), args=[argument], keywords=[]):
                return self.form(argument).times(Fraction(1, 2))
            case ast.Call(func=ast.Name(), args=[argument], keywords=[]):
                wrong = "is the argument of a function, and not a number"
                self.rules.append(_Rule(self.form(argument), argument, wrong))
                return _A_NUMBER
        raise _NoFormulaError

    def _power(self, base: ast.expr, exponent: ast.expr) -> _Form:
        form = self.form(base)
        self.rules.append(_Rule(self.form(exponent), exponent, "is an exponent, and not a number"))
        value = self._value(exponent)
        if value is None:
            self.rules.append(_Rule(form, base, "is raised to a power that varies, and not a number"))
            return _A_NUMBER
        if not abs(value) <= _LARGEST_EXPONENT:
            raise _NoFormulaError
        return form.times(Fraction(value).limit_denominator(_LARGEST_DENOMINATOR))

    def _value(self, node: ast.expr) -> float | None:
        """The value of a part without variables, in floats, so that none takes long; None where it varies."""
        match node:
            case ast.Constant(value=int() | float() as value):
                return float(value)
            case ast.Name(id=name) if name in self.values:
                return self.values[name]
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                inner = self._value(operand)
                return None if inner is None else -inner
            case ast.BinOp(left=left, op=op, right=right):
                one, other = self._value(left), self._value(right)
                if one is None or other is None:
                    return None
                match op:
                    case ast.Add():
                        return one + other
                    case ast.Sub():
                        return one - other
                    case ast.Mult():
                        return one * other
                    case ast.Div():
                        return one / other
                    case ast.Pow():
                        power = one**other
                        return power if isinstance(power, float) else None
        return None


def _short(text: str) -> str:
    return repr(text if len(text) <= 60 else f"{text[:57]}...")


class _Solver(NamedTuple):
    """Equations in the dimensions of constants, each solved for one of them, by Gauss's elimination."""

    equations: list[_Form]
    pivots: dict[str, int]

    def add(self, form: _Form) -> bool:
        """Add that a form has no dimension; return whether that agrees with the equations so far."""
        while (name := next((name for name in form.of if name in self.pivots), None)) is not None:
            form = form.minus(self.equations[self.pivots[name]].times(form.of[name]))
        if not form.of:
            return not any(form.known)
        name = next(iter(form.of))
        self.pivots[name] = len(self.equations)
        self.equations.append(form.times(1 / form.of[name]))
        return True

    def solved(self) -> dict[str, Powers]:
        """The dimensions of the constants that have to have one."""
        found: dict[str, Powers] = {}
        # from the last equation back, in which only those solved after it, or free ones, are left
        for name, number in reversed(self.pivots.items()):
            form = self.equations[number]
            for other in set(form.of) & set(found):
                stress, length = found[other]
                factor = form.of[other]
                form = form.minus(_Form({other: factor}, _NONE)).plus(
                    _Form({}, (factor * stress, factor * length))
                )
            if set(form.of) == {name}:
                found[name] = (-form.known[0], -form.known[1])
        return found


def _solution(equations: Sequence[_Form], given: Mapping[str, Powers]) -> dict[str, Powers] | None:
    """The dimensions of constants that are not given; None where those that are given contradict."""
    solver = _Solver([], {})
    for form in equations:
        for name in set(form.of) & set(given):
            factor, (stress, length) = form.of[name], given[name]
            known = _Form({}, (factor * stress, factor * length))
            form = form.minus(_Form({name: factor}, _NONE)).plus(known)
        if not solver.add(form):
            return None
    return solver.solved()


def _wrong_constant(equations: Sequence[_Form], given: Mapping[str, Powers]) -> tuple[str, Powers] | None:
    """A constant that is given in a wrong dimension, and the one that it needs; None where all are right."""
    if _solution(equations, given) is not None:
        return None
    # one alone; of several, one that has a unit, which is more likely meant than a number without one
    for name in sorted(given, key=lambda name: given[name] == _NONE):
        others = {other: powers for other, powers in given.items() if other != name}
        needed = (_solution(equations, others) or {}).get(name)
        if needed is not None:
            return name, needed
    solved = _solution(equations, {}) or {}
    for name, powers in given.items():
        if solved.get(name, powers) != powers:
            return name, solved[name]
    # several that fit to each other in many ways: one that fits to those before it
    right: dict[str, Powers] = {}
    for name, powers in given.items():
        if _solution(equations, {**right, name: powers}) is None:
            return name, (_solution(equations, right) or {}).get(name, powers)
        right[name] = powers
    return None
