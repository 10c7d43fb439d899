"""The curvature factors of the van der Waals law against integrals over pairs of points."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from matplotlib.figure import Figure
from scipy.integrate import quad

from isopeel.physics.adhesion import VanDerWaals
from isopeel.physics.batch import evaluate_law
from isopeel.post.style import BLUE, DASHES, GREY, TWO_COLUMNS, VERMILION, style
from isopeel.report.document import Picture
from isopeel.validation.check import Check, Result, Row

ALLOWED, ALLOWED_HOLLOW = 1e-6, 0.002
#: The powers of the gap in the repulsion and the attraction of a flat substrate.
POWERS = (9, 3)
_GAP = 1.0
_RADII = (100.0, 20.0, 10.0, 5.0, 2.0, 1.0, -100.0, -20.0, -10.0, -5.0)
#: The smallest radius of a hollow substrate, in gaps, at which the law must hold.
_HOLLOW_LIMIT = -10.0


@dataclass(frozen=True)
class Factors:
    """f1 and f2 at a ratio R/r, by the law and by integrals."""

    radius: float  # in units of the gap; negative where the substrate is hollow
    by_law: tuple[float, float]
    by_integrals: tuple[float, float]


def curvature_factors(radius: float) -> Factors:
    """Return f1 and f2 at R/r = `radius`, from the tractions of two laws and from integrals."""
    integrated = tuple(_layers(radius, power) / _layers(np.inf, power) for power in POWERS)
    return Factors(radius, law_factors(1 / radius), (integrated[0], integrated[1]))


def law_factors(curvature: float) -> tuple[float, float]:
    """Return the f1 and f2 that follow from the tractions of two laws of different r0, at the gap 1."""
    terms, tractions = [], []
    for distance in (0.2, 1.4):
        law = VanDerWaals(2 * np.pi * distance**3, distance)  # whose factor A_H/(2 pi r0^3) is 1
        gap, bend = np.array([_GAP]), np.array([curvature])
        tractions.append(evaluate_law(law.kernel, law.parameters, gap, bend)[1][0])
        terms.append([(distance / _GAP) ** 9 / 45, -((distance / _GAP) ** 3) / 3])
    repulsion, attraction = np.linalg.solve(np.array(terms), np.array(tractions))
    return float(repulsion), float(attraction)


def _layers(radius: float, power: int) -> float:
    """Return the sum of the forces of a half space on the layers of a body around a sphere.

    In a hollow sphere, the layers end at its centre.
    """
    end = -radius if radius < 0 else np.inf

    def layer(depth: float) -> float:
        growth = (1 + depth / radius) / (1 + _GAP / radius)
        return half_space(depth, power + 3) * growth**2

    total: float = quad(layer, _GAP, end, epsabs=0, epsrel=1e-9, limit=200)[0]
    return total


def half_space(gap: float, power: int) -> float:
    """Return the force of a half space on a point, where pairs of points have the energy d^-power.

    The integral is over rings about the point's normal. Points at a height q = gap t, in rings of radius
    q tan(b), are at the distance q/cos(b).
    """

    def ring(angle: float) -> float:
        return float(2 * np.pi * power * np.tan(angle) * np.cos(angle) ** power)

    rings = quad(ring, 0, np.pi / 2, epsabs=0, epsrel=1e-10)[0]
    heights = quad(lambda height: height ** (1 - power), gap, np.inf, epsabs=0, epsrel=1e-10)[0]
    return float(rings * heights)


def judge(outcomes: Sequence[Factors]) -> Result:
    """Compare the factors one by one."""
    rows = []
    for found in outcomes:
        shape = "convex" if found.radius > 0 else "hollow"
        limit = ALLOWED_HOLLOW if found.radius <= _HOLLOW_LIMIT else None
        allowed = ALLOWED if found.radius > 0 else limit
        rows += [
            Row(by_law, integral, allowed, (shape, f"{found.radius:g}", name))
            for name, by_law, integral in zip(("f1", "f2"), found.by_law, found.by_integrals, strict=True)
        ]
    return Result(
        quantity="factor",
        text=(
            "On a curved substrate, the van der Waals law multiplies repulsion by f1 and attraction by f2."
            " Here they are compared with sums of forces on the layers of a body around a *sphere* of radius"
            " R. The force on a point of a layer is that of a half space at the gap of the point; it is"
            " integrated over all points of the half space: {curvature-factors}. The result shows that the"
            " factors are those of a sphere, not of a cylinder in plane strain. In a hollow substrate (R < 0)"
            " the layers end at the centre, but the law also counts layers beyond it. Their part of the"
            " attraction is about (r/R)^3. Rows with a radius of ten gaps or more must pass; those with a"
            " smaller radius are for information."
        ),
        settings=(("laws", "r0 = 0.2 r and 1.4 r; f1 and f2 follow from two tractions"),),
        columns=("substrate", "R/r", "factor"),
        named_by=3,
        rows=tuple(rows),
        pictures=(
            Picture(
                "curvature-factors",
                "The factors of the van der Waals law (lines) and of integrals over pairs of points (marks).",
                partial(_draw, tuple(outcomes)),
            ),
        ),
    )


def _draw(outcomes: Sequence[Factors]) -> Figure:
    with style():
        figure = Figure(figsize=(TWO_COLUMNS / 2, 2.6), layout="constrained")
        axes = figure.subplots()
        curvature = np.linspace(-0.22, 1.0, 123)
        lines = np.array([law_factors(k) for k in curvature])
        at = [1 / found.radius for found in outcomes]
        axes.axvline(0.0, color=GREY, linewidth=0.6)
        for k, (name, color, line, marker) in enumerate(
            (("$f_1$, repulsion", BLUE, "-", "o"), ("$f_2$, attraction", VERMILION, DASHES, "s"))
        ):
            axes.plot(curvature, lines[:, k], color=color, linestyle=line, label=name)
            values = [found.by_integrals[k] for found in outcomes]
            axes.plot(at, values, marker, color=color, markersize=4, markerfacecolor="white")
        axes.set_xlabel("gap over radius $r/R$")
        axes.set_ylabel("factor")
        axes.legend()
        return figure


CHECK = Check("Curved substrates", _RADII, curvature_factors, judge)
