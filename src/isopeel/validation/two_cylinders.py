"""Two elastic cylinders pressed together and pulled apart: the line contacts of Hertz and of Johnson."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from math import pi, sqrt

import numpy as np
from matplotlib.figure import Figure

from isopeel.assembly.interface import InterfacePoints
from isopeel.assembly.system import System
from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion import AdhesionLaw, Contact, Exponential
from isopeel.physics.materials import NeoHooke
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.post.closed_form import HertzLine, hertz_line, jkr_line_pull_off
from isopeel.post.style import BLUE, DASHES, GREY, TWO_COLUMNS, VERMILION, style
from isopeel.problem import Body, Interface, MovedSide, Problem, Support
from isopeel.problem.shapes.quarter_cylinder import QuarterCylinder
from isopeel.report.document import Picture
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.step import Step
from isopeel.splines.nurbs import NurbsSurface
from isopeel.splines.rows import RowSpace, row_space
from isopeel.validation.check import Check, Result, Row, traced

#: Half spaces with parabolas, for contacts of a twentieth of the radius; the edge is smoothed by the mesh.
ALLOWED_PRESSED = 0.01
#: As for a cylinder on a rigid substrate: the law has a reach, and the closed form none.
ALLOWED_PULLED = 0.02
#: Sums of as many forces as there are functions, each exact to its last digit.
ROUND_OFF = 1e-11
_RADII = (100.0, 200.0)
_MATERIALS = (NeoHooke(1.0, 0.3), NeoHooke(2.0, 0.4))
RADIUS = 1 / sum(1 / radius for radius in _RADII)
REDUCED_MODULUS = 1 / sum(1 / plane_strain_modulus(material) for material in _MATERIALS)
_WORK, _STRENGTH = 1e-3, 0.06
_FITTED = 0.9  # share of the half-width by Hertz, as on a rigid substrate
_GRADING = 200.0
_STEPS = 12
_STEPS_PER_LENGTH, _FARTHEST = 240, 0.4


@dataclass(frozen=True)
class Loading:
    """Two cylinders pressed together by a displacement, or pulled apart if it is zero; and the elements."""

    pressed: float
    elements: tuple[int, int]


@dataclass(frozen=True, eq=False)
class Met:
    """What a path gives at its end; nan where it has none."""

    loading: Loading
    failure: str
    load: float = np.nan  # pressed together, or the largest pull
    half_width: float = np.nan
    peak_pressure: float = np.nan
    overlap: float = np.nan  # largest
    forces: tuple[float, float] = (np.nan, np.nan)  # across, on both bodies
    moments: tuple[float, float] = (np.nan, np.nan)
    place: FloatArray = field(default_factory=lambda: np.zeros(0))
    pressure: FloatArray = field(default_factory=lambda: np.zeros(0))
    displacement: FloatArray = field(default_factory=lambda: np.zeros(0))
    pull: FloatArray = field(default_factory=lambda: np.zeros(0))

    @property
    def hertz(self) -> HertzLine:
        """Hertz's solution for the load."""
        return hertz_line(self.load, REDUCED_MODULUS, RADIUS)


def meet(loading: Loading) -> Met:
    """Press two cylinders together, or pull them apart until the pull has fallen by a fifth."""
    if loading.pressed:
        return _press(loading)
    law = Exponential(_STRENGTH, _WORK)
    farthest = _FARTHEST + 2 * law.characteristic_length
    path = np.linspace(0.0, farthest, round(_STEPS_PER_LENGTH * farthest) + 1)
    problem, spaces = _two_cylinders(law, 0.2), _spaces(loading.elements)
    found = traced(problem, spaces, path, NewtonSettings(path_control="auto"), _fallen)
    if found.failure:
        return Met(loading, found.failure)
    pull = 2 * found.reaction
    return Met(loading, "", float(pull.max()), displacement=found.parameter, pull=pull)


def _fallen(steps: Sequence[Step]) -> bool:
    return steps[-1].reaction < 0.8 * max(step.reaction for step in steps)


def _two_cylinders(law: AdhesionLaw, end: float) -> Problem:
    """Return the problem of the right halves of two cylinders, the upper one moved by its middle plane."""
    upper = Body(QuarterCylinder(_RADII[0]).surface(), _MATERIALS[0], "upper")
    lower = Body(_upside_down(QuarterCylinder(_RADII[1]).surface()), _MATERIALS[1], "lower")
    joint = Interface(upper.side("bottom", end=end), law, lower.side("top", end=end))
    held = (
        Support(upper.side("left"), (0,)),
        Support(lower.side("left"), (0,)),
        Support(lower.side("bottom"), (0, 1)),
    )
    return Problem("two cylinders", (upper, lower), (joint,), held, MovedSide(upper.side("top"), pi / 2))


def _upside_down(shape: NurbsSurface) -> NurbsSurface:
    """Return the mirror image below the x axis; its sides bottom and top change places."""
    points = shape.control_points[:, ::-1] * np.array([1.0, -1.0])
    return NurbsSurface(shape.spaces, points, shape.weights[:, ::-1])


def _spaces(elements: tuple[int, int]) -> dict[str, RowSpace]:
    along, across = elements
    return {
        "upper": row_space("N2", (along, across), 2, (_GRADING, _GRADING)),
        # so that no two elements match
        "lower": row_space("N2", (round(0.9 * along), across), 2, (_GRADING, 1 / _GRADING)),
    }


def _press(loading: Loading) -> Met:
    problem, spaces = _two_cylinders(Contact(), 0.2), _spaces(loading.elements)
    path = -np.geomspace(loading.pressed / 400, loading.pressed, _STEPS)
    found = traced(problem, spaces, path, NewtonSettings(path_control="auto"))
    if found.failure or found.displacement is None:
        return Met(loading, found.failure)
    load = -2 * float(found.reaction[-1])
    state = InterfacePoints.of_contact(problem, spaces, interface="upper.bottom").state(found.displacement)
    place, pressure = state.position[..., 0].ravel(), state.normal_traction.ravel()
    inside = place < _FITTED * hertz_line(load, REDUCED_MODULUS, RADIUS).half_width
    slope, square = np.polyfit(place[inside] ** 2, pressure[inside] ** 2, 1)
    system = System(problem, spaces)
    u = found.displacement
    forces = system.equilibrium(u).forces - system.without_joint().equilibrium(u).forces
    x = system.spaces.control_points() + u
    moments = x[:, 0] * forces[:, 1] - x[:, 1] * forces[:, 0]
    parts = system.spaces.places["upper"], system.spaces.places["lower"]
    return Met(
        loading,
        "",
        load,
        sqrt(-square / slope),
        sqrt(square),
        -float(state.gap.min()),
        (float(forces[parts[0], 1].sum()), float(forces[parts[1], 1].sum())),
        (float(moments[parts[0]].sum()), float(moments[parts[1]].sum())),
        place,
        pressure,
    )


def judge(outcomes: Sequence[Met]) -> Result:
    """Compare half-widths, peak pressures and the pull-off force, and the forces on both bodies."""
    rows = []
    for found in outcomes:
        if found.loading.pressed:
            hertz = found.hertz
            load, overlap = f"{found.load:.5f}", f"{found.overlap / hertz.half_width:.1e}"
            rows += [
                Row(found.half_width, hertz.half_width, ALLOWED_PRESSED, ("a / L0", load, overlap)),
                Row(found.peak_pressure, hertz.peak_pressure, ALLOWED_PRESSED, ("p_0 / E0", load, overlap)),
                Row(found.forces[0], -found.forces[1], ROUND_OFF, ("force / E0 L0", load, "")),
                Row(found.moments[0], -found.moments[1], ROUND_OFF, ("moment / E0 L0^2", load, "")),
            ]
        else:
            pull_off = jkr_line_pull_off(_WORK, REDUCED_MODULUS, RADIUS)
            rows.append(
                Row(found.load, pull_off, ALLOWED_PULLED, ("pull-off / E0 L0", f"{-found.load:.5f}", ""))
            )
    return Result(
        quantity="half-width a, peak pressure p_0, force and moment of the contact, pull-off force",
        text=(
            "Two cylinders of different radii and materials are pressed together, and pulled apart, by the"
            " middle plane of the upper one: {cylinders-pressure}. The middle plane of the lower one is"
            " held. No two elements match. In the contact, the law only repels, with the stiffness that is"
            " chosen if none is given; the table has the largest overlap over the half-width. The line p^2"
            f" = p_0^2 (1 - x^2/a^2) is fitted to the pressures of the Gauss points with x < {_FITTED:g} a."
            " Its a and p_0 are compared with a = sqrt(4 P R/(pi E\\*)) and p_0 = 2 P/(pi a), where 1/R ="
            " 1/R_1 + 1/R_2 and 1/E\\* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2. The forces of the contact on"
            " both bodies, and their moments about the first point of contact, must be opposite to"
            " round-off. The pull-off force is that of Johnson, Kendall and Roberts, 3 (pi E\\* W^2"
            " R/16)^(1/3), as for a cylinder on a rigid substrate."
        ),
        settings=(
            (
                "cylinders",
                "R = 100, E = 1, Poisson's ratio 0.3; R = 200, E = 2, Poisson's ratio 0.4; quarters",
            ),
            ("law of the pull-off", f"exponential, strength {_STRENGTH:g} E0, W = {_WORK:g} E0 L0"),
            ("space", f"N2, degree 2 across, graded 1:{_GRADING:g}"),
        ),
        columns=("number", "load P / E0 L0", "overlap / a"),
        named_by=2,
        rows=tuple(rows),
        pictures=(
            Picture(
                "cylinders-pressure",
                "Pressure between two cylinders over x, in Hertz's units; and the pull over the"
                " displacement of the middle plane.",
                partial(_draw, tuple(found for found in outcomes if not found.failure)),
            ),
        ),
        problems=tuple(found.failure for found in outcomes if found.failure),
    )


def _draw(outcomes: Sequence[Met]) -> Figure:
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 2.8), layout="constrained")
        pressures, pulls = figure.subplots(1, 2)
        x = np.linspace(0.0, 1.0, 401)
        pressures.plot(x, np.sqrt(1 - x**2), color=GREY, linestyle=DASHES, label="Hertz")
        pressed = [found for found in outcomes if found.loading.pressed]
        for found, color, marker in zip(pressed, (BLUE, VERMILION), "os", strict=False):
            place = found.place / found.hertz.half_width
            chosen = place < 1.15
            pressures.plot(
                place[chosen],
                found.pressure[chosen] / found.hertz.peak_pressure,
                color=color,
                marker=marker,
                markersize=3,
                linestyle="none",
                markevery=4,
                label=f"$P$ = {found.load:.3f} $E_0 L_0$",
            )
        pressures.legend(loc="lower left")
        pressures.set_xlabel("place $x/a$")
        pressures.set_ylabel("pressure $p/p_0$")
        pull_off = jkr_line_pull_off(_WORK, REDUCED_MODULUS, RADIUS)
        pulls.axhline(1.0, color=GREY, linestyle=DASHES)
        for found in outcomes:
            if not found.loading.pressed:
                pulls.plot(found.displacement, found.pull / pull_off, color=BLUE)
        pulls.set_xlabel("displacement of the middle plane / $L_0$")
        pulls.set_ylabel("pull / pull-off force of JKR")
        return figure


_CASES = (Loading(0.1, (120, 12)), Loading(0.25, (120, 12)), Loading(0.0, (100, 12)))
CHECK = Check("Two cylinders", _CASES, meet, judge)
