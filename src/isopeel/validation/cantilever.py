"""The double cantilever beam, by forces and by moments, against beam theory."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import sqrt

import numpy as np
from matplotlib.figure import Figure

from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion import Exponential
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.materials import NeoHooke
from isopeel.physics.substrates import Flat
from isopeel.post.closed_form import double_cantilever_force, double_cantilever_moment
from isopeel.post.style import BLUE, DASHES, TWO_COLUMNS, style
from isopeel.problem import Body, Drive, Interface, Problem, PulledSide, RotatedSide, Support
from isopeel.report.document import Picture
from isopeel.splines.nurbs import rectangle
from isopeel.splines.rows import row_space
from isopeel.validation.check import Check, Result, Row, traced

ALLOWED = 0.01
_HEIGHT, _LENGTH, _CRACK = 10.0, 300.0, 60.0
_LONGEST = 200.0  # crack at the end of a path
_MODULUS, _POISSONS_RATIO = 1.0, 0.2
_PLANE_STRAIN = _MODULUS / (1 - _POISSONS_RATIO**2)
_BENDING = _PLANE_STRAIN * _HEIGHT**3 / 12
_ENERGY = 5e-5 * _PLANE_STRAIN * _HEIGHT / 12  # G
_STRENGTH = 0.003
_CURVATURE = sqrt(_ENERGY / _BENDING)  # of an arm at the crack tip
_ELEMENTS = (200, 2)
_STEPS = 150
#: Crack lengths by beam theory, in heights of an arm, at which a path is compared.
_READ_AT = (10.0, 12.0, 14.0, 16.0, 18.0, 20.0)


@dataclass(frozen=True)
class Loading:
    """The drive of the end of each arm, its last parameter, and the solution of beam theory.

    `beam` maps parameters (n,) to lengths of the crack and reactions, (n,) each. In figures the parameter is
    multiplied by `factor`.
    """

    name: str
    drive: Drive
    end: float
    beam: Callable[[FloatArray], tuple[FloatArray, FloatArray]]
    factor: float
    labels: tuple[str, str]


def _by_force(displacement: FloatArray) -> tuple[FloatArray, FloatArray]:
    forces = [double_cantilever_force(_ENERGY, _BENDING, 2 * value) for value in displacement]
    return np.sqrt(3 * displacement / _CURVATURE), np.array(forces)


def _by_moment(angle: FloatArray) -> tuple[FloatArray, FloatArray]:
    return angle / _CURVATURE, np.full_like(angle, double_cantilever_moment(_ENERGY, _BENDING))


FORCE = Loading(
    "force",
    PulledSide("right", np.pi / 2),
    _CURVATURE * _LONGEST**2 / 3,
    _by_force,
    2.0,
    ("opening $D$ / $L_0$", "force $P$ / $10^{-3} E_0 L_0$"),
)
MOMENT = Loading(
    "moment",
    RotatedSide("right"),
    _CURVATURE * _LONGEST,
    _by_moment,
    180 / np.pi,
    ("rotation of an end / degree", "moment $M$ / $10^{-3} E_0 L_0^2$"),
)


@dataclass(frozen=True, eq=False)
class Opened:
    """A path: parameter and reaction of an arm, over the crack's length by beam theory."""

    loading: Loading
    crack: FloatArray  # (steps,)
    parameter: FloatArray  # (steps,)
    reaction: FloatArray  # (steps,)
    expected: FloatArray  # (steps,)
    failure: str


def pull(loading: Loading, elements: tuple[int, int] = _ELEMENTS, steps: int = _STEPS) -> Opened:
    """Trace one arm as it opens from its mirror plane, with the joint between both."""
    law = Mirrored(Exponential(_STRENGTH, _ENERGY))
    body = Body(rectangle(_LENGTH, _HEIGHT), NeoHooke(_MODULUS, _POISSONS_RATIO))
    joint = body.side("bottom", end=1 - _CRACK / _LENGTH)
    problem = Problem(
        "double cantilever beam",
        (body,),
        (Interface(joint, law, Flat(-law.equilibrium_gap)),),
        (Support(body.side("left"), (0,)),),
        loading.drive,
    )
    path = np.linspace(0.0, loading.end, steps + 1)[1:]
    found = traced(problem, row_space("N2.1", elements, 2), path)
    crack, expected = loading.beam(found.parameter)
    return Opened(loading, crack, found.parameter, found.reaction, expected, found.failure)


def judge(outcomes: Sequence[Opened]) -> Result:
    """Compare the paths with beam theory at some crack lengths."""
    rows = []
    for found in outcomes:
        for crack in _READ_AT:
            reached = len(found.crack) > 0 and found.crack[-1] >= crack * _HEIGHT * (1 - 1e-9)
            computed, expected = (
                float(np.interp(crack * _HEIGHT, found.crack, values)) if reached else np.nan
                for values in (found.reaction, found.expected)
            )
            rows.append(Row(computed, expected, ALLOWED, (found.loading.name, f"{crack:g}")))
    return Result(
        quantity="P / E0 L0, M / E0 L0^2",
        text=(
            "One arm is modelled, and the law of the joint acts between it and its mirror image. Forces"
            " open the arms by D = 2 d at P = sqrt(2/3) G^(3/4) (E'I)^(1/4) D^(-1/2). Moments open them at M"
            " = sqrt(G E'I), for any length of the crack: {double-cantilever}. A rotation of the arm's"
            " root lengthens the crack; this has no effect on the force at a given D. The reaction is read"
            " where beam theory has the crack length a. The force is a dead traction of unknown size on the"
            " end of the arm, so that the end can rotate and deform. If all points of the end moved by the"
            " same displacement, a rotation would stretch the end across, and a moment would act on it."
        ),
        settings=(
            ("arm, joint", f"height {_HEIGHT:g}, length {_LENGTH:g}, crack {_CRACK:g} at first"),
            ("material", f"neo-Hooke, E = {_MODULUS:g}, Poisson's ratio {_POISSONS_RATIO:g}"),
            ("joint", f"exponential law, strength {_STRENGTH:g}, G = {_ENERGY:.4g}"),
            ("space", f"N2.1, degree 2 across, {_ELEMENTS[0]} x {_ELEMENTS[1]} elements, {_STEPS} steps"),
        ),
        columns=("driven by", "a / h"),
        named_by=2,
        rows=tuple(rows),
        pictures=(
            Picture(
                "double-cantilever",
                "Force on each arm over the opening of both, and moment over the rotation of an end: run"
                " (lines) and closed forms (dashed).",
                partial(_draw, tuple(outcomes)),
            ),
        ),
        problems=tuple(found.failure for found in outcomes if found.failure),
    )


def _draw(outcomes: Sequence[Opened]) -> Figure:
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 2.6), layout="constrained")
        panels = figure.subplots(1, len(outcomes), squeeze=False)[0]
        for axes, found in zip(panels, outcomes, strict=True):
            place = found.loading.factor * found.parameter
            axes.plot(place, 1e3 * found.reaction, color=BLUE, label="run")
            valid = found.crack > _CRACK
            closed = 1e3 * found.expected[valid]
            axes.plot(
                place[valid], closed, color="black", linestyle=DASHES, linewidth=0.8, label="closed form"
            )
            axes.set_xlabel(found.loading.labels[0])
            axes.set_ylabel(found.loading.labels[1])
            axes.set_ylim(bottom=0.0)
            axes.set_xlim(left=0.0)
            axes.legend()
        return figure


CHECK = Check("Double cantilever beam", (FORCE, MOMENT), pull, judge)
