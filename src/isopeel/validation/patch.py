"""Taylor's patch test: a uniform pressure passes between two bodies whose meshes do not match."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from math import pi
from typing import get_args

import numpy as np
from matplotlib.figure import Figure

from isopeel.physics.adhesion import Contact
from isopeel.physics.materials import NeoHooke
from isopeel.post.fields import sample_fields
from isopeel.post.style import BLUE, DASHES, DOTS, GREEN, VERMILION
from isopeel.problem import Body, Interface, Problem, PulledSide, Scheme, Support
from isopeel.problem.place import placed
from isopeel.report.document import Picture
from isopeel.splines.nurbs import rectangle
from isopeel.splines.rows import row_space
from isopeel.validation.check import Check, Result, Row, traced
from isopeel.validation.one_panel import one_panel

#: Forces of one energy act at the Gauss points of one side on the functions of the other, whose ends lie
#: between these points: an error of the quadrature. Two half-passes load each side by its own functions.
ALLOWED: dict[Scheme, float] = {"unbiased": 0.005, "biased": 0.01, "two-half-pass": 1e-10}
_PRESSURE = 10.0
_MATERIAL = NeoHooke(1000.0, 0.4)
#: Elements along both bodies, at the first refinement.
_ELEMENTS = (5, 7)
_USUAL = 3  # Gauss points: the degree and one
_SAMPLES = 7
_SHOWN = 1e-9  # errors below this are round-off


@dataclass(frozen=True)
class Pressing:
    """A scheme, a factor on the numbers of elements, and the Gauss points on an element of a side."""

    scheme: Scheme
    refinement: int = 1
    points: int = _USUAL


@dataclass(frozen=True)
class Pressed:
    """The stress across that differs most from the pressure, and the mean error; nan without equilibrium."""

    of: Pressing
    stress: float
    mean_error: float  # relative, root of the mean square
    failure: str

    @property
    def error(self) -> float:
        """Its relative deviation."""
        return abs(self.stress / _PRESSURE - 1)


def press(of: Pressing) -> Pressed:
    """Press one square on another one, each held on its line of symmetry."""
    upper = Body(rectangle(2.0, 1.0), _MATERIAL, "upper")
    lower = Body(placed(rectangle(2.0, 1.0), (0.0, -1.0), 0.0), _MATERIAL, "lower")
    joint = Interface(upper.side("bottom"), Contact(), lower.side("top"), scheme=of.scheme)
    held = Support(lower.side("bottom"), (1,)), *(Support(one.side("left"), (0,)) for one in (upper, lower))
    push = PulledSide(upper.side("top"), -pi / 2, control="force")
    problem = Problem("patch", (upper, lower), (joint,), held, push)
    spaces = {
        body.name: row_space("N2", (of.refinement * count, 2 * of.refinement), 2)
        for body, count in zip((upper, lower), _ELEMENTS, strict=True)
    }
    found = traced(problem, spaces, [2 * _PRESSURE], contact_points=of.points)
    if found.failure or found.displacement is None:
        return Pressed(of, np.nan, np.nan, found.failure)
    samples = [
        sample_fields(problem, spaces, found.displacement, (_SAMPLES, _SAMPLES), body).nominal_stress
        for body in spaces
    ]
    stress = -np.concatenate([one[..., 1, 1].ravel() for one in samples])
    errors = stress / _PRESSURE - 1
    return Pressed(of, float(stress[np.argmax(np.abs(errors))]), float(np.sqrt(np.mean(errors**2))), "")


def judge(outcomes: Sequence[Pressed]) -> Result:
    """Compare the stress with the pressure, and the errors of one scheme with each other."""
    rows = []
    for found in outcomes:
        meshes = " and ".join(str(found.of.refinement * count) for count in _ELEMENTS)
        details = (
            found.of.scheme,
            meshes,
            f"{found.of.points}",
            f"{found.error:.2g}",
            f"{found.mean_error:.2g}",
        )
        rows.append(Row(found.stress, _PRESSURE, ALLOWED[found.of.scheme], details))
    return Result(
        quantity="stress across that differs most from the pressure / E0",
        text=(
            "Two equal bodies lie on each other with meshes that do not match. A uniform pressure on the"
            " upper one must give the same stress everywhere (patch test of Taylor and Papadopoulos). The"
            f" law is contact without adhesion. The table has the stress that differs most among {_SAMPLES}"
            f" x {_SAMPLES} places of each body, its error, and the root of the mean square of all errors."
            " The energies of the schemes `unbiased` and `biased` are integrated at Gauss points of one"
            " side, between which the functions of the other side have their ends. This error of the"
            " quadrature falls with the number of points: {patch-error}. On a finer mesh it stays next to"
            " the interface, where it has the same size, and the mean error falls. In two half-passes each"
            " side loads its own body only. They pass the test to round-off, but they have no energy, and"
            " the forces on both bodies are equal in this test only."
        ),
        settings=(
            ("bodies", "2 x 1 each, neo-Hooke, E = 1000, Poisson's ratio 0.4; pressure 10"),
            ("space", "N2, degree 2 across"),
        ),
        columns=("scheme", "elements along", "Gauss points", "error", "mean error"),
        named_by=3,
        rows=tuple(rows),
        pictures=(
            Picture(
                "patch-error",
                "Largest error of the stress over the number of Gauss points on an element, for the schemes"
                " with an energy.",
                partial(_draw, tuple(outcomes)),
            ),
        ),
        problems=tuple(found.failure for found in outcomes if found.failure),
    )


def _draw(outcomes: Sequence[Pressed]) -> Figure:
    with one_panel("Gauss points on an element", "relative error of the stress", 2.6) as (figure, axes):
        looks = zip(get_args(Scheme), (BLUE, VERMILION, GREEN), ("-", DASHES, DOTS), strict=True)
        for scheme, color, line in looks:
            own = [one for one in outcomes if (one.of.scheme, one.of.refinement) == (scheme, 1)]
            points = [found.of.points for found in own if found.error > _SHOWN]
            errors = [found.error for found in own if found.error > _SHOWN]
            if errors:
                axes.loglog(points, errors, color=color, linestyle=line, marker="o", label=scheme)
        counts = sorted({one.of.points for one in outcomes})
        axes.set_xticks(counts, [str(count) for count in counts])
        axes.set_xticks([], minor=True)
    return figure


_CASES = tuple(
    Pressing(scheme, *numbers)
    for scheme in ALLOWED
    for numbers in ((1, 3), (1, 6), (1, 12), (1, 24), (2, 3), (4, 3))
)
CHECK = Check("Patch test", _CASES, press, judge)
