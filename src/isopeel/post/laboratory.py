"""Units that a laboratory reads: N/m, mm, MPa, J/m^2, and N or J of a body whose width is known.

A run computes and stores in the units L0 and E0 of its case. Whatever is shown is converted here.
"""

import re
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from isopeel.common.units import UnitSystem
from isopeel.problem import Column, Problem
from isopeel.results.curve import Curve

#: What is measured. Forces, moments and energies are per width, unless the width is known.
Kind: TypeAlias = Literal["length", "stress", "force", "moment", "energy", "toughness", "angle", "number"]

#: Powers of E0 and L0 of a body of unit width.
_POWERS: dict[Kind, tuple[int, int]] = {
    "length": (0, 1),
    "stress": (1, 0),
    "force": (1, 1),
    "moment": (1, 2),
    "energy": (1, 2),
    "toughness": (1, 1),
}
#: Units per width, and of a body of a known width.
_PER_WIDTH: dict[Kind, tuple[str, str]] = {
    "force": ("N/m", "N"),
    "moment": ("N m/m", "N m"),
    "energy": ("J/m", "J"),
}
#: Units by size, in SI units, the smallest first; each is taken up to a thousand of it, the last one beyond.
_BY_SIZE: dict[Kind, tuple[tuple[str, Fraction], ...]] = {
    "length": (
        ("nm", Fraction(1, 10**9)),
        ("um", Fraction(1, 10**6)),
        ("mm", Fraction(1, 10**3)),
        ("m", Fraction(1)),
    ),
    "stress": (
        ("Pa", Fraction(1)),
        ("kPa", Fraction(10**3)),
        ("MPa", Fraction(10**6)),
        ("GPa", Fraction(10**9)),
    ),
}
#: Digits of a number in a table.
DIGITS = 6


class Unit(NamedTuple):
    """A unit by its name, and the factor to it from internal values."""

    name: str
    factor: float


@dataclass(frozen=True)
class Laboratory:
    """The units of a case, in which outputs are written.

    `extent` is the size of all bodies and `width` its extent across the plane, in L0; without a width forces,
    moments and energies are per width.
    """

    units: UnitSystem
    extent: float = 1.0
    width: float | None = None

    @classmethod
    def of(cls, units: UnitSystem, problem: Problem, width: float | None = None) -> "Laboratory":
        """Return the units of a problem."""
        points = np.concatenate([body.shape.control_points.reshape(-1, 2) for body in problem.bodies])
        return cls(units, float(np.ptp(points, axis=0).max()), width)

    def unit(self, kind: Kind, size: float | None = None) -> Unit:
        """Return the unit of a kind for values of a size (internal), for lengths by default the body's."""
        if kind == "angle":
            return Unit("deg", 1.0)
        if kind == "number":
            return Unit("", 1.0)
        stress, length = _POWERS[kind]
        internal = self.units.stress**stress * self.units.length**length
        if kind in _BY_SIZE:
            given = size is not None and np.isfinite(size) and size != 0
            shown = abs(size) if given and size is not None else self.extent if kind == "length" else 1.0
            return _by_size(kind, shown, internal)
        if kind == "toughness":
            return Unit("J/m^2", float(internal))
        per_width, whole = _PER_WIDTH[kind]
        if self.width is None:
            return Unit(per_width, float(internal))
        return Unit(whole, float(internal * self.units.length) * self.width)

    def value(self, value: float, kind: Kind) -> tuple[float, str]:
        """Return a value in the unit of its kind, and that unit; lengths in that of the body."""
        unit = self.unit(kind, value if kind == "stress" else None)
        return value * unit.factor, unit.name

    def text(self, value: float, kind: Kind, digits: int = DIGITS) -> str:
        """Return a value with its unit, lengths and stresses in the one of their size."""
        unit = self.unit(kind, value)
        shown = f"{value * unit.factor:.{digits}g}"
        # few digits of 800 um are known, and 8e+02 um is hard to read
        if "e+" in shown and abs(float(shown)) < 1e6:
            shown = f"{float(shown):.0f}"
        return f"{shown} {unit.name}".rstrip()

    def length(self, value: float) -> str:
        """Return a length with its unit, in four digits, for a sentence."""
        return self.text(value, "length", 4)

    def both(self, value: float, kind: Kind, digits: int = DIGITS) -> str:
        """Return a value with its unit, and in the units of the case where these are the usual L0 and E0.

        L0 and E0 are the units of the published strip, with which results are compared.
        """
        scales = {"force": "E0 L0", "moment": "E0 L0^3"}.get(kind)
        if scales is None or self.units != UnitSystem():
            return self.text(value, kind, digits)
        return f"{value:.{digits}g} {scales} = {self.text(value, kind, digits)}"

    def column(self, column: Column) -> Unit:
        """Return the unit of a column of a curve, and the factor from the values in it."""
        return self.unit(kind_of(column)) if column.unit in _KINDS else Unit(column.unit, 1.0)

    def heading(self, column: Column) -> str:
        """Return the heading of a column in a table: "force [N/m]"."""
        unit = self.column(column).name
        name = column.name.removesuffix("_deg")
        return f"{name} [{unit}]" if unit not in ("", "1") else name

    def parameter(self, column: Column, value: float) -> str:
        """Return a value of a column with its unit."""
        if column.unit not in _KINDS:
            return column.text(value)
        return self.text(value, kind_of(column))

    def curve(self, curve: Curve) -> Curve:
        """Return a curve with parameter, reaction and columns in these units; energies do not change."""
        columns, values = [], []
        for column, internal in (
            (curve.parameter_column, curve.parameter),
            (curve.reaction_column, curve.reaction),
        ):
            unit = self.column(column)
            name = "degree" if unit.name == "deg" else unit.name
            columns.append(Column(column.name, name, column.factor * unit.factor, column.words))
            values.append(internal * unit.factor)
        return replace(
            curve,
            parameter_column=columns[0],
            reaction_column=columns[1],
            parameter=values[0],
            reaction=values[1],
            sensitivities=curve.sensitivities * self.column(curve.reaction_column).factor,
        )

    def sentence(self, text: str) -> str:
        """Return a sentence with the values in it, in units of columns, converted to these units."""

        def shown(found: re.Match[str]) -> str:
            value, unit = float(found[1]), found[2]
            return f"{found[1]} deg" if unit.startswith("degree") else self.text(value, _KINDS[unit])

        return _VALUE.sub(shown, text)

    def note(self) -> str:
        """Return to which width forces, moments and energies refer, in words."""
        if self.width is not None:
            return f"for a width of {self.text(self.width, 'length')}"
        return "forces, moments and energies per width"


#: The kinds of quantities by the units of columns.
_KINDS: dict[str, Kind] = {
    "L0": "length",
    "E0 L0": "force",
    "E0": "stress",
    "degree": "angle",
    "1": "number",
    "E0 L0^3": "energy",
}
_UNITS = "|".join(re.escape(unit) for unit in sorted(_KINDS, key=len, reverse=True) if unit != "1")
_UNITS = _UNITS.replace("degree", "degrees?")


#: A value in the unit of a column, the longest units first.
_VALUE = re.compile(rf"(?<![\w.])([-+]?\d[\d.]*(?:e[-+]?\d+)?) ({_UNITS})(?![\w^])")


def kind_of(column: Column) -> Kind:
    """Return the kind of quantity of a column."""
    # moments and energies have the same unit: the name of the column, or of its quantity, decides
    if column.unit == "E0 L0^3" and "moment" in (column.name, column.words.partition(" ")[0]):
        return "moment"
    return _KINDS.get(column.unit, "number")


def short_unit(column: Column) -> str:
    """Return the unit of a column as it stands behind a number."""
    return "deg" if column.unit == "degree" else column.unit


def _by_size(kind: Kind, size: float, internal: Fraction) -> Unit:
    si = size * float(internal)
    *units, last = _BY_SIZE[kind]
    for name, scale in units:
        # millimetres up to 10 m, as laboratories write the lengths of their tapes
        most = 10_000 if name == "mm" else 1000
        if si < most * float(scale) * (1 - 1e-12):
            return Unit(name, float(internal / scale))
    return Unit(last[0], float(internal / last[1]))
