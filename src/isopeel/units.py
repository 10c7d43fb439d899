"""Quantities with units, as text, and their values in the internal units L0 and E0."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import isfinite
from typing import Any

import pint

#: Length that lengths are measured in if not told otherwise, 1 nm, in metres.
L0 = Fraction(1, 10**9)
#: Stress that stresses are measured in if not told otherwise, 2 GPa, in pascals.
E0 = Fraction(2 * 10**9)


@dataclass(frozen=True)
class UnitSystem:
    """What lengths and stresses are measured in, in metres and in pascals, exactly."""

    length: Fraction = L0
    stress: Fraction = E0


_USUAL = UnitSystem()
_MEASURED_IN = ContextVar("_MEASURED_IN", default=_USUAL)


@contextmanager
def measured_in(units: UnitSystem) -> Iterator[None]:
    """Read quantities in these units while the context is open."""
    token = _MEASURED_IN.set(units)
    try:
        yield
    finally:
        _MEASURED_IN.reset(token)


_NUMBER = r"[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{1,3})?|inf|nan)"
_FACTOR = r"(?:[^\W\d_]+(?:(?:\^|\*\*)?-?[1-9]|[²³])?|°)"
_QUANTITY = re.compile(rf"({_NUMBER})\s*({_FACTOR}(?:(?:\s*[*/]\s*|\s+){_FACTOR})*)?")
_LONGEST = 100  # characters


@dataclass(frozen=True)
class Quantity:
    """A value in E0^stress L0^length or, if `angle`, in degrees; `exact` is the same in SI units."""

    value: float
    stress: Fraction
    length: Fraction
    angle: bool = False
    exact: Fraction = Fraction(0)


def parse_quantity(text: str) -> Quantity:
    """Read a number and a unit, such as "2 GPa", "0.03 J/m^2" or "0.1 deg".

    Mass^a length^b time^c is a power product of stresses and lengths where c = -2 a: it is
    stress^a length^(a + b). The conversion is exact until the value is rounded to a float, so that
    "200 nm" is 200.0 to the last bit. L0 and E0 are 1 nm and 2 GPa unless `measured_in` other units. Raises
    ValueError that says why a text is no such quantity.
    """
    written = _QUANTITY.fullmatch(text.strip()) if len(text) <= _LONGEST else None
    if written is None:
        raise ValueError("it is not a number and a unit")
    number, unit = written.groups()
    if unit is None:
        raise ValueError("it has no unit")
    if not isfinite(float(number)):
        raise ValueError("it is not finite")
    registry = _registry()
    try:
        units = registry.parse_units(unit)
        factor, base = registry.get_base_units(units)
    except pint.UndefinedUnitError as error:
        raise ValueError(f"{unit!r} is not a known unit") from error
    parts = _parts(units)
    # radians have no dimension, so that an angle would pass unseen in a product
    if len(parts) > 1 and any("radian" in _parts(registry.get_base_units(part)[1]) for part in parts):
        raise ValueError(f"{unit!r} mixes an angle with other units")
    powers = {name: Fraction(power) for name, power in units.dimensionality.items()}
    mass, length, time = (powers.pop(f"[{name}]", Fraction(0)) for name in ("mass", "length", "time"))
    angle = base == registry.Unit("radian")
    # pure numbers need no unit, and some of their units, such as dB, are not even factors
    if powers or time != -2 * mass or not (angle or mass or length):
        raise ValueError(f"{unit!r} is not made of stresses and lengths, nor an angle")
    system = _MEASURED_IN.get()
    exact = Fraction(number) * factor
    internal = (
        registry.get_base_units("degree")[0]
        if angle
        else system.stress**mass * system.length ** (length + mass)
    )
    try:
        value = float(exact / internal)
    except OverflowError as error:
        raise ValueError("it is not finite") from error
    return Quantity(value, mass, length + mass, angle, exact)


#: SI units of a power product of a stress and a length, and how many of it in pascals and metres.
_SHOWN = {(1, 1): ("J/m^2", 1.0), (1, -1): ("GPa/nm", 1e18)}
_SINGLE = {(1, 0): "Pa", (0, 1): "m"}


def shown(value: float, units: UnitSystem, stress: int = 0, length: int = 0) -> str:
    """Write a value in E0^stress L0^length, of these units, in SI units: a stress, a length or both."""
    si = value * float(units.stress) ** stress * float(units.length) ** length
    if (stress, length) in _SHOWN:
        name, size = _SHOWN[stress, length]
        return f"{si / size:.5g} {name}"
    compact = _registry().Quantity(si, _SINGLE[stress, length]).to_compact()
    return f"{compact.magnitude:.5g} {compact.units:~}"


def _parts(units: Any) -> dict[str, Any]:
    """Names of units in a product, and their powers."""
    return dict(_registry().Quantity(1, units).unit_items())


@cache
def _registry() -> Any:  # the types of pint's registry do not tell its kind of numbers
    return pint.UnitRegistry(non_int_type=Fraction)
