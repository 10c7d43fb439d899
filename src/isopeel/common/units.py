"""Quantities with units, as text, and their values in the internal units L0 and E0."""

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, lru_cache
from math import isfinite
from types import MappingProxyType
from typing import Any, NamedTuple

import pint

#: Default unit of length, 1 nm, in metres.
L0 = Fraction(1, 10**9)
#: Default unit of stress, 2 GPa, in pascals.
E0 = Fraction(2 * 10**9)


@dataclass(frozen=True)
class UnitSystem:
    """The units of length and stress, exactly, in metres and in pascals."""

    length: Fraction = L0
    stress: Fraction = E0


_USUAL = UnitSystem()
_MEASURED_IN: ContextVar[UnitSystem | None] = ContextVar("_MEASURED_IN", default=None)


@contextmanager
def measured_in(units: UnitSystem) -> Iterator[None]:
    """Read quantities in these units while the context is open."""
    token = _MEASURED_IN.set(units)
    try:
        yield
    finally:
        _MEASURED_IN.reset(token)


#: Only ASCII digits: a digit of another script would be read as a letter of an unknown unit.
_NUMBER = r"(?>[-+]?(?:(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]{1,3})?|inf|nan))"
#: The form 5 x 10^-3 of a number.
_POWER_OF_TEN = r"\s*[x×*·]\s*10\s*(?:\^|\*\*)\s*([-+]?[0-9]{1,3})"
_QUANTITY = re.compile(
    rf"({_NUMBER})(?:{_POWER_OF_TEN})?(?:(?<=[0-9.])|\s)\s*([^\s0-9.].*)|({_NUMBER})", re.DOTALL
)
#: A force per width of a tape, such as N/25 mm: the unit, and the number and unit of the width.
_PER_WIDTH = re.compile(
    r"(?P<unit>[^/]+)/\s*(?P<open>\()?(?P<width>[0-9]{1,4}(?:\.[0-9]{1,4})?)\s*(?P<of>[mc]m|in|inch)(?(open)\))"
)
_SPLIT_NUMBER = re.compile(r"([0-9.]+)\s+([eE][-+]?[0-9]+)(?![0-9])")
_LONGEST = 100  # characters

_SUPERSCRIPTS = str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻", "0123456789+-")
_SUPERSCRIPT_RUN = re.compile("[⁺⁻]?[⁰¹²³⁴⁵⁶⁷⁸⁹]+")
#: Other code points of the same signs: minus, angstrom, micro and points in the middle.
_SAME_SIGNS = str.maketrans(
    {"\u2212": "-", "\u212b": "\u00c5", "\u03bc": "\u00b5", "\u22c5": "\u00b7", "\u2219": "\u00b7"}
)
_POWER = r"[-+]?[0-9]+(?:\.[0-9]+|/[1-9](?=\)))?"
#: A name with its power, which follows ^ or ** or stands behind it as it is, or a sign between names.
_TOKEN = re.compile(
    rf"\s*(?:(?P<name>[^\W\d_]+|°)(?:\s*(?:\^|\*\*)\s*(?P<caret>{_POWER}|\({_POWER}\))|(?P<power>[-+]?[0-9]+))?"
    r"|(?P<sign>\*|·|\.|/|\(|\)))"
)
_HIGHEST_POWER = 9

_NOT_A_QUANTITY = "it is not a number and a unit"


@dataclass(frozen=True)
class Quantity:
    """A value in E0^stress L0^length or, if `angle`, in degrees; `exact` is the same in SI units."""

    value: float
    stress: Fraction
    length: Fraction
    angle: bool = False
    exact: Fraction = Fraction(0)


def parse_quantity(text: str) -> Quantity:
    """Read a number and a unit, such as "2 GPa", "0.03 J/m^2", "30 mJ m-2", "50 N·m⁻¹" or "0.1 deg".

    Units are multiplied by a space, a point or an asterisk, and divided by a solidus; powers follow ^ or **
    or stand behind the name, raised or not; those that are no whole numbers are ^0.5 or ^(1/2). What could be
    read in two ways, such as J/m nm, is refused. N/25 mm is a force per width of 25 millimetres.
    Mass^a length^b time^c is a power product of stresses and lengths where c = -2 a: it is
    stress^a length^(a + b). For whole powers the conversion is exact until the value is rounded to a float,
    so that "200 nm" is 200.0 to the last bit. L0 and E0 are 1 nm and 2 GPa unless `measured_in` other units.
    Raises ValueError with the reason if a text is no such quantity.
    """
    number, exponent, unit = _split(text)
    if not isfinite(float(number)):
        raise ValueError("it is not finite")
    powers, width = _powers_and_width(unit)
    factors = {name: _factor(name) for name in powers}
    angle = any(factor.radians for factor in factors.values())
    # radians have no dimension, so an angle in a product would not be detected
    if angle and [power * factors[name].radians for name, power in powers.items()] != [Fraction(1)]:
        raise ValueError(f"{unit!r} mixes an angle with other units")
    dimension: dict[str, Fraction] = {}
    for name, power in powers.items():
        for base, of_unit in factors[name].dimension.items():
            dimension[base] = dimension.get(base, Fraction(0)) + power * of_unit
    mass, length, time = (dimension.pop(base, Fraction(0)) for base in ("[mass]", "[length]", "[time]"))
    if any(dimension.values()) or time != -2 * mass or not (angle or mass or length):
        raise ValueError(_of_another_kind(unit))
    system = _MEASURED_IN.get() or _USUAL
    exact = Fraction(number) * Fraction(10) ** exponent / width
    try:
        for name, power in powers.items():
            exact *= _raised(factors[name].size, power)
        if angle:
            value = float(exact / _factor("degree").size)
        else:
            value = float(exact / (_raised(system.stress, mass) * _raised(system.length, length + mass)))
    except OverflowError as error:
        raise ValueError("it is not finite") from error
    return Quantity(value, mass, length + mass, angle, exact)


def unit_of(text: str) -> str:
    """Return the unit of a quantity, as it is written. Raises ValueError as `parse_quantity` does."""
    parse_quantity(text)
    return _split(text)[2]


def measured_as(text: str, unit: str) -> float:
    """Return a quantity in a unit of the same dimension. Raises ValueError with the reason if it has none."""
    quantity, one = parse_quantity(text), parse_quantity(f"1 {unit}")
    if (quantity.stress, quantity.length, quantity.angle) != (one.stress, one.length, one.angle):
        raise ValueError(f"it cannot be written in {unit!r}")
    return float(quantity.exact / one.exact)


def _split(text: str) -> tuple[str, int, str]:
    """Return the number, a power of ten that multiplies it, and the unit of a quantity."""
    if len(text) > _LONGEST:
        raise ValueError(_NOT_A_QUANTITY)
    plain = _SUPERSCRIPT_RUN.sub(lambda run: "^" + run[0].translate(_SUPERSCRIPTS), text.strip())
    plain = plain.translate(_SAME_SIGNS)
    apart = _SPLIT_NUMBER.match(plain.lstrip("+-"))
    if apart is not None:
        # e is also the charge of an electron
        raise ValueError(f"there is a space in its number; write {apart[1]}{apart[2]}")
    written = _QUANTITY.fullmatch(plain)
    if written is None:
        raise ValueError(_NOT_A_QUANTITY)
    number, exponent, unit, alone = written.groups()
    if alone is not None:
        raise ValueError("it has no unit")
    return number, int(exponent or 0), unit


def _powers_and_width(unit: str) -> tuple[Mapping[str, Fraction], Fraction]:
    """Return the powers of a product of units, and the number that divides it, such as 25 in N/25 mm."""
    per_width = _PER_WIDTH.fullmatch(unit)
    if per_width is None or not Fraction(per_width["width"]):
        return _powers(unit), Fraction(1)
    return _powers(f"{per_width['unit']}/{per_width['of']}"), Fraction(per_width["width"])


def _powers(unit: str) -> Mapping[str, Fraction]:
    """Return the powers of the names in a product of units. Raises ValueError if it cannot be read."""
    tokens, end = [], 0
    while end < len(unit):
        found = _TOKEN.match(unit, end)
        if found is None:
            raise ValueError(_NOT_A_QUANTITY)
        tokens.append(found)
        end = found.end()
    powers: dict[str, Fraction] = {}
    left = _product(tokens, 0, 1, powers)
    if left != len(tokens):
        raise ValueError(_NOT_A_QUANTITY)
    return powers


def _product(tokens: list[re.Match[str]], place: int, sign: int, powers: dict[str, Fraction]) -> int:
    """Add the powers of a product that begins at a place to others, and return the place behind it."""
    direction, divided, expected = sign, False, True
    while place < len(tokens):
        token = tokens[place]
        match token["sign"]:
            case ")":
                break
            case "*" | "·" | "." | "/" as between:
                if expected:
                    raise ValueError(_NOT_A_QUANTITY)
                expected, direction = True, -sign if between == "/" else sign
                if between != "/" and divided:
                    raise ValueError(_two_ways(token.string))
                divided = divided or between == "/"
                place += 1
                continue
        if not expected:
            # a space multiplies
            direction = sign
            if divided:
                raise ValueError(_two_ways(token.string))
        if token["sign"] == "(":
            place = _product(tokens, place + 1, direction, powers)
            if place == len(tokens):
                raise ValueError(_NOT_A_QUANTITY)
        else:
            power = Fraction((token["caret"] or token["power"] or "1").strip("()"))
            if not 0 < abs(power) <= _HIGHEST_POWER:
                raise ValueError(_NOT_A_QUANTITY)
            powers[token["name"]] = powers.get(token["name"], Fraction(0)) + direction * power
        expected = False
        place += 1
    if expected:
        raise ValueError(_NOT_A_QUANTITY)
    return place


def _two_ways(unit: str) -> str:
    return f"{unit!r} can be read in two ways; write the divisor in brackets, as in 'N/(m mm)'"


def _raised(size: Fraction, power: Fraction) -> Fraction:
    """Return a size to a power: exactly if the power is a whole number, else to the round-off of floats."""
    return size**power.numerator if power.denominator == 1 else Fraction(float(size) ** float(power))


class _Factor(NamedTuple):
    """The size of a unit in SI units, its dimension in base quantities, and its power of radians."""

    size: Fraction
    dimension: Mapping[str, int]
    radians: int


_KNOWN = "known units are nm, um, mm, m, in, thou, Pa, MPa, psi, N, mN, lbf, J, mJ, deg, rad and others"


@lru_cache(maxsize=1000)
def _factor(name: str) -> _Factor:
    """Return a unit by its name. Raises ValueError if it is unknown, or if it is no factor."""
    registry = _registry()
    try:
        known = "degree" if name == "°" else registry.get_name(name)
        unit = pint.util.UnitsContainer({known: 1}, non_int_type=Fraction)
        size, base = registry.get_base_units(unit)
    except pint.PintError as error:
        raise ValueError(f"{name!r} is not a known unit; {_KNOWN}") from error
    if known.endswith("mil"):
        # an angle to pint; on the data sheet of a tape it is a length
        allowed = "as it is an angle or a length; a thousandth of an inch is 'thou'"
        raise ValueError(f"{name!r} is not a known unit, {allowed}, and {_KNOWN}")
    radians = Fraction(dict(registry.Quantity(1, base).unit_items()).get("radian", 0))
    dimension = {str(key): Fraction(power) for key, power in registry.get_dimensionality(unit).items()}
    # a pure number, such as a percent, or a decibel, which is no factor, would change a length silently
    if any(power.denominator != 1 for power in (radians, *dimension.values())) or not (radians or dimension):
        raise ValueError(_of_another_kind(name))
    powers = {key: int(power) for key, power in dimension.items()}
    # pint's base unit of mass is the gram
    size = Fraction(size) / 1000 ** powers.get("[mass]", 0)
    return _Factor(size, MappingProxyType(powers), int(radians))


def _of_another_kind(unit: str) -> str:
    return f"{unit!r} is neither an angle nor a product of powers of stresses and lengths"


#: SI units of power products of a stress and a length, and their sizes in pascals and metres.
_SHOWN = {(1, 1): ("J/m^2", 1.0), (1, -1): ("GPa/nm", 1e18)}
_SINGLE = {(1, 0): "Pa", (0, 1): "m"}


def shown(value: float, units: UnitSystem, stress: int = 0, length: int = 0) -> str:
    """Return the text of a value in E0^stress L0^length, in SI units: a stress, a length or both."""
    si = value * float(units.stress) ** stress * float(units.length) ** length
    if (stress, length) in _SHOWN:
        name, size = _SHOWN[stress, length]
        return f"{si / size:.5g} {name}"
    compact = _registry().Quantity(si, _SINGLE[stress, length]).to_compact()
    return f"{compact.magnitude:.5g} {compact.units:~}"


def length_text(value: float) -> str:
    """Return the text of a length in L0: in SI units while a case is read, else in L0."""
    units = _MEASURED_IN.get()
    return f"{value:.5g} L0" if units is None else shown(value, units, length=1)


#: Units of the quantities of a case, and those that are confused with them, as pint reads them (NIST SP 811,
#: Guide for the Use of the International System of Units, App. B). All of pint's take a tenth of a short run.
_DEFINITIONS = """
    yocto- = 1e-24 = y-
    zepto- = 1e-21 = z-
    atto- = 1e-18 = a-
    femto- = 1e-15 = f-
    pico- = 1e-12 = p-
    nano- = 1e-9 = n-
    micro- = 1e-6 = µ- = μ- = u-
    milli- = 1e-3 = m-
    centi- = 1e-2 = c-
    deci- = 1e-1 = d-
    deca- = 1e1 = da- = deka-
    hecto- = 1e2 = h-
    kilo- = 1e3 = k-
    mega- = 1e6 = M-
    giga- = 1e9 = G-
    tera- = 1e12 = T-
    peta- = 1e15 = P-
    exa- = 1e18 = E-
    meter = [length] = m = metre
    second = [time] = s = sec
    gram = [mass] = g = gramme
    ampere = [current] = A = amp
    kelvin = [temperature] = K
    mole = [substance] = mol
    candela = [luminosity] = cd
    radian = [] = rad
    bit = []
    pi = 3.1415926535897932384626433832795028841971693993751
    percent = 0.01 = %
    degree = pi / 180 * radian = deg
    arcminute = degree / 60 = arcmin
    arcsecond = arcminute / 60 = arcsec
    grade = pi / 200 * radian = grad = gon
    turn = 2 * pi * radian = _ = revolution = cycle
    milliarcsecond = 1e-3 * arcsecond = mas
    angular_mil = 1e-3 * radian = mil
    steradian = radian ** 2 = sr
    minute = 60 * second = min
    hour = 60 * minute = h = hr
    day = 24 * hour = d
    hertz = 1 / second = Hz
    newton = kilogram * meter / second ** 2 = N
    pascal = newton / meter ** 2 = Pa
    joule = newton * meter = J
    watt = joule / second = W
    coulomb = ampere * second = C
    volt = joule / coulomb = V
    liter = 1e-3 * meter ** 3 = L = l = litre
    tonne = 1e3 * kilogram = t = metric_ton
    micron = micrometer = µ = μ
    angstrom = 1e-10 * meter = Å = ångström = Å
    bohr = 5.29177210903e-11 * meter = a_0
    electron_volt = 1.602176634e-19 * joule = eV
    elementary_charge = 1.602176634e-19 * coulomb = e
    hartree = 4.3597447222071e-18 * joule = E_h = Eh
    calorie = 4.184 * joule = cal
    dyne = 1e-5 * newton = dyn
    erg = 1e-7 * joule
    bar = 1e5 * pascal
    barye = 0.1 * pascal = Ba
    atmosphere = 101325 * pascal = atm
    torr = atmosphere / 760
    millimeter_Hg = 133.322387415 * pascal = mmHg
    standard_gravity = 9.80665 * meter / second ** 2 = g_0 = g0
    kilogram_force = kilogram * standard_gravity = kgf = kilopond = kp
    gram_force = gram * standard_gravity = gf
    inch = 0.0254 * meter = in = inches
    thou = 1e-3 * inch = mil_length
    foot = 12 * inch = ft = feet
    yard = 3 * foot = yd
    pound = 0.45359237 * kilogram = lb
    ounce = pound / 16 = oz
    force_pound = pound * standard_gravity = lbf = pound_force
    force_ounce = ounce * standard_gravity = ozf = ounce_force
    kip = 1000 * force_pound
    pound_force_per_square_inch = force_pound / inch ** 2 = psi
    kip_per_square_inch = 1000 * pound_force_per_square_inch = ksi
"""


@cache
def _registry() -> Any:  # the types of pint's registry do not include its type of numbers
    lines = [line.strip() for line in _DEFINITIONS.splitlines()]
    return pint.UnitRegistry([line for line in lines if line], non_int_type=Fraction)
