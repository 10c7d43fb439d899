"""Two stiff blocks that a joint with damage holds together are parted in a fixed direction."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from math import atan2, hypot, sqrt

import numpy as np
from matplotlib.figure import Figure

from isopeel.common.arrays import FloatArray
from isopeel.physics.joints import MixedModeBilinear
from isopeel.physics.materials import NeoHooke
from isopeel.post.style import BLUE, DASHES, DOTS, GREY, VERMILION
from isopeel.problem import Body, Interface, MovedSide, Problem, Support
from isopeel.problem.place import placed
from isopeel.report.document import Picture
from isopeel.splines.nurbs import rectangle
from isopeel.splines.rows import row_space
from isopeel.validation.check import Check, Result, Row, traced
from isopeel.validation.one_panel import one_panel

#: The trapezoidal rule errs by a square of the step at both kinks, and the blocks yield a little, so that the
#: mode ratio changes: by less than 2e-4 of the work with 400 steps and these blocks.
ALLOWED = 1e-3
_LENGTH, _HEIGHT = 4.0, 1.0
LAW = MixedModeBilinear(1e-3, 1.5e-3, 1e-4, 3e-4, 0.2, 2.284)
_STIFF = NeoHooke(100.0, 0.0)  # K_n h/E is 2e-4
_STEPS = 400


@dataclass(frozen=True, eq=False)
class Parted:
    """Energy dissipated, work of the drive and traction over the displacement, or why there are none."""

    mixity: float
    failure: str
    dissipated: float = np.nan  # per length of the joint, as the following
    work: float = np.nan
    displacement: FloatArray = field(default_factory=lambda: np.zeros(0))
    traction: FloatArray = field(default_factory=lambda: np.zeros(0))


def part(mixity: float) -> Parted:
    """Move the upper block in the direction of a mixity until the faces are free."""
    upper = Body(rectangle(_LENGTH, _HEIGHT), _STIFF, "upper")
    lower = Body(placed(rectangle(_LENGTH, _HEIGHT), (0.0, -_HEIGHT), 0.0), _STIFF, "lower")
    K_n, K_t = LAW.stiffnesses
    energy = LAW.work_at(mixity) / LAW.rise  # at separation, of an undamaged joint
    opening, sliding = sqrt(2 * (1 - mixity) * energy / K_n), sqrt(2 * mixity * energy / K_t)
    problem = Problem(
        "blocks",
        (upper, lower),
        (Interface(upper.side("bottom"), LAW, lower.side("top")),),
        (Support(lower.side("bottom"), (0, 1)),),
        MovedSide(upper.side("top"), atan2(opening, sliding), "held"),
    )
    space = row_space("N2", (4, 1), 2)
    path = 1.01 * hypot(opening, sliding) * np.linspace(0.0, 1.0, _STEPS + 1)
    found = traced(problem, {"upper": space, "lower": space}, path)
    if found.failure:
        return Parted(mixity, found.failure)
    traction = found.reaction / _LENGTH
    work = float(np.sum((traction[1:] + traction[:-1]) / 2 * np.diff(found.parameter)))
    return Parted(mixity, "", float(found.dissipated[-1]) / _LENGTH, work, found.parameter, traction)


def judge(outcomes: Sequence[Parted]) -> Result:
    """Compare the dissipated energy and the work of the drive with the work of separation."""
    rows = []
    for found in outcomes:
        shown, work = f"{found.mixity:g}", LAW.work_at(found.mixity)
        rows += [
            Row(found.dissipated, work, ALLOWED, ("dissipated energy", shown)),
            Row(found.work, work, ALLOWED, ("work of the drive", shown)),
        ]
    return Result(
        quantity="energy per area / E0 L0",
        text=(
            "Two blocks are joined by fixed pairs, and the upper one moves in a straight line until the faces"
            " are free: {separation-traction}. The blocks are so stiff that the mixity B stays the same. The"
            " dissipated energy per area, and the work of the drive, must be the work of Benzeggagh and"
            " Kenane, G(B) = W + (G_II - W) B^eta."
        ),
        settings=(
            ("blocks", f"{_LENGTH:g} x {_HEIGHT:g}, neo-Hooke, E = 100, Poisson's ratio 0"),
            ("joint", "bilinear with damage, strengths 0.001 and 0.0015, works 0.0001 and 0.0003, rise 0.2"),
            ("space", f"N2, degree 2 across, 4 x 1 elements, {_STEPS} steps"),
        ),
        columns=("number", "B"),
        named_by=2,
        rows=tuple(rows),
        pictures=(
            Picture(
                "separation-traction",
                "Traction along the direction of the motion over the displacement, for some mixities B.",
                partial(_draw, tuple(found for found in outcomes if not found.failure)),
            ),
        ),
        problems=tuple(found.failure for found in outcomes if found.failure),
    )


def _draw(outcomes: Sequence[Parted]) -> Figure:
    with one_panel("displacement / $L_0$", "traction / $10^{-3} E_0$") as (figure, axes):
        lines = ("-", DASHES, DOTS, "-", DASHES)
        for found, line, color in zip(outcomes, lines, (BLUE, VERMILION, "black", GREY, GREY), strict=False):
            label = f"$B$ = {found.mixity:g}"
            axes.plot(found.displacement, 1e3 * found.traction, linestyle=line, color=color, label=label)
    return figure


CHECK = Check("Separation in mixed mode", (0.0, 0.25, 0.5, 0.75, 1.0), part, judge)
