"""Strips peeled by a moment against M = sqrt(2 E' I W)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from math import sqrt
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from isopeel.physics.adhesion import VanDerWaals
from isopeel.physics.materials import NeoHooke
from isopeel.post.closed_form import beam_peeling
from isopeel.post.law import law_character
from isopeel.post.style import BLUE, GREY, TWO_COLUMNS, style
from isopeel.problem import Problem, strip
from isopeel.report.document import Picture
from isopeel.splines.rows import row_space
from isopeel.validation.check import Check, Result, Row, traced

#: Bending strain up to which the closed form must hold, and the largest deviation that is allowed.
SMALL_STRAIN, ALLOWED = 0.05, 0.005
_POISSONS_RATIO = 0.2
_MODULUS_FACTOR = 1 / (1 - _POISSONS_RATIO**2)
_PERIODS, _STEPS_PER_PERIOD = 3, 8


@dataclass(frozen=True)
class Strip:
    """A strip of modulus E, height h, and van der Waals adhesion of work W and distance r0."""

    modulus: float
    height: float
    work: float
    distance: float

    @property
    def bending_strain(self) -> float:
        """h/(2 rho) on the plateau of the closed form."""
        return sqrt(6 * self.work / (_MODULUS_FACTOR * self.modulus * self.height))


@dataclass(frozen=True)
class Plateau:
    """The mean moment over whole periods of the mesh, and its change from the first period to the last."""

    strip: Strip
    moment: float
    expected: float
    drift: float
    failure: str


def peel(case: Strip) -> Plateau:
    """Peel a strip until the attraction at the end of the joint has vanished, and return the moment."""
    problem, held = _problem(case)
    closed_form = beam_peeling(problem)
    assert closed_form is not None
    elements = round(5 * closed_form.length / held)
    free, peeled = 2 * case.height, _peeled(case)
    end = (free + peeled) / closed_form.radius
    period = np.radians(closed_form.period_deg(elements))
    start = end - _PERIODS * period
    path = [
        *np.linspace(0.0, start, max(12, round(start / period / 1.5)))[:-1],
        *np.linspace(start, end, _PERIODS * _STEPS_PER_PERIOD + 1),
    ]
    found = traced(problem, row_space("N2.1", (elements, 2), 2), path)
    if found.failure:
        return Plateau(case, np.nan, closed_form.moment, np.nan, found.failure)
    means = found.reaction[-_PERIODS * _STEPS_PER_PERIOD :].reshape(_PERIODS, -1).mean(axis=1)
    return Plateau(case, float(means.mean()), closed_form.moment, float(np.ptp(means)), "")


def _peeled(case: Strip) -> float:
    """The length to peel: its end has opened by 40 r0, where at most 1/1600 of the attraction is left."""
    return sqrt(40 * case.distance * case.height / case.bending_strain)


def _problem(case: Strip) -> tuple[Problem, float]:
    """Return the problem, and the decay length of a beam on springs of the law's stiffness."""
    law = VanDerWaals.like(0.0, case.work, case.distance / 15 ** (1 / 6))
    modulus = _MODULUS_FACTOR * case.modulus
    held = float((modulus * case.height**3 / (3 * law_character(law).stiffness)) ** 0.25)
    adhering = _peeled(case) + 4 * held + 2 * case.height
    problem = strip(
        length=2 * case.height + adhering,
        height=case.height,
        adhering_length=adhering,
        material=NeoHooke(case.modulus, _POISSONS_RATIO),
        law=law,
    )
    return problem, held


def judge(outcomes: Sequence[Plateau]) -> Result:
    """Compare plateaus with the closed form; rows above its range of strains are for information."""
    rows = tuple(
        Row(
            found.moment,
            found.expected,
            ALLOWED if found.strip.bending_strain < SMALL_STRAIN else None,
            (
                f"{found.strip.modulus:g}",
                f"{found.strip.height:g}",
                f"{found.strip.work:.3g}",
                f"{100 * found.strip.bending_strain:.2f}",
                f"{100 * found.drift / found.expected:.3f}",
            ),
        )
        for found in outcomes
    )
    whole = [found for found in outcomes if not found.failure]
    text = (
        "A pure moment rotates the end of a strip. The strip peels at M = sqrt(2 E' I W) if its bending"
        " strain h/(2 rho) is small, where E' = E/(1 - nu^2) and I = h^3/12. The moment is the mean over the"
        f" last {_PERIODS} periods of the mesh, when the end of the joint has opened by 40 r0. In one period"
        " one element peels. The column drift is the change of the mean from the first of these periods to"
        " the last."
    )
    if len(whole) > 1:
        text += (
            f" The deviation is {_fitted(whole)[0]:.3f} (h/(2 rho))^2 {100 * _fitted(whole)[1]:+.3f} %,"
            " fitted to all rows: {bending-drift}. The first term is the square of the bending strain,"
            " which beam theory neglects. The second one is the attraction that is left at the end of the"
            " joint."
        )
    return Result(
        quantity="moment M / E0 L0^2",
        text=text,
        settings=(
            ("space", "N2.1, degree 2 across, 2 elements across"),
            ("elements along", "five to the length (4 E'I/k)^(1/4), k the law's stiffness"),
            ("law, Poisson's ratio", f"van der Waals, {_POISSONS_RATIO}"),
        ),
        columns=("E / E0", "h / L0", "W / E0 L0", "bending strain / %", "drift / %"),
        named_by=4,
        rows=rows,
        pictures=(
            Picture(
                "bending-drift",
                "Deviation from M = sqrt(2 E' I W) over the bending strain; dashed: the allowed deviation.",
                partial(_draw, tuple(whole)),
            ),
        ),
        problems=tuple(found.failure for found in outcomes if found.failure),
    )


def _fitted(outcomes: Sequence[Plateau]) -> tuple[float, float]:
    """Return the factor of the squared bending strain in the deviation, and the deviation without strain."""
    square = [found.strip.bending_strain**2 for found in outcomes]
    factor, rest = np.polyfit(square, [found.moment / found.expected - 1 for found in outcomes], 1)
    return float(factor), float(rest)


def _draw(outcomes: Sequence[Plateau]) -> Figure:
    with style():
        figure = Figure(figsize=(TWO_COLUMNS / 2, 2.6), layout="constrained")
        axes = figure.subplots()
        strain = np.array([found.strip.bending_strain for found in outcomes])
        deviation = np.array([found.moment / found.expected - 1 for found in outcomes])
        axes.axhline(0.0, color=GREY, linewidth=0.6)
        for sign in (-1, 1):
            limit = 100 * sign * ALLOWED
            axes.plot([0, 100 * SMALL_STRAIN], [limit, limit], color=GREY, linestyle="--", linewidth=0.8)
        if len(outcomes) > 1:
            along = np.linspace(0.0, strain.max(), 101)
            factor, rest = _fitted(outcomes)
            axes.plot(100 * along, 100 * (factor * along**2 + rest), color=BLUE, linewidth=0.8, label="fit")
        marks: dict[str, Any] = {
            "linestyle": "none",
            "color": BLUE,
            "markersize": 4,
            "markerfacecolor": "white",
        }
        axes.plot(100 * strain, 100 * deviation, marker="o", label="runs", **marks)
        axes.set_xlabel(r"bending strain $h/(2\rho)$ / %")
        axes.set_ylabel("deviation of the moment / %")
        axes.legend(loc="upper right")
        return figure


def _combinations() -> tuple[Strip, ...]:
    """Return ten strips of small strains and five above, with factors of 100 in E and of 8 in h."""
    small = (
        (1.0, 10.0, 0.005, 0.3),
        (0.1, 10.0, 0.01, 0.4),
        (10.0, 10.0, 0.015, 0.4),
        (1.0, 5.0, 0.02, 0.2),
        (1.0, 40.0, 0.02, 0.8),
        (0.1, 20.0, 0.025, 0.4),
        (10.0, 5.0, 0.03, 0.2),
        (1.0, 20.0, 0.035, 0.8),
        (0.1, 40.0, 0.04, 1.6),
        (10.0, 10.0, 0.045, 0.4),
    )
    large = (
        (1.0, 10.0, 0.06, 0.4),
        (0.1, 10.0, 0.08, 0.4),
        (10.0, 20.0, 0.1, 0.8),
        (1.0, 5.0, 0.125, 0.4),
        (1.0, 10.0, 0.15, 0.4),
    )
    return tuple(
        Strip(modulus, height, _rounded(strain**2 * _MODULUS_FACTOR * modulus * height / 6), distance)
        for modulus, height, strain, distance in (*small, *large)
    )


def _rounded(value: float) -> float:
    return float(f"{value:.3g}")


CHECK = Check("Strips peeled by a moment", _combinations(), peel, judge)
