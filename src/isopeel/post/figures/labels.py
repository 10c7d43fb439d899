"""Labels of axes and marks: quantities with their units, and numbers."""

import re
from collections.abc import Sequence
from math import floor, log10

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure, SubFigure

from isopeel.common.arrays import FloatArray
from isopeel.post.laboratory import Kind, Laboratory
from isopeel.problem import Column, Problem


def axis_label(column: Column) -> str:
    """Return a quantity and its unit, as "moment $M$ / $E_0 L_0^3$"."""
    return f"{column.words or column.name} / {mathematical(column.unit)}"


def scaled_axis(
    axis: Axis, words: str, kind: Kind, laboratory: Laboratory | None, size: float | None = None
) -> None:
    """Label an axis of internal values with a quantity in laboratory units; in L0 and E0 without those.

    The unit is that of a `size` (internal), by default that of lengths of the body.
    """
    if laboratory is None:
        scales = {"length": "L0", "stress": "E0"}.get(kind, "")
        axis.set_label_text(f"{words} / {mathematical(scales)}")
        return
    name, factor = laboratory.unit(kind, size)
    axis.set_label_text(f"{words} / {mathematical(name)}")
    # ticks of all decades and of all powers of ten are alike
    axis.set_major_formatter(lambda value, _: f"{value * factor:.6g}".replace("-", "\N{MINUS SIGN}"))


def plane_axes(axes: Axes, laboratory: Laboratory | None) -> None:
    """Label the axes of a picture of the body."""
    scaled_axis(axes.xaxis, "$x$", "length", laboratory)
    scaled_axis(axes.yaxis, "$y$", "length", laboratory)


def mathematical(unit: str) -> str:
    """Set scales such as E0 L0^3 in mathematical type."""
    if re.search("[A-Z]0", unit):
        return f"${re.sub('(?<=[A-Z])0', '_0', unit)}$"
    # the text after a slash is one unit
    plain = unit.replace("um", "\N{MICRO SIGN}m").replace("^2", "\N{SUPERSCRIPT TWO}")
    return f"({plain})" if "/" in plain else plain


def scientific(value: float) -> str:
    """Return three digits and a power of ten, in mathematical type."""
    digits, exponent = f"{value:.2e}".split("e")
    return rf"${digits}\times 10^{{{int(exponent)}}}$"


def shown_parameter(column: Column, value: float, laboratory: Laboratory | None = None) -> str:
    """Return a parameter of a drive with its unit, as "110°"."""
    if laboratory is not None and column.unit != "degree":
        return laboratory.parameter(column, value)
    return f"{value:g}" + ("°" if column.unit == "degree" else f" {mathematical(column.unit)}")


def rows_of(figure: Figure, heights: Sequence[float]) -> list[Figure | SubFigure]:
    """Return parts of a figure below each other, of relative heights; the figure itself where it is one."""
    if len(heights) == 1:
        return [figure]
    parts = figure.subfigures(len(heights), 1, squeeze=False, height_ratios=heights)
    return list(np.ravel(np.asarray(parts)))


def of_interface(problem: Problem, name: str) -> str:
    """Return " of upper.bottom" where a problem has several interfaces, else nothing."""
    return f" of {name}" if len(problem.interface_names) > 1 else ""


def power_of_ten(values: FloatArray, scale: float) -> int:
    """Return the power of ten of the largest of values, which are differences of numbers of a scale."""
    return floor(log10(max(float(np.abs(values).max(initial=0.0)), abs(scale) * 1e-12, 1e-300)))
