"""Bonded beams that crack by opening, by sliding and by both, under a joint law, against beam theory."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import inf, pi, sqrt
from typing import TypeAlias

import numpy as np
from matplotlib.figure import Figure

from isopeel.assembly.interface import InterfacePoints
from isopeel.common.arrays import FloatArray
from isopeel.physics.joints import MixedModeBilinear
from isopeel.physics.materials import NeoHooke
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.post.closed_form import BondedBeams, double_cantilever_force
from isopeel.post.style import BLUE, GREY
from isopeel.problem import Body, Drive, Interface, Problem, PulledSide, Support
from isopeel.problem.place import placed
from isopeel.report.document import Picture
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.step import Step
from isopeel.splines.nurbs import rectangle
from isopeel.splines.rows import RowSpace
from isopeel.splines.space import SplineSpace
from isopeel.validation.check import Check, Result, Row, traced
from isopeel.validation.one_panel import one_panel

#: The closed form rests on a fit: in elastic runs of these isotropic beams the crack is lengthened by
#: 0.34 chi h in sliding, where the fit says 0.42 chi h. That makes G 0.9 % too large.
ALLOWED_RELEASE = 0.02
#: The force depends neither on the crack's length nor on the root; the rest is the mesh.
ALLOWED_FORCE = 0.01
#: In the process zone the local mixity differs by up to 0.1 from that of the beams.
ALLOWED_WORK = 0.01
HEIGHT, HALF_SPAN, _CRACK = 5.0, 100.0, 82.0
_MATERIAL = NeoHooke(1.0, 0.2)
MODULUS = plane_strain_modulus(_MATERIAL)
SHEAR_MODULUS = 1 / 2.4
#: So small that the beams rotate by 2 degrees at most.
_WORK = 5e-6
#: E' W/strength^2 is one height: the process zone has about half a height. The ratio of strength^2 to work is
#: the same in both modes, so that the zone is as long in both.
_STRENGTH = sqrt(MODULUS * _WORK / HEIGHT)
LAW = MixedModeBilinear(_STRENGTH, sqrt(2) * _STRENGTH, _WORK, 2 * _WORK, 0.1, 2.0)
Stretches: TypeAlias = Sequence[tuple[float, float]]
#: Ends of stretches of equal elements along the beams, and the sizes of the elements there.
_STRETCHES = ((74.0, 6.0), (80.0, 1.5), (87.0, 0.25), (91.0, 1.0), (97.0, 2.0), (103.0, 3.0), (200.0, 6.0))
_ACROSS = (0.0, 0.14, 0.43, 1.0)  # from the joint on
_MIDDLE = (97.0, 103.0)  # where the lever presses
#: Growth of the crack, in heights, over which numbers are averaged. The process zone has formed before.
_READ = (0.3, 0.7)
#: In displacements at which the crack begins to grow by beam theory; a step moves the front by an element.
_PATH = (0.3, 0.7, 0.9, 0.95, *np.arange(0.97, 1.3, 0.0025))


@dataclass(frozen=True, eq=False)
class Cracked:
    """States of two beams while the crack grows, each (steps,), or why there are none."""

    lever: float
    failure: str
    crack: FloatArray = field(default_factory=lambda: np.zeros(0))  # its length
    load: FloatArray = field(default_factory=lambda: np.zeros(0))
    displacement: FloatArray = field(default_factory=lambda: np.zeros(0))
    dissipated: FloatArray = field(default_factory=lambda: np.zeros(0))

    @property
    def beams(self) -> BondedBeams:
        """The beams and their lever."""
        return BondedBeams(MODULUS, SHEAR_MODULUS, HEIGHT, HALF_SPAN, self.lever)

    @property
    def released(self) -> FloatArray:
        """G_I and G_II (steps, 2) of beam theory."""
        loads = zip(self.load.tolist(), self.crack.tolist(), strict=True)
        return np.array([self.beams.release(load, length) for load, length in loads])

    @property
    def mixity(self) -> float:
        """G_II/(G_I + G_II) by beam theory, the mean."""
        return float(np.mean(self.released[:, 1] / self.released.sum(axis=1)))

    @property
    def work_by_length(self) -> float:
        """Energy dissipated over the length by which the crack grows."""
        return float((self.dissipated[-1] - self.dissipated[0]) / (self.crack[-1] - self.crack[0]))


def crack(lever: float) -> Cracked:
    """Load two beams by a lever (0: end-notched flexure; inf: a double cantilever) until the crack grows."""
    problem, spaces = bonded_beams(lever, LAW, _CRACK, _STRETCHES)
    points = InterfacePoints.of_contact(problem, spaces, interface=problem.interface_names[0])
    seen: list[tuple[float, Step]] = []

    def grown(steps: Sequence[Step]) -> bool:
        # the damage of the joint comes first in the history
        damage = steps[-1].maximum_openings.ravel()[: points.lengths.size]
        parted = LAW.rise * damage / (1 - (1 - LAW.rise) * damage)  # share of the work that is dissipated
        seen.append((_CRACK + float(points.lengths.ravel() @ parted), steps[-1]))
        return seen[-1][0] > _CRACK + _READ[1] * HEIGHT

    path = _onset(lever) * np.array(_PATH)
    found = traced(problem, spaces, path, NewtonSettings(path_control="auto"), grown)
    if found.failure:
        return Cracked(lever, found.failure)
    read = [one for one in seen if one[0] > _CRACK + _READ[0] * HEIGHT]
    return Cracked(
        lever,
        "",
        np.array([length for length, _ in read]),
        np.array([step.reaction for _, step in read]),
        np.array([step.parameter for _, step in read]),
        np.array([step.dissipated_energy for _, step in read]),
    )


def _onset(lever: float) -> float:
    """Return the displacement at which the crack begins to grow by beam theory."""
    if lever == inf:
        turned = BondedBeams(MODULUS, SHEAR_MODULUS, HEIGHT, HALF_SPAN).root_rotation
        return 2 * sqrt(12 * LAW.work_of_adhesion / (MODULUS * HEIGHT**3)) * (_CRACK + turned) ** 2 / 3
    beams = BondedBeams(MODULUS, SHEAR_MODULUS, HEIGHT, HALF_SPAN, lever)
    opening, sliding = beams.release(1.0, _CRACK)
    work = LAW.work_at(sliding / (opening + sliding))
    return sqrt(work / (opening + sliding)) * beams.compliance(_CRACK)


def bonded_beams(
    lever: float, law: MixedModeBilinear, crack: float, stretches: Stretches
) -> tuple[Problem, dict[str, RowSpace]]:
    """Return the problem of two beams of a joint law, with a crack of a length, and their spaces.

    `stretches` are the ends of stretches of equal elements along the beams, and the sizes of the elements.
    """
    length = 2 * HALF_SPAN
    upper = Body(rectangle(length, HEIGHT), _MATERIAL, "upper")
    lower = Body(placed(rectangle(length, HEIGHT), (0.0, -HEIGHT), 0.0), _MATERIAL, "lower")
    tip = crack / length
    joint = Interface(upper.side("bottom", start=tip), law, lower.side("top"))
    faces = Interface(upper.side("bottom", end=tip), replace(law, initial_damage=1.0), lower.side("top"))
    middle = upper.side("top", _MIDDLE[0] / length, _MIDDLE[1] / length)
    ends = upper.side("left"), lower.side("left")
    # the last element's lower side does not bend: it only holds the beams along
    along = Support(lower.side("bottom", start=1 - stretches[-1][1] / length), (0,))
    held: tuple[Support, ...] = Support(ends[1], (1,)), Support(lower.side("right"), (1,)), along
    drive: Drive = PulledSide(middle, -pi / 2)
    if lever == inf:
        drive = PulledSide(((ends[0], 1.0), (ends[1], -1.0)), pi / 2)
        held = (Support(lower.side("right"), (0, 1)),)
    elif lever:
        pressed = -(1 + lever / HALF_SPAN)
        drive = PulledSide(((ends[0], lever / HALF_SPAN), (middle, pressed)), pi / 2)
    across = np.array(_ACROSS)
    spaces = {"upper": _space(across, stretches), "lower": _space(1 - across[::-1], stretches)}
    return Problem("bonded beams", (upper, lower), (joint, faces), held, drive), spaces


def _space(across: FloatArray, stretches: Stretches) -> RowSpace:
    ends, places = 0.0, [np.zeros(1)]
    for end, size in stretches:
        places.append(np.linspace(ends, end, round((end - ends) / size) + 1)[1:])
        ends = end
    along = SplineSpace.on(2, 1, np.concatenate(places) / ends)
    upwards = SplineSpace.on(2, 1, across)
    return RowSpace("N2", upwards, (along,) * upwards.size)


def _name(lever: float) -> str:
    if lever == inf:
        return "double cantilever"
    return f"mixed-mode flexure, c = {lever / HALF_SPAN:g} L" if lever else "end-notched flexure"


def judge(outcomes: Sequence[Cracked]) -> Result:
    """Compare loads, energy release rates, and the energy dissipated."""
    rows = []
    for found in outcomes:
        name, shown = _name(found.lever), ""
        if found.failure:
            rows.append(Row(np.nan, 1.0, ALLOWED_RELEASE, (name, "", "")))
            continue
        if found.lever == inf:
            bending = MODULUS * HEIGHT**3 / 12
            forces = [double_cantilever_force(_WORK, bending, float(one)) for one in found.displacement]
            rows.append(
                Row(float(found.load.mean()), float(np.mean(forces)), ALLOWED_FORCE, (name, "P", "0"))
            )
            continue
        shown = f"{found.mixity:.3f}"
        work = LAW.work_at(found.mixity)
        released = float(found.released.sum(axis=1).mean())
        rows += [
            Row(released, work, ALLOWED_RELEASE, (name, "G of the load", shown)),
            Row(found.work_by_length, work, ALLOWED_WORK, (name, "energy dissipated / length", shown)),
        ]
    return Result(
        quantity="load P / E0 L0, energy release rate and dissipated energy / E0 L0",
        text=(
            "Two bonded beams crack from one end while they are bent, by a joint of fixed pairs with"
            " damage: {mixed-mode-release}. In the **double cantilever** forces P on the ends open both"
            " beams by D, at P = sqrt(2/3) G^(3/4) (E'I)^(1/4) D^(-1/2). In **mixed-mode flexure** the"
            " beams lie on two supports at the distance 2 L; a lever, loaded at the distance c from the"
            " middle, presses the middle down and lifts the cracked end of the upper beam. Without the"
            " lever this is **end-notched flexure**, where the faces of the crack press on each other and"
            " slide. While the crack grows, G = G_I + G_II must be the work of Benzeggagh and Kenane, G(B),"
            " at B = G_II/G, with G_I = 3 a^2 P^2 (3 c - L)^2/(4 h^3 L^2 E'), where a stands for a + chi h,"
            " and G_II = 9 a^2 P^2 (c + L)^2/(16 h^3 L^2 E'), where a stands for a + 0.42 chi h. The"
            " crack's length a is the first one plus the integral of the share of the work that each point"
            " has dissipated. The dissipated energy over the growth of a is compared with the same G(B):"
            " the mixity of points in the process zone is not exactly that of the beams. All of this needs"
            " slender beams and a process zone that is short against their height: with E' W/strength^2 of"
            " 1, 4 and 16 heights, G of the load is -0.1, -1.8 and -6 % off at c = 0.87 L."
        ),
        settings=(
            ("beams", f"height h = {HEIGHT:g}, L = {HALF_SPAN:g}, neo-Hooke, E = 1, Poisson's ratio 0.2"),
            (
                "crack",
                f"{_CRACK:g} at first, averages between {_READ[0]:g} and {_READ[1]:g} heights of growth",
            ),
            (
                "joint",
                f"bilinear with damage, W = {_WORK:g}, twice as much in sliding, strength"
                f" {_STRENGTH:.5f} = sqrt(E' W/h), sqrt(2) times as much in sliding, rise 0.1, exponent 2",
            ),
            ("space", "N2, degree 2 across, elements of 0.25 where the crack grows"),
        ),
        columns=("test", "number", "B"),
        named_by=2,
        rows=tuple(rows),
        pictures=(
            Picture(
                "mixed-mode-release",
                "Energy release rate while the crack grows, over the mixity: runs (dots) and the work of"
                " Benzeggagh and Kenane (line).",
                partial(_draw, tuple(found for found in outcomes if not found.failure)),
            ),
        ),
        problems=tuple(found.failure for found in outcomes if found.failure),
    )


def _draw(outcomes: Sequence[Cracked]) -> Figure:
    with one_panel("mixity $G_{II}/G$", "$G/W$") as (figure, axes):
        mixity = np.linspace(0.0, 1.0, 101)
        work = [LAW.work_at(float(one)) / _WORK for one in mixity]
        axes.plot(mixity, work, color=GREY)
        for found in outcomes:
            if found.lever != inf:
                released = found.released.sum(axis=1).mean() / _WORK
                axes.plot(found.mixity, released, color=BLUE, marker="o", markersize=4)
        axes.set_ylim(bottom=0.0)
    return figure


CHECK = Check("Joints in mixed mode", (inf, 166.7, 87.4, 60.0, 0.0), crack, judge)
