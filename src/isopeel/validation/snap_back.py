"""End-notched flexure of a short crack, which snaps back, by continuation."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import sqrt

import numpy as np
from matplotlib.figure import Figure

from isopeel.common.arrays import FloatArray
from isopeel.post.closed_form import BondedBeams
from isopeel.post.style import BLUE, DASHES
from isopeel.report.document import Picture
from isopeel.solve.newton import NewtonSettings
from isopeel.validation.check import Check, Result, Row, traced
from isopeel.validation.mixed_mode import HALF_SPAN, HEIGHT, LAW, MODULUS, SHEAR_MODULUS, bonded_beams
from isopeel.validation.one_panel import one_panel

#: Slender beams; the process zone, of some two heights, is not short against the crack.
ALLOWED = 0.01
_CRACK = 58.75
#: A longer process zone than that of the other beams: there are fewer corners of the curve, one of which is
#: at each point that begins to be damaged. The curve does not depend on where the crack ends.
_SOFTER = 0.5
_LAW = replace(LAW, strength=_SOFTER * LAW.strength, shear_strength=_SOFTER * LAW.shear_strength)
_STRETCHES = ((48.0, 4.0), (52.0, 1.0), (79.0, 0.75), (88.0, 2.0), (97.0, 3.0), (103.0, 3.0), (200.0, 6.0))
#: Lengths of the crack by beam theory at which the curve is read, in L: the load that belongs to them.
_READ_AT = (0.62, 0.66, 0.7)
#: Growth after which the process zone has formed.
_FORMED = 3.0
_BEAMS = BondedBeams(MODULUS, SHEAR_MODULUS, HEIGHT, HALF_SPAN)


@dataclass(frozen=True, eq=False)
class Followed:
    """First length of the crack, displacement of the middle and load (steps,), or why there are none."""

    crack: float
    failure: str
    displacement: FloatArray = field(default_factory=lambda: np.zeros(0))
    load: FloatArray = field(default_factory=lambda: np.zeros(0))


def load_at(crack: float) -> float:
    """Return the load of beam theory under which a crack grows."""
    return sqrt(LAW.shear_work / _BEAMS.release(1.0, crack)[1])


def follow(crack: float) -> Followed:
    """Follow the curve of a crack until it has grown to 0.72 L."""
    problem, spaces = bonded_beams(0.0, _LAW, crack, _STRETCHES)
    onset = load_at(crack) * _BEAMS.compliance(crack)
    least = load_at(0.72 * HALF_SPAN)
    found = traced(
        problem,
        spaces,
        onset * np.array([0.3, 0.9, 1.1]),
        NewtonSettings(path_control="continuation"),
        lambda steps: steps[-1].reaction < least < max(step.reaction for step in steps),
    )
    if found.failure:
        return Followed(crack, found.failure)
    return Followed(crack, "", found.parameter, found.reaction)


def judge(outcomes: Sequence[Followed]) -> Result:
    """Compare the displacement with that of beam theory under the same load."""
    rows = []
    for found in outcomes:
        top = int(np.argmax(found.load)) if len(found.load) else 0
        falling, moved = found.load[top:][::-1], found.displacement[top:][::-1]
        for share in _READ_AT:
            crack = share * HALF_SPAN
            if crack < found.crack + _FORMED:
                continue
            load = load_at(crack)
            computed = np.nan if found.failure else float(np.interp(load, falling, moved))
            rows.append(
                Row(computed, load * _BEAMS.compliance(crack), ALLOWED, (f"{share:g}", f"{load:.3e}"))
            )
    return Result(
        quantity="displacement of the middle D / L0",
        text=(
            "Two bonded beams on two supports, cracked from one end, are pressed down in the middle"
            " (end-notched flexure). While a crack shorter than L/3^(1/3) = 0.69 L grows, the load and the"
            " displacement both decrease: the curve snaps back, and is followed by continuation:"
            " {snap-back-curve}. By beam theory P = (16 E' h^3 G_II/9)^(1/2)/a and D = P (3 a^3 + 2 L^3)/(8"
            " E' h^3) + 0.3 P L/(mu h), where a stands for the corrected length a + 0.42 chi h. The"
            " displacements are compared under the load P of some lengths a."
        ),
        settings=(
            ("beams", f"height h = {HEIGHT:g}, L = {HALF_SPAN:g}, neo-Hooke, E = 1, Poisson's ratio 0.2"),
            ("crack", f"{_CRACK:g} at first"),
            (
                "joint",
                f"bilinear with damage, work in sliding {_LAW.shear_work:g}, strength"
                f" {_LAW.shear_strength:.5f}",
            ),
            ("space", "N2, degree 2 across, elements of 0.75 where the crack grows"),
        ),
        columns=("a / L", "load P / E0 L0"),
        named_by=1,
        rows=tuple(rows),
        pictures=(
            Picture(
                "snap-back-curve",
                "Load over the displacement of the middle: run (line) and closed form while the crack grows"
                " (dashed).",
                partial(_draw, tuple(outcomes)),
            ),
        ),
        problems=tuple(found.failure for found in outcomes if found.failure),
    )


def _draw(outcomes: Sequence[Followed]) -> Figure:
    with one_panel("displacement $D$ / $L_0$", "load $P$ / $10^{-3} E_0 L_0$") as (figure, axes):
        for found in outcomes:
            axes.plot(found.displacement, 1e3 * found.load, color=BLUE, label="run")
        lengths = np.linspace(0.5, 0.8, 61) * HALF_SPAN
        loads = np.array([load_at(float(one)) for one in lengths])
        moved = [load_at(float(one)) * _BEAMS.compliance(float(one)) for one in lengths]
        axes.plot(
            moved,
            1e3 * loads,
            color="black",
            linestyle=DASHES,
            linewidth=0.8,
            label="beam theory, growing crack",
        )
        axes.set_ylim(bottom=0.0)
    return figure


CHECK = Check("Snap-back in end-notched flexure", (_CRACK,), follow, judge)
