"""Words at axes and marks: quantities with their units, and numbers."""

import re
from math import floor, log10

import numpy as np

from isopeel.arrays import FloatArray
from isopeel.problem import Column


def axis_label(column: Column) -> str:
    """A quantity and its unit, as "moment $M$ / $E_0 L_0^3$"."""
    return f"{column.words or column.name} / {mathematical(column.unit)}"


def mathematical(unit: str) -> str:
    """Set scales such as E0 L0^3 in mathematical type."""
    return f"${re.sub('(?<=[A-Z])0', '_0', unit)}$" if re.search("[A-Z]0", unit) else unit


def scientific(value: float) -> str:
    """Three digits and a power of ten, in mathematical type."""
    digits, exponent = f"{value:.2e}".split("e")
    return rf"${digits}\times 10^{{{int(exponent)}}}$"


def shown_parameter(column: Column, value: float) -> str:
    """A parameter of a drive with its unit, as "110°"."""
    return f"{value:g}" + ("°" if column.unit == "degree" else f" {mathematical(column.unit)}")


def power_of_ten(values: FloatArray, scale: float) -> int:
    """Exponent of the largest of values, which are differences of numbers of a scale, up to round-off."""
    return floor(log10(max(float(np.abs(values).max(initial=0.0)), abs(scale) * 1e-12, 1e-300)))
