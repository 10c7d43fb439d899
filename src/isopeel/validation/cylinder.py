"""A cylinder pulled off a flat substrate: the limits of Johnson, Kendall and Roberts, and of rigid bodies."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from math import pi, sqrt

import numpy as np
from matplotlib.figure import Figure

from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion import AdhesionLaw, Exponential
from isopeel.physics.materials import NeoHooke
from isopeel.physics.substrates import Flat
from isopeel.post.closed_form import jkr_line_pull_off, maugis_cylinder_pull_off
from isopeel.post.closed_form.rigid_cylinder import rigid_cylinder_pull_off
from isopeel.post.style import BLUE, DASHES, DOT_DASHES, DOTS, GREY, TWO_COLUMNS, VERMILION, style
from isopeel.problem import Body, Interface, MovedSide, Problem, Support
from isopeel.problem.shapes.quarter_cylinder import QuarterCylinder
from isopeel.report.document import Picture
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.step import Step
from isopeel.splines.rows import row_space
from isopeel.validation.check import Check, Result, Row, traced

ALLOWED = 0.02
#: Tabor parameters above which the cylinder's edge is that of a crack, and below which it is rigid.
CRACK_LIKE, RIGID_LIKE = 2.5, 0.05
RADIUS = 100.0
MODULUS, POISSONS_RATIO = 1.0, 0.3
REDUCED_MODULUS = MODULUS / (1 - POISSONS_RATIO**2)
_WORK = 1e-3
_ELEMENTS, _GRADING = (100, 24), 200.0
_STEPS_PER_LENGTH, _FARTHEST = 240, 0.25
_STRENGTHS = (0.08, 0.06, 0.035, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0005)
_CURVES = (0.06, 0.02, 0.005)


@dataclass(frozen=True, eq=False)
class PulledOff:
    """Loads (positive: pull) over displacements of the top, and the closed forms of the largest of them."""

    strength: float
    displacement: FloatArray
    load: FloatArray
    jkr: float
    maugis: float
    rigid: float
    failure: str

    @property
    def pull_off(self) -> float:
        """Largest load; nan where there is none."""
        return float(self.load.max()) if not self.failure else np.nan

    @property
    def tabor_parameter(self) -> float:
        """(R W^2/(E*^2 delta^3))^(1/3), delta = W/strength."""
        return tabor_parameter(self.strength)


def tabor_parameter(strength: float) -> float:
    """(R W^2/(E*^2 delta^3))^(1/3) of a strength, delta = W/strength."""
    return float((RADIUS * strength**3 / (REDUCED_MODULUS**2 * _WORK)) ** (1 / 3))


def cylinder(law: AdhesionLaw, end: float) -> Problem:
    """Return the problem of a quarter of a cylinder over a flat substrate, moved by its flat top."""
    body = Body(QuarterCylinder(RADIUS).surface(), NeoHooke(MODULUS, POISSONS_RATIO))
    return Problem(
        "cylinder",
        (body,),
        (Interface(body.side("bottom", end=end), law, Flat(-law.equilibrium_gap)),),
        (Support(body.side("left"), (0,)),),
        MovedSide("top", pi / 2),
    )


def pull_off(strength: float, elements: tuple[int, int] = _ELEMENTS) -> PulledOff:
    """Return the path of a pull-off, from the snap-on until the load is below four fifths of its maximum."""
    law = Exponential(strength, _WORK)
    reach = 14 * law.characteristic_length  # where the attraction is 3e-5 of its peak
    end = min(0.8, max(0.2, sqrt(2 * RADIUS * reach) / (pi / 4 * RADIUS)))
    farthest = _FARTHEST + 2 * law.characteristic_length
    path = np.linspace(0.0, farthest, round(_STEPS_PER_LENGTH * farthest) + 1)
    found = traced(
        cylinder(law, end),
        row_space("N2", elements, 2, (_GRADING, _GRADING)),
        path,
        NewtonSettings(path_control="auto"),
        _fallen,
    )
    return PulledOff(
        strength,
        found.parameter,
        2 * found.reaction,
        jkr_line_pull_off(_WORK, REDUCED_MODULUS, RADIUS),
        maugis_cylinder_pull_off(strength, _WORK, REDUCED_MODULUS, RADIUS),
        rigid_cylinder_pull_off(law, RADIUS),
        found.failure,
    )


def _fallen(steps: Sequence[Step]) -> bool:
    return steps[-1].reaction < 0.8 * max(step.reaction for step in steps)


def judge(outcomes: Sequence[PulledOff]) -> Result:
    """Compare each pull-off force with the theory for its Tabor parameter."""
    rows = []
    for found in outcomes:
        tabor = found.tabor_parameter
        theory, expected, allowed = _theory(found)
        rows.append(
            Row(
                found.pull_off,
                expected,
                allowed,
                (
                    f"{found.strength:g}",
                    f"{tabor:.3f}",
                    theory,
                    f"{found.pull_off / found.jkr:.4f}",
                    f"{found.pull_off / found.maugis:.4f}",
                    f"{found.pull_off / found.rigid:.4f}",
                ),
            )
        )
    half_width = (2 * _WORK * RADIUS**2 / (pi * REDUCED_MODULUS)) ** (1 / 3)
    return Result(
        quantity="pull-off force / E0 L0",
        text=(
            "A cylinder is pulled off a flat substrate by its flat middle plane: {pull-off}. The theory"
            " depends on its Tabor parameter (R W^2/(E\\*^2 delta^3))^(1/3), where delta = W/strength. Above"
            f" {CRACK_LIKE:g} the plane theory of Johnson, Kendall and Roberts must hold, F = 3 (pi E\\* W^2"
            f" R/16)^(1/3). Below {RIGID_LIKE:g} the cylinder is practically rigid, and the law is integrated"
            " over its parabola. Rows in between are for information. They are compared with the theory of"
            " Maugis, for a constant attraction of the same strength and work. The runs use an exponential"
            " law with a longer range, so that the results differ there. All theories are for half spaces."
            " The path follows the displacement of the plane. When the edge passes a node, it may jump to the"
            " next stable equilibrium."
        ),
        settings=(
            ("cylinder", f"R = {RADIUS:g}, E = {MODULUS:g}, Poisson's ratio {POISSONS_RATIO:g}; a quarter"),
            (
                "law",
                f"exponential, W = {_WORK:g}; contact at pull-off a/R = {half_width / RADIUS:.3f} by JKR",
            ),
            (
                "space",
                f"N2, degree 2 across, {_ELEMENTS[0]} x {_ELEMENTS[1]} elements graded 1:{_GRADING:g}",
            ),
            ("steps", f"{1 / _STEPS_PER_LENGTH:.4f} of displacement"),
        ),
        columns=("strength / E0", "Tabor parameter", "theory", "F/JKR", "F/Maugis", "F/rigid"),
        named_by=3,
        rows=tuple(rows),
        pictures=(
            Picture(
                "pull-off",
                "Pull-off force over the Tabor parameter, and force over the displacement of the middle plane"
                " for three strengths.",
                partial(_draw, tuple(outcomes)),
            ),
        ),
        problems=tuple(found.failure for found in outcomes if found.failure),
    )


def _theory(found: PulledOff) -> tuple[str, float, float | None]:
    """Return the theory that a row is compared with, its pull-off force, and the allowed deviation."""
    if found.tabor_parameter > CRACK_LIKE:
        return "JKR", found.jkr, ALLOWED
    if found.tabor_parameter < RIGID_LIKE:
        return "rigid", found.rigid, ALLOWED
    return "Maugis", found.maugis, None


def _draw(outcomes: Sequence[PulledOff]) -> Figure:
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 2.8), layout="constrained")
        forces, curves = figure.subplots(1, 2)
        strengths = np.geomspace(0.7 * min(_STRENGTHS), 1.4 * max(_STRENGTHS), 30)
        tabor = np.array([tabor_parameter(s) for s in strengths])
        jkr = outcomes[0].jkr
        # laws of one shape and work: the strength over the length, and so the square of the pull-off force
        weakest = rigid_cylinder_pull_off(Exponential(strengths[0], _WORK), RADIUS)
        rigid = weakest * np.sqrt(strengths / strengths[0])
        maugis = [maugis_cylinder_pull_off(s, _WORK, REDUCED_MODULUS, RADIUS) for s in strengths]
        forces.axhline(1.0, color=GREY, linestyle=DASHES, label="JKR")
        forces.plot(tabor, np.array(maugis) / jkr, color=VERMILION, linestyle=DOT_DASHES, label="Maugis")
        forces.plot(tabor, rigid / jkr, color="black", linestyle=DOTS, label="rigid, same law")
        at, values = (
            [found.tabor_parameter for found in outcomes],
            [found.pull_off / jkr for found in outcomes],
        )
        forces.plot(at, values, "o", color=BLUE, markersize=4, label="runs")
        forces.set_xscale("log")
        forces.set_ylim(0.0, 1.25)
        forces.set_xlabel("Tabor parameter")
        forces.set_ylabel("pull-off force / that of JKR")
        forces.legend(loc="lower right")
        shown = [found for found in outcomes if found.strength in _CURVES and not found.failure]
        for found, line in zip(shown, ("-", DASHES, DOTS), strict=False):
            label = f"Tabor parameter {found.tabor_parameter:.2f}"
            curves.plot(found.displacement, found.load / jkr, color=BLUE, linestyle=line, label=label)
        curves.set_xlabel("displacement of the middle plane / $L_0$")
        curves.set_ylabel("pull / pull-off force of JKR")
        curves.set_ylim(0.0, 1.25)
        if shown:
            curves.legend(loc="upper left")
        return figure


CHECK = Check("Cylinder pulled off", _STRENGTHS, pull_off, judge)
