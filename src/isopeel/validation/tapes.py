"""Tapes peeled by a force at an angle, against the balances of energy of Kendall and of sliding tapes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from math import cos, radians, sqrt
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from isopeel.common.arrays import FloatArray
from isopeel.physics.batch import evaluate_material
from isopeel.physics.materials import Material, NeoHooke
from isopeel.physics.materials.prestretched import Prestretched
from isopeel.post.closed_form import kendall_force, sliding_tape_force
from isopeel.post.style import (
    BLUE,
    DASHES,
    DOT_DASHES,
    DOTS,
    FIELD_MAP,
    GREEN,
    GREY,
    LONG_DASHES,
    PURPLE,
    TWO_COLUMNS,
    VERMILION,
    style,
)
from isopeel.problem import Problem, PulledSide, strip
from isopeel.report.document import Picture
from isopeel.splines.rows import row_space
from isopeel.validation.check import Check, Result, Row, traced

ALLOWED = 0.01
_LENGTH, _ADHERING, _HEIGHT = 160.0, 140.0, 4.0
_SLIDING_LENGTH = 0.3
_ELEMENTS = (160, 3)
_PERIODS, _STEPS_PER_PERIOD = 4, 8


@dataclass(frozen=True)
class Tape:
    """A tape pulled at an angle until its free arm is `arm` elastica lengths sqrt(E'I/F) long.

    It is `held` along the substrate, or slides on it. It was laid with the given `stretch`.
    """

    angle_deg: float
    arm: float
    held: bool = True
    stretch: float = 1.0

    @property
    def kind(self) -> str:
        """Held, sliding, or held after it was stretched."""
        if not self.held:
            return "sliding"
        return "held" if self.stretch == 1 else f"held, laid with stretch {self.stretch:g}"

    @cached_property
    def problem(self) -> Problem:
        """The problem: a thinner strip of the shipped strip's material and law, pulled at its right end."""
        soft = NeoHooke(youngs_modulus=1.0, poissons_ratio=0.2)
        material: Material = soft if self.stretch == 1 else Prestretched(soft, self.stretch)
        made = strip(length=_LENGTH, height=_HEIGHT, adhering_length=_ADHERING, material=material)
        return made.changed(
            adhesion=replace(made.adhesion, sliding_length=_SLIDING_LENGTH if self.held else None),
            drive=PulledSide("right", radians(self.angle_deg)),
        )

    @cached_property
    def as_laid(self) -> tuple[float, float]:
        """Tension P_0 of the tape as laid, and its stiffness E' h in that state, without stress across."""
        material = self.problem.body.material
        _, stress, tangent = evaluate_material(material.kernel, material.parameters, np.eye(2)[None])
        A = tangent[0]
        modulus = A[0, 0, 0, 0] - A[0, 0, 1, 1] * A[1, 1, 0, 0] / A[1, 1, 1, 1]
        return float(stress[0, 0, 0] * _HEIGHT), float(modulus * _HEIGHT)

    @property
    def kendall(self) -> float:
        """The closed form of the force of a tape that is held."""
        tension, stiffness = self.as_laid
        return kendall_force(self._work, stiffness, radians(self.angle_deg), tension)

    @property
    def sliding(self) -> float:
        """The closed form of the force of a tape that slides."""
        return sliding_tape_force(self._work, self.as_laid[1], radians(self.angle_deg))

    @property
    def expected(self) -> float:
        """The force of the closed form for this tape."""
        return self.kendall if self.held else self.sliding

    @property
    def rate(self) -> float:
        """Displacement of the force along its direction, per length that peels."""
        tension, stiffness = self.as_laid
        return 1 - cos(radians(self.angle_deg)) + (self.expected - tension) / stiffness

    @property
    def elastica_length(self) -> float:
        """sqrt(E'I/F), the decay length of the bending of the free arm."""
        return sqrt(self.as_laid[1] * _HEIGHT**2 / 12 / self.expected)

    @property
    def _work(self) -> float:
        return self.problem.adhesion.law.work_of_adhesion


@dataclass(frozen=True, eq=False)
class Pulled:
    """A tape's force over the displacement, and its steady value."""

    tape: Tape
    displacement: FloatArray
    force: FloatArray
    steady: float
    drift: float  # from the first period of the mean to the last
    failure: str


def peel(tape: Tape, elements: tuple[int, int] = _ELEMENTS) -> Pulled:
    """Pull a tape, and return the mean force over the last periods of the mesh."""
    end = tape.arm * tape.elastica_length * tape.rate
    start = end - _PERIODS * tape.rate * _LENGTH / elements[0]
    path = [
        *np.linspace(0.0, start, 150)[:-1],
        *np.linspace(start, end, _PERIODS * _STEPS_PER_PERIOD + 1),
    ]
    found = traced(tape.problem, row_space("N2.1", elements), path)
    if found.failure:
        return Pulled(tape, found.parameter, found.reaction, np.nan, np.nan, found.failure)
    means = found.reaction[-_PERIODS * _STEPS_PER_PERIOD :].reshape(_PERIODS, -1).mean(axis=1)
    return Pulled(tape, found.parameter, found.reaction, float(means.mean()), float(means[-1] - means[0]), "")


def judge(outcomes: Sequence[Pulled]) -> Result:
    """Compare steady forces with the closed form of each tape."""
    rows = tuple(
        Row(
            found.steady,
            found.tape.expected,
            ALLOWED,
            (
                f"{found.tape.angle_deg:g}",
                found.tape.kind,
                f"{found.tape.arm:g}",
                f"{100 * found.drift / found.tape.expected:.3f}",
                f"{found.steady / replace(found.tape, held=True).kendall:.4f}",
            ),
        )
        for found in outcomes
    )
    text = (
        "A tape is pulled by a force at an angle to the substrate: {tape-forces}. A tape that is held along"
        " the substrate peels at Kendall's force, (F - P_0)^2/(2 E' h) + F (1 - cos angle) = W, with the"
        " tension P_0 and the stiffness E' h of the tape as it was laid. The displacement along the force is"
        " prescribed, and the force is an unknown. It reaches its steady value when the free arm is several"
        " elastica lengths sqrt(E'I/F) long; a shorter arm does not point along the force yet. The table has"
        " the length of the arm at which the force is read, by the closed form and in elastica lengths. The"
        f" force is the mean over the last {_PERIODS} periods of the mesh. In one period one element peels."
        " The column drift is the change of the mean from the first of these periods to the last."
    )
    free = [found for found in outcomes if not found.tape.held and not found.failure]
    if free:
        steep = min(free, key=lambda found: found.tape.angle_deg)
        text += (
            "\n\nA tape on a substrate without friction slides, and does not peel at Kendall's force. At"
            f" {steep.tape.angle_deg:g} degrees its force is {steep.steady / steep.tape.kendall:.3f} times"
            f" Kendall's. It is {steep.steady / steep.tape.expected:.4f} times the solution F of"
            " F (1 - cos angle) + F^2 sin^2(angle)/(2 E' h) = W, since the adhering part is stretched too."
        )
    return Result(
        quantity="force F / E0 L0",
        text=text,
        settings=(
            ("tape", f"height {_HEIGHT:g}, length {_LENGTH:g}, of which {_ADHERING:g} adhere at first"),
            ("material", "neo-Hooke, E = 1, Poisson's ratio 0.2"),
            (
                "law",
                "van der Waals, W = 0.0153; held tapes have the sliding length " + f"{_SLIDING_LENGTH:g}",
            ),
            ("space", f"N2.1, {_ELEMENTS[0]} x {_ELEMENTS[1]} elements"),
        ),
        columns=("angle / degree", "tape", "arm / sqrt(E'I/F)", "drift / %", "F/Kendall"),
        named_by=2,
        rows=rows,
        pictures=(
            Picture(
                "tape-forces",
                "Steady force over the angle, of runs (marks) and closed forms (lines); and the force of"
                " tapes that are held over the displacement d, in elastica lengths, where v is the"
                " displacement per peeled length in the steady state.",
                partial(_draw, tuple(outcomes)),
            ),
        ),
        problems=tuple(found.failure for found in outcomes if found.failure),
    )


def _draw(outcomes: Sequence[Pulled]) -> Figure:
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 2.9), layout="constrained")
        forces, ways = figure.subplots(1, 2)
        _draw_forces(forces, outcomes)
        _draw_ways(ways, outcomes)
        return figure


def _draw_forces(axes: Axes, outcomes: Sequence[Pulled]) -> None:
    """Draw steady forces over Kendall's for a tape laid without stretch: so one per cent is visible."""
    angle = np.linspace(20.0, 160.0, 141)
    plain = np.array([Tape(value, 1.0).kendall for value in angle])
    kinds: dict[str, list[Pulled]] = {}
    for found in outcomes:
        kinds.setdefault(found.tape.kind, []).append(found)
    for (kind, members), (color, marker, line) in zip(kinds.items(), _LOOKS, strict=False):
        expected = [replace(members[0].tape, angle_deg=value).expected for value in angle]
        axes.plot(angle, np.array(expected) / plain, color=color, linestyle=line, linewidth=0.9)
        ratios = [found.steady / Tape(found.tape.angle_deg, 1.0).kendall for found in members]
        places = [found.tape.angle_deg for found in members]
        marks: dict[str, Any] = {
            "linestyle": "none",
            "marker": marker,
            "markersize": 5,
            "markerfacecolor": "white",
        }
        axes.plot(places, ratios, color=color, label=kind, **marks)
    axes.set_xlabel("angle / degree")
    axes.set_ylabel("steady force / Kendall's, unstretched")
    axes.legend()


def _is_plain(tape: Tape) -> bool:
    return tape.held and tape.stretch == 1


def _draw_ways(axes: Axes, outcomes: Sequence[Pulled]) -> None:
    held = [found for found in outcomes if _is_plain(found.tape) and len(found.force)]
    axes.axhline(1.0, color=GREY, linewidth=0.6)
    for found, line, shade in zip(held, _LINES, np.linspace(0.0, 0.75, len(held)), strict=False):
        tape = found.tape
        peeled = found.displacement / tape.rate / tape.elastica_length
        color = colormaps[FIELD_MAP](shade)
        axes.plot(
            peeled, found.force / tape.expected, color=color, linestyle=line, label=f"{tape.angle_deg:g}°"
        )
    axes.set_xlim(0.0, 5.0)
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel(r"displacement $d / (v \sqrt{E'I/F})$")
    axes.set_ylabel("force / Kendall's")
    if held:
        axes.legend(loc="upper right", title="angle")


_LINES = ("-", LONG_DASHES, DASHES, DOT_DASHES, DOTS)
_LOOKS = ((BLUE, "o", "-"), (VERMILION, "s", DOT_DASHES), (GREEN, "^", DASHES), (PURPLE, "D", DOTS))
_TAPES = (
    Tape(30.0, 8.0),
    Tape(60.0, 5.5),
    Tape(90.0, 5.0),
    Tape(120.0, 4.6),
    Tape(150.0, 4.2),
    Tape(30.0, 12.0, held=False),
    Tape(45.0, 8.0, held=False),
    Tape(30.0, 6.0, stretch=1.03),
    Tape(90.0, 5.0, stretch=1.03),
)
CHECK = Check("Tapes", _TAPES, peel, judge)
