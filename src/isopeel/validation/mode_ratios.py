"""A joint that grows at five mode ratios, read by the moments of both arms at its front."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import sqrt

import numpy as np
from matplotlib.figure import Figure

from isopeel.common.arrays import FloatArray
from isopeel.physics.joints import MixedModeBilinear
from isopeel.physics.materials import NeoHooke
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.post.mode_ratio import ModeRates, mode_rates
from isopeel.post.style import BLUE, GREY
from isopeel.problem import Body, Interface, Problem, RotatedSide, Support
from isopeel.problem.place import placed
from isopeel.report.document import Picture
from isopeel.results.fields import StoredState
from isopeel.solve.step import Step
from isopeel.splines.nurbs import rectangle
from isopeel.splines.rows import RowSpace
from isopeel.splines.space import SplineSpace
from isopeel.validation.check import Check, Result, Row, traced
from isopeel.validation.one_panel import one_panel

#: What is left of the mixity's lag in a step, of the length of the process zone, and of the mesh.
ALLOWED = 0.005
_MATERIAL, _HEIGHT = NeoHooke(1.0, 0.2), 10.0
_JOINED, _FREE = 40.0, 30.0
_BENDING = plane_strain_modulus(_MATERIAL) * _HEIGHT**3 / 12
_WORK, _SHEAR_WORK = 4.34e-5, 8.68e-5
_STRENGTH = 0.0045
#: The stiffnesses of opening and sliding are equal, as are those of both crack faces: then the mixity is the
#: same throughout a process zone that is short.
_LAW = MixedModeBilinear(_STRENGTH, sqrt(_SHEAR_WORK / _WORK) * _STRENGTH, _WORK, _SHEAR_WORK, 0.1)
#: Rotation of the root of an arm as a length beyond the front, over the height: Williams' chi of an isotropic
#: arm, and 0.42 of it in sliding. They only make the mode ratios even.
_ROOT, _ROOT_OF_SLIDING = 0.65, 0.27
_STEP = 0.001  # of the rotation, as a share of that of beams when the joint begins to part
_ELEMENT, _FINE = 0.1, (-3.0, 0.6)  # size of elements next to the first front
_GROWTH, _LARGEST = 1.4, 2.5  # ratio of neighbouring elements beyond, and their largest size
#: Length of the joint that has parted, by its dissipated energy, where G is read.
_READ = (1.0, 1.8)


@dataclass(frozen=True)
class Growing:
    """An intended mode ratio, and what differs from the choices for which the closed form is valid."""

    intended: float
    differs: str = ""
    law: MixedModeBilinear = _LAW
    step: float = _STEP


@dataclass(frozen=True, eq=False)
class Grown:
    """Mode ratios and energy release rates in steps of growth (steps,)."""

    of: Growing
    ratio: FloatArray
    rate: FloatArray  # G_I + G_II
    toughness: FloatArray  # G_c at the ratio
    failure: str


_SHEAR_STRENGTH = _LAW.shear_strength
_CASES = (
    *(Growing(intended) for intended in (0.0, 0.25, 0.5, 0.75, 1.0)),
    Growing(0.5, "steps 8 times as long", step=8 * _STEP),
    Growing(0.5, "equal strengths", replace(_LAW, shear_strength=_STRENGTH)),
    Growing(
        0.5,
        "half of the strengths",
        replace(_LAW, strength=_STRENGTH / 2, shear_strength=_SHEAR_STRENGTH / 2),
    ),
)


def grow(of: Growing) -> Grown:
    """Turn the ends of two arms by angles of a mode ratio until the joint has grown."""
    problem, spaces = _arms(of)
    path = np.concatenate([[0.0, 0.4, 0.7], np.arange(0.9, 1.4, of.step)])
    found: list[ModeRates] = []

    def has_grown(steps: Sequence[Step]) -> bool:
        parted = steps[-1].dissipated_energy / _toughness(of.intended)
        if parted > _READ[1]:
            return True
        if parted > _READ[0]:
            state = StoredState.of(steps[-1], problem.drive)
            rates = mode_rates(problem, spaces, state, "upper.bottom")
            assert isinstance(rates, ModeRates), rates
            found.append(rates)
        return False

    grown = traced(problem, spaces, path, until=has_grown)
    failure = grown.failure
    if not failure and grown.dissipated[-1] <= _READ[1] * _toughness(of.intended):
        failure = f"the joint has not grown by {_READ[1]:g} L0"
    ratio = np.array([one.ratio for one in found])
    rate = np.array([one.opening + one.sliding for one in found])
    return Grown(of, ratio, rate, _toughness(ratio), failure)


def _toughness(ratio: FloatArray | float) -> FloatArray:
    """Return G_c = G_Ic + (G_IIc - G_Ic) B^eta (Benzeggagh and Kenane 1996)."""
    return np.asarray(_WORK + (_SHEAR_WORK - _WORK) * np.asarray(ratio) ** _LAW.exponent)


def _arms(of: Growing) -> tuple[Problem, dict[str, RowSpace]]:
    length = _JOINED + _FREE
    upper = Body(rectangle(length, _HEIGHT), _MATERIAL, "upper")
    lower = Body(placed(rectangle(length, _HEIGHT), (0.0, -_HEIGHT), 0.0), _MATERIAL, "lower")
    first, last = _FINE
    fine = _JOINED + np.linspace(first, last, round((last - first) / _ELEMENT) + 1)
    # the first front is between two elements
    tip = int(np.argmin(np.abs(fine - _JOINED)))
    along = np.concatenate([_away(fine[0], 0.0)[::-1], fine, _away(fine[-1], length)])
    end = float(fine[tip] / length)
    upwards = np.concatenate([[0.0, _ELEMENT], _away(_ELEMENT, _HEIGHT)])
    spaces = {
        "upper": _space(along / length, upwards / _HEIGHT),
        "lower": _space(along / length, 1 - upwards[::-1] / _HEIGHT),
    }
    cracked = replace(of.law, initial_damage=1.0)
    joints = (
        Interface(upper.side("bottom", end=end), of.law, lower.side("top")),
        Interface(upper.side("bottom", start=end), cracked, lower.side("top")),
    )
    turns = _turns(of.intended)
    drive = RotatedSide(((upper.side("right"), turns[0]), (lower.side("right"), turns[1])))
    held = Support(upper.side("left"), (0, 1)), Support(lower.side("left"), (0, 1))
    return Problem("mode ratio", (upper, lower), joints, held, drive), spaces


def _turns(intended: float) -> tuple[float, float]:
    """Return the angles of the ends of both arms at which beams release G_c, by M_I and M_II."""
    work = float(_toughness(intended))
    opening = sqrt((1 - intended) * work * _BENDING)
    sliding = sqrt(4 / 3 * intended * work * _BENDING)
    open_turn = opening * (_FREE + _ROOT * _HEIGHT) / _BENDING
    # the joined part bends under both moments with eight times the stiffness
    slide_turn = sliding * (_FREE + _ROOT_OF_SLIDING * _HEIGHT + _JOINED / 4) / _BENDING
    return slide_turn + open_turn, slide_turn - open_turn


def _away(start: float, stop: float) -> FloatArray:
    """Return the ends of elements beside a fine mesh, which grow from there on."""
    sizes, whole = [_ELEMENT * _GROWTH], abs(stop - start)
    while sum(sizes) < whole:
        sizes.append(min(sizes[-1] * _GROWTH, _LARGEST))
    ends = np.cumsum(sizes) * (whole / sum(sizes))
    found: FloatArray = start + np.sign(stop - start) * ends
    return found


def _space(along: FloatArray, upwards: FloatArray) -> RowSpace:
    # ends that are sums of sizes meet 0 and 1 to round-off
    along[[0, -1]] = upwards[[0, -1]] = 0.0, 1.0
    across = SplineSpace.on(2, 1, upwards)
    return RowSpace("N2", across, (SplineSpace.on(2, 1, along),) * across.size)


def judge(outcomes: Sequence[Grown]) -> Result:
    """Compare the energy release rate during growth with the toughness of the mode ratio."""
    rows = []
    for found in outcomes:
        reached = not found.failure
        rows.append(
            Row(
                float(found.rate.mean()) if reached else np.nan,
                float(found.toughness.mean()) if reached else 1.0,
                None if found.of.differs else ALLOWED,
                (
                    f"{found.of.intended:g}",
                    found.of.differs or "-",
                    f"{found.ratio.mean():.4f}" if reached else "",
                ),
            )
        )
    return Result(
        quantity="energy release rate G / E0 L0",
        text=(
            "Two equal arms are joined by the bilinear law with damage, up to a crack whose faces repel each"
            " other. Their ends turn by angles of a fixed ratio, the other ends are clamped, and"
            " the joint grows: {mode-ratios}. The moments M_1 and M_2 of both arms, in one sense of rotation,"
            " are read from the stresses in sections of the free parts. They release G_I = M_I^2/(E' I) and"
            " G_II = 3 M_II^2/(4 E' I), with M_I = (M_1 - M_2)/2 and M_II = (M_1 + M_2)/2. Their sum must be"
            " the work G_c = G_Ic + (G_IIc - G_Ic) B^eta of the mode ratio B = G_II/(G_I + G_II). All numbers"
            " are means over the steps in which the joint has parted by 1 to 1.8 L0. B rises a little as the"
            " arms become longer."
            "\n\n"
            "The law evaluates its mixity at each point, in the last accepted step. So this closed form is"
            " valid for a process zone that is short and has developed, for equal stiffnesses of opening and"
            " sliding, and for short steps. Here E' G_Ic/strength^2 is 0.22 heights, and the joint grows by"
            " about 0.04 L0 in a step. The last rows show what other choices do: the error is proportional"
            " to the step; with equal strengths the mixity differs throughout the zone; with half of the"
            " strengths the zone is about one height long and not yet developed."
        ),
        settings=(
            ("arms", f"height {_HEIGHT:g}, crack {_FREE:g}, joint {_JOINED:g}; neo-Hooke, E = 1, nu = 0.2"),
            ("law", f"G_Ic = {_WORK:g}, G_IIc = 2 G_Ic, eta = 2, strength {_STRENGTH:g}, rise 0.1"),
            ("space", f"N2, elements of {_ELEMENT:g} at the front, growing by {_GROWTH:g} beyond"),
        ),
        columns=("intended B", "differs by", "B"),
        named_by=2,
        rows=tuple(rows),
        pictures=(
            Picture(
                "mode-ratios",
                "Energy release rate at which the joint grows, over the mode ratio; line: G_c.",
                partial(_draw, tuple(found for found in outcomes if not found.failure)),
            ),
        ),
        problems=tuple(found.failure for found in outcomes if found.failure),
    )


def _draw(outcomes: Sequence[Grown]) -> Figure:
    with one_panel("mode ratio $B$", "$(G_I + G_{II}) / G_{Ic}$", 2.6) as (figure, axes):
        ratios = np.linspace(0.0, 1.0, 101)
        axes.plot(ratios, _toughness(ratios) / _WORK, color=GREY)
        for found in (one for one in outcomes if not one.of.differs):
            axes.plot(found.ratio, found.rate / _WORK, color=BLUE, linestyle="", marker=".")
    return figure


CHECK = Check("Mode ratios", _CASES, grow, judge)
