"""Two arms that adhere to each other: peeled by forces or moments, or a tape on a soft layer."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import pi, sqrt

import numpy as np
from matplotlib.figure import Figure

from isopeel.common.arrays import FloatArray
from isopeel.common.quantities import Length, Stress, SurfaceEnergy
from isopeel.physics.adhesion import AdhesionLaw, Exponential
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.adhesion.normal import NormalLaw, normal_law
from isopeel.physics.joints import JointLaw, XuNeedleman
from isopeel.physics.materials import Material, NeoHooke
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.physics.substrates import Flat
from isopeel.post.closed_form import kendall_force
from isopeel.post.style import BLUE, DASHES, DOTS, GREEN, GREY, VERMILION
from isopeel.problem import Body, Drive, Interface, Problem, PulledSide, RotatedSide, Support
from isopeel.problem.place import placed
from isopeel.report.document import Picture
from isopeel.splines.nurbs import rectangle
from isopeel.splines.rows import RowSpace, row_space
from isopeel.validation.check import Check, EquilibriumPath, Result, Row, traced
from isopeel.validation.one_panel import one_panel

#: A force that both arms share is steady, and the energy of the interface is exact.
ALLOWED_FORCE = 0.005
#: Beams of small strain; here it is 4 % at the surface of the thinner arm.
ALLOWED_MOMENT = 0.01
#: A point is nearer to the closest point of an inclined side than to the opposite one.
ALLOWED_COPY = 0.003
#: Fixed pairs of points are mirror images of each other. Newton's method leaves 3e-11 of the moment.
ALLOWED_PAIRS = 1e-9
_FREE = 10.0  # length that does not adhere
_MATERIAL = NeoHooke(1.0, 0.2)
_HEIGHT = 3.0
_PULLED = Exponential(0.02, 0.0153)
_TURNED = Exponential(0.005, 1e-3)
#: Its work is the same whatever the mode ratio. In pure opening it is `_Opening`.
_BONDED = XuNeedleman(0.005, 0.005, 1e-3)
_PAIRED = XuNeedleman(0.02, 0.02, 0.0153)
_UNEQUAL = (3.0, 4.0)
_SOFT, _SOFT_HEIGHT = NeoHooke(0.1, 0.4), 6.0
_PERIODS, _STEPS_PER_PERIOD = 3, 8
_LAST = _PERIODS * _STEPS_PER_PERIOD
_ANGLES = np.radians(np.arange(0.0, 31.0, 2.0))
_READ_AT = (5, 10, 15)  # numbers of angles


@normal_law
class _Opening(NormalLaw):
    """The law of `XuNeedleman` without sliding. Other than `Exponential` it is exponential in compression."""

    strength: Stress
    work_of_adhesion: SurfaceEnergy
    equilibrium_gap: Length = 0.0

    def constants(self) -> tuple[float, ...]:
        """W and the opening of strongest attraction."""
        return self.work_of_adhesion, self.work_of_adhesion / (np.e * self.strength)

    @staticmethod
    def at_point(opening: float, W: float, d: float) -> tuple[float, float, float]:
        """Return potential, traction and its derivative."""
        x = opening / d
        decay = np.exp(-x)
        return -W * (1.0 + x) * decay, -W / d * x * decay, -W / d**2 * (1.0 - x) * decay


@dataclass(frozen=True, eq=False)
class Peeled:
    """A reaction or another number over the parameter of the drive, and what is expected of it."""

    name: str
    parameter: FloatArray
    number: FloatArray
    expected: FloatArray
    compared: tuple[int, ...]  # steps at which it is compared
    averaged: int  # the last steps, over which it is averaged; zero for none
    allowed: float
    failure: str


def peel(name: str) -> Peeled:
    """Compute one of the cases by its name."""
    return _RUNS[name]()


def _joined(
    lower_height: float,
    length: float,
    law: AdhesionLaw | JointLaw,
    elements: int,
    lower_material: Material = _MATERIAL,
) -> tuple[Body, Body, Interface, dict[str, RowSpace]]:
    """Return an arm on another body, the interface between them, and their spaces."""
    upper = Body(rectangle(length, _HEIGHT), _MATERIAL, "upper")
    place = (0.0, -lower_height - law.equilibrium_gap)
    lower = Body(placed(rectangle(length, lower_height), place, 0.0), lower_material, "lower")
    end = 1 - _FREE / length
    joint = Interface(upper.side("bottom", end=end), law, lower.side("top", end=end))
    rows = 1 if lower_material is _MATERIAL else 2
    spaces = {"upper": row_space("N2.1", (elements, 1), 2), "lower": row_space("N2.1", (elements, rows), 2)}
    return upper, lower, joint, spaces


def _pulled(
    problem: Problem, spaces: dict[str, RowSpace], share: float, length: float, arm: float
) -> EquilibriumPath:
    """Pull across until an arm of elastica lengths has peeled; a share of the work is that of one arm."""
    stiffness = plane_strain_modulus(_MATERIAL) * _HEIGHT
    force = _steady(share)
    elastica = sqrt(stiffness * _HEIGHT**2 / 12 / force)
    rate = (1 + force / stiffness) / share  # of the parameter by the peeled length
    elements = spaces["upper"].elements[0]
    end = arm * elastica * rate
    start = end - _PERIODS * rate * length / elements
    path = [*np.linspace(0.0, start, 60)[:-1], *np.linspace(start, end, _LAST + 1)]
    return traced(problem, spaces, path)


def _steady(share: float) -> float:
    """Return the force S of S + S^2/(2 E' h) = share W, Kendall's at 90 degrees."""
    stiffness = plane_strain_modulus(_MATERIAL) * _HEIGHT
    return kendall_force(share * _PULLED.work_of_adhesion, stiffness, pi / 2)


def _t_peel() -> Peeled:
    length, elements = 130.0, 65
    upper, lower, joint, spaces = _joined(_HEIGHT, length, _PULLED, elements)
    drive = PulledSide(((upper.side("right"), 1.0), (lower.side("right"), -1.0)), pi / 2)
    held = Support(upper.side("left"), (0, 1)), Support(lower.side("left"), (0, 1))
    problem = Problem("T-peel", (upper, lower), (joint,), held, drive)
    found = _pulled(problem, spaces, 0.5, length, 4.5)
    return _mean("T-peel, S", found, found.reaction, _steady(0.5), _LAST, ALLOWED_FORCE)


def _on_a_soft_layer() -> Peeled:
    length, elements = 90.0, 45
    upper, lower, joint, spaces = _joined(_SOFT_HEIGHT, length, _PULLED, elements, _SOFT)
    held = Support(upper.side("left"), (0,)), Support(lower.side("bottom"), (0, 1))
    drive: Drive = PulledSide(upper.side("right"), pi / 2)
    problem = Problem("soft substrate", (upper, lower), (joint,), held, drive)
    found = _pulled(problem, spaces, 1.0, length, 4.0)
    return _mean("tape on a soft layer, S", found, found.reaction, _steady(1.0), _LAST, ALLOWED_FORCE)


def _unequal_arms(law: AdhesionLaw) -> Peeled:
    length, elements, steps = 100.0, 50, 30
    upper, lower, joint, spaces = _joined(_UNEQUAL[1], length, law, elements)
    drive = RotatedSide(((upper.side("right"), 1.0), (lower.side("right"), -1.0)))
    held = Support(upper.side("left"), (0, 1)), Support(lower.side("left"), (0, 1))
    problem = Problem("unequal arms", (upper, lower), (joint,), held, drive)
    found = traced(problem, spaces, np.radians(np.linspace(0.0, 50.0, steps + 1)))
    released, paired = np.full(found.parameter.shape, np.nan), isinstance(law, JointLaw)
    if not found.failure:
        bending = plane_strain_modulus(_MATERIAL) * np.array(_UNEQUAL) ** 3 / 12
        moments = found.reactions
        # faces that do not slide bend as one beam
        whole = plane_strain_modulus(_MATERIAL) * sum(_UNEQUAL) ** 3 / 12
        joined = whole if paired else bending.sum()
        released = (moments**2 / (2 * bending)).sum(axis=1) - moments.sum(axis=1) ** 2 / (2 * joined)
    name = "unequal arms, fixed pairs, G" if paired else "unequal arms, G"
    return _mean(name, found, released, law.work_of_adhesion, 8, ALLOWED_MOMENT)


def _copy(name: str, law: AdhesionLaw | JointLaw, mirrored: AdhesionLaw, allowed: float) -> Peeled:
    """Return the moment on two arms, and that of one arm against its mirror image."""
    length, elements = 60.0, 60
    upper, lower, joint, spaces = _joined(_HEIGHT, length, law, elements)
    held = Support(upper.side("left"), (0,)), Support(lower.side("left"), (0, 1))
    drive = RotatedSide(((upper.side("right"), 1.0), (lower.side("right"), -1.0)))
    both = traced(Problem("copy", (upper, lower), (joint,), held, drive), spaces, _ANGLES)
    on_plane = Interface(joint.boundary, Mirrored(mirrored), Flat())
    half = Problem("half", (upper,), (on_plane,), held[:1], RotatedSide("right"))
    alone = traced(half, spaces["upper"], _ANGLES)
    failed = both.failure or alone.failure
    expected = both.reaction if failed else 2 * alone.reaction
    return Peeled(name, both.parameter, both.reaction, expected, _READ_AT, 0, allowed, failed)


def _mean(
    name: str, found: EquilibriumPath, number: FloatArray, expected: float, last: int, allowed: float
) -> Peeled:
    steady = np.full(number.shape, expected)
    return Peeled(name, found.parameter, number, steady, (), last, allowed, found.failure)


def judge(outcomes: Sequence[Peeled]) -> Result:
    """Compare steady forces, energy release rates, and moments at some angles."""
    rows = []
    for found in outcomes:
        if found.failure:
            rows.append(Row(np.nan, 1.0, found.allowed, (found.name, "")))
        elif found.averaged:
            chosen = found.number[-found.averaged :]
            place = f"last {found.averaged} steps"
            rows.append(
                Row(float(chosen.mean()), float(found.expected[-1]), found.allowed, (found.name, place))
            )
        for at in () if found.failure else found.compared:
            place = f"{np.degrees(found.parameter[at]):.0f} degrees"
            rows.append(
                Row(float(found.number[at]), float(found.expected[at]), found.allowed, (found.name, place))
            )
    return Result(
        quantity="force S / E0 L0, energy release rate G / E0 L0, moment M / E0 L0^2",
        text=(
            "Two bodies adhere to each other by an interface with the scheme `unbiased`, and their faces"
            " slide without friction, if nothing else is said: {arms-steady}. **T-peel**: two equal arms are"
            " pulled apart at right angles to the joint. The force S on each of them satisfies"
            " 2 S + S^2/(E' h) = W. **Tape on a soft layer**: at right angles S + S^2/(2 E' h) = W,"
            " whatever the layer, as its deformation moves"
            " along with the front. **Unequal arms**: the ends of two arms of different heights turn by"
            " opposite angles, and the left ends are clamped. The energy release rate is that of the"
            " moments M_1 and M_2 at the ends, in one sense of rotation, G = M_1^2/(2 E' I_1) + M_2^2/(2 E'"
            " I_2) - (M_1 + M_2)^2/(2 E' I_0); it must be W. Faces that slide have I_0 = I_1 + I_2, as the"
            " part that is joined bends as two beams. With fixed pairs of points, by the law of Xu and"
            " Needleman with one work in all modes, it bends as one beam, I_0 = (h_1 + h_2)^3/12. **Copy**:"
            " the moment on two equal arms is compared with that of one arm and its mirror image. Both"
            " differ where the sides are inclined:"
            " there the closest point is nearer than the opposite one. Fixed pairs of points, by the law of"
            " Xu and Needleman, are mirror images, so that only round-off and the end of the iteration"
            " differ."
        ),
        settings=(
            ("arms", f"height {_HEIGHT:g}, neo-Hooke, E = 1, Poisson's ratio 0.2; unequal ones have 3 and 4"),
            ("soft layer", f"height {_SOFT_HEIGHT:g}, E = 0.1, Poisson's ratio 0.4, held at its lower side"),
            ("law", "exponential, strength 0.02, W = 0.0153; for unequal arms 0.005 and 0.001"),
            ("space", "N2.1, degree 2 across, elements of length 2; for the copy 1"),
        ),
        columns=("number", "read at"),
        named_by=2,
        rows=tuple(rows),
        pictures=(
            Picture(
                "arms-steady",
                "Forces and energy release rate over the parameter of the drive as a fraction of its last"
                " value, in units of the closed form.",
                partial(_draw, tuple(found for found in outcomes if not found.failure)),
            ),
        ),
        problems=tuple(found.failure for found in outcomes if found.failure),
    )


def _draw(outcomes: Sequence[Peeled]) -> Figure:
    with one_panel("parameter of the drive / its last value", "number / closed form", 2.6) as (figure, axes):
        axes.axhline(1.0, color=GREY, linewidth=0.6)
        drawn = [found for found in outcomes if found.averaged]
        colors, lines = (BLUE, VERMILION, "black", GREEN), ("-", DASHES, DOTS, "-")
        for found, color, line in zip(drawn, colors, lines, strict=False):
            way = found.parameter / found.parameter[-1]
            axes.plot(way, found.number / found.expected, color=color, linestyle=line, label=found.name)
        if drawn:
            axes.legend(loc="lower right")
        axes.set_ylim(0.0, 1.4)
    return figure


_RUNS: dict[str, Callable[[], Peeled]] = {
    "T-peel": _t_peel,
    "soft layer": _on_a_soft_layer,
    "unequal arms": partial(_unequal_arms, _TURNED),
    "unequal arms, fixed pairs": partial(_unequal_arms, _BONDED),
    "copy": partial(_copy, "copy, M", _PULLED, _PULLED, ALLOWED_COPY),
    "copy, fixed pairs": partial(
        _copy, "copy, fixed pairs, M", _PAIRED, _Opening(0.02, 0.0153), ALLOWED_PAIRS
    ),
}
CHECK = Check("Two arms", tuple(_RUNS), peel, judge)
