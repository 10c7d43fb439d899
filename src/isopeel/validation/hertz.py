"""A cylinder pressed onto a flat substrate without adhesion: Hertz's line contact."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from math import sqrt

import numpy as np
from matplotlib.figure import Figure

from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion import Exponential
from isopeel.physics.batch import evaluate_substrate
from isopeel.post.closed_form import HertzLine, hertz_line
from isopeel.post.fields import sample_side
from isopeel.post.law import evaluate_flat
from isopeel.post.style import BLUE, DASHES, GREY, TWO_COLUMNS, VERMILION, style
from isopeel.report.document import Picture
from isopeel.solve.newton import NewtonSettings
from isopeel.splines.rows import row_space
from isopeel.validation.check import Check, Result, Row, traced
from isopeel.validation.cylinder import (
    MODULUS,
    POISSONS_RATIO,
    RADIUS,
    REDUCED_MODULUS,
    cylinder,
)

ALLOWED = 0.01
#: A law of very little work, with this stiffness in compression: k = (e strength)^2/W.
_WORK, _STIFFNESS = 1e-10, 300.0
_END = 0.2  # share of the side that is in contact
_FITTED = 0.9  # share of the half-width by Hertz: at the edge, where p has a root, the mesh smooths it
_DISPLACEMENTS = (0.05, 0.08, 0.12)
_STEPS = 12
#: Finer than for the pull-off, where the attraction smooths the edge.
_ELEMENTS, _GRADING = (200, 24), (100.0, 200.0)


@dataclass(frozen=True, eq=False)
class Pressed:
    """Pressures p at places x under a load, and Hertz's solution of that load."""

    load: float
    place: FloatArray
    pressure: FloatArray
    hertz: HertzLine
    half_width: float
    peak_pressure: float
    failure: str


def press(displacement: float, elements: tuple[int, int] = _ELEMENTS) -> Pressed:
    """Press the cylinder onto the substrate, and fit Hertz's p^2 = p_0^2 (1 - x^2/a^2) to the pressure."""
    law = Exponential(sqrt(_STIFFNESS * _WORK) / np.e, _WORK)
    problem, space = cylinder(law, _END), row_space("N2", elements, 2, _GRADING)
    path = -np.geomspace(displacement / 400, displacement, _STEPS)
    found = traced(problem, space, path, NewtonSettings(path_control="auto"))
    if found.failure or found.displacement is None:
        nothing = np.zeros(0)
        return Pressed(np.nan, nothing, nothing, HertzLine(np.nan, np.nan), np.nan, np.nan, found.failure)
    hertz = hertz_line(-2 * float(found.reaction[-1]), REDUCED_MODULUS, RADIUS)
    knots = space.rows[0].breakpoints
    knots = knots[knots <= _END]
    nodes, _ = np.polynomial.legendre.leggauss(space.degree + 1)
    parameters = knots[:-1, None] + np.diff(knots)[:, None] * (nodes + 1) / 2
    position = sample_side(problem, space, found.displacement, "bottom", parameters).position
    substrate = problem.adhesion.substrate
    gap, _, _ = evaluate_substrate(substrate.kernel, substrate.parameters, position)
    place, pressure = position[..., 0].ravel(), evaluate_flat(law, gap)[1].ravel()
    inside = place < _FITTED * hertz.half_width
    slope, square = np.polyfit(place[inside] ** 2, pressure[inside] ** 2, 1)
    return Pressed(
        -2 * float(found.reaction[-1]),
        place,
        pressure,
        hertz,
        sqrt(-square / slope),
        sqrt(square),
        found.failure,
    )


def judge(outcomes: Sequence[Pressed]) -> Result:
    """Compare half-widths and peak pressures."""
    rows = []
    for found in outcomes:
        details = f"{found.hertz.half_width / RADIUS:.4f}", f"{found.load:.5f}"
        rows += [
            Row(found.half_width, found.hertz.half_width, ALLOWED, ("a / L0", *details)),
            Row(found.peak_pressure, found.hertz.peak_pressure, ALLOWED, ("p_0 / E0", *details)),
        ]
    return Result(
        quantity="half-width a, peak pressure p_0",
        text=(
            "The same cylinder is pressed onto the substrate by its middle plane. The attraction of the law"
            " is negligible. Pressures are those of the law at the gaps of the Gauss points. The line p^2 ="
            f" p_0^2 (1 - x^2/a^2) over x^2 is fitted to the points with x < {_FITTED:g} a:"
            " {hertz-pressure}. Its a and p_0 are compared with a = sqrt(4 P R/(pi E\\*)) and p_0 = 2 P/(pi"
            " a) at the load P of the run. Closer to the edge of the contact the pressure falls steeply, and"
            " the mesh smooths it."
        ),
        settings=(
            ("cylinder", f"R = {RADIUS:g}, E = {MODULUS:g}, Poisson's ratio {POISSONS_RATIO:g}; a quarter"),
            ("law", f"exponential, stiffness {_STIFFNESS:g} E0/L0 in compression, W = {_WORK:g}"),
            (
                "space",
                f"N2, degree 2 across, {_ELEMENTS[0]} x {_ELEMENTS[1]} elements graded 1:{_GRADING[0]:g} and"
                f" 1:{_GRADING[1]:g}",
            ),
        ),
        columns=("number", "a/R", "load P / E0 L0"),
        named_by=2,
        rows=tuple(rows),
        pictures=(
            Picture(
                "hertz-pressure",
                "Pressure in the contact over x, and its square over x^2, in Hertz's units: runs at three"
                " loads, and the closed form.",
                partial(_draw, tuple(found for found in outcomes if not found.failure)),
            ),
        ),
        problems=tuple(found.failure for found in outcomes if found.failure),
    )


def _draw(outcomes: Sequence[Pressed]) -> Figure:
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 2.8), layout="constrained")
        pressures, squares = figure.subplots(1, 2)
        x = np.linspace(0.0, 1.0, 401)
        pressures.plot(x, np.sqrt(1 - x**2), color=GREY, linestyle=DASHES, label="Hertz")
        squares.plot(x**2, 1 - x**2, color=GREY, linestyle=DASHES)
        for found, color, marker in zip(outcomes, (BLUE, VERMILION, "black"), "os^", strict=False):
            place = found.place / found.hertz.half_width
            pressure = found.pressure / found.hertz.peak_pressure
            chosen = place < 1.15
            marks = {"color": color, "marker": marker, "markersize": 3, "linestyle": "none"}
            label = f"$a/R$ = {found.hertz.half_width / RADIUS:.4f}"
            pressures.plot(place[chosen], pressure[chosen], markevery=4, label=label, **marks)
            squares.plot(place[chosen] ** 2, pressure[chosen] ** 2, markevery=4, **marks)
        pressures.set_xlabel("place $x/a$")
        pressures.set_ylabel("pressure $p/p_0$")
        pressures.legend(loc="lower left")
        squares.set_xlabel("$x^2/a^2$")
        squares.set_ylabel("$p^2/p_0^2$")
        return figure


CHECK = Check("Cylinder pressed on", _DISPLACEMENTS, press, judge)
