"""What is said where the elements at a front are too few, and what discretization would do."""

from collections.abc import Mapping
from math import ceil, floor, log10

import numpy as np
from scipy.optimize import brentq

from isopeel.arrays import FloatArray
from isopeel.errors import InputError
from isopeel.post.closed_form.strip import free_strip
from isopeel.post.crack import jumps
from isopeel.post.front import front_profile
from isopeel.post.laboratory import Laboratory
from isopeel.post.law import law_character
from isopeel.post.reading import PlateauReading, read_window, rising
from isopeel.post.readings import LAST
from isopeel.post.resolution import (
    EVEN,
    Resolution,
    Zones,
    ends_along,
    estimated,
    needed_elements,
    parts_at_once,
)
from isopeel.problem import Problem
from isopeel.results.curve import Curve
from isopeel.results.notes import Note
from isopeel.splines.rows import STRONGEST_GRADING, RowSpace
from isopeel.splines.space import SplineSpace

#: More elements along than this are not proposed, but a grading.
_MOST_PROPOSED = 5000
#: Oscillation of a plateau, over its mean, from which the mean may be wrong by a percent: 3 to 5 % on strips.
SWINGS = 0.04
#: Jumps of a strip on flat ground that its start and its end do not explain.
JUMPS = 3
#: A proposed mesh has so many times the elements that are needed; of a graded one, of which more elements
#: are shorter by less where they are short, more of them.
_SPARE, _SPARE_GRADED = 1.1, 1.4


def estimate_notes(problem: Problem, space: RowSpace, laboratory: Laboratory) -> list[Note]:
    """Say before the first step that the elements are too few for the front, and what would do."""
    found = estimated(problem, space)
    if found is None or found.is_enough or parts_at_once(problem):
        return []
    return [
        Note(
            "resolution",
            f"{_told(problem, space, found, laboratory)} (estimated from law, material and thickness)",
        )
    ]


def peels(problem: Problem, space: RowSpace, fields: Mapping[float, FloatArray]) -> bool:
    """Whether a joint was pulled by half of its strength somewhere in one of the last and largest states.

    One that was not is a support, whose front is nowhere; `fields` are displacements (size, 2) by parameters.
    """
    try:
        strength = law_character(problem.adhesion.law).strength
    except InputError:
        return False
    states = {max(fields, key=abs), list(fields)[-1]} if fields else set()
    pulls = (-front_profile(problem, space, fields[at]).adhesive_traction.min() for at in states)
    return not fields or any(pull > strength / 2 for pull in pulls)


def zone_notes(problem: Problem, space: RowSpace, zones: Zones, laboratory: Laboratory) -> list[Note]:
    """Say that elements were too few at a front that was measured, or at that estimated where none was."""
    if zones.worst is None:
        return estimate_notes(problem, space, laboratory)
    value, front = zones.worst
    if front.is_enough:
        return []
    # a front that elements do not resolve is as long as they are
    if zones.estimated is not None and zones.estimated.elements < front.elements:
        return estimate_notes(problem, space, laboratory)
    where = f"measured at the front at {laboratory.parameter(problem.drive.parameter_column, value)}"
    return [Note("resolution", f"{_told(problem, space, front, laboratory)} ({where})")]


def oscillation_notes(
    problem: Problem, curve: Curve, plateau: PlateauReading | None, steady: tuple[float, float] | None
) -> list[Note]:
    """Say that the front of a strip moves from element to element, where its reaction swings by SWINGS.

    The swing is that of a `plateau`, or else that about a line in the `steady` window, or in the last fifth
    of the path where the front jumped. A strip on flat ground parts steadily but for its start and its end,
    which may jump.
    """
    if free_strip(problem) is None:
        return []
    jumped = int(jumps(curve).sum())
    if plateau is None:
        window = steady or (_last_part(curve) if jumped >= JUMPS else None)
        plateau = None if window is None else _about_a_line(curve, window)
    if plateau is None or not plateau.amplitude > SWINGS * abs(plateau.mean):
        return []
    told = f"the reaction swings by {100 * plateau.amplitude / abs(plateau.mean):.2g} % of its mean"
    if jumped >= JUMPS:
        told += f", and the front jumped {jumped} times"
    text = f"{told}, where that of such a strip moves steadily: elements along are too large for the front"
    return [Note("resolution", text)]


def _last_part(curve: Curve) -> tuple[float, float]:
    """The last part of the path in which a steady reaction is looked for."""
    first, last = float(curve.parameter[0]), float(curve.parameter[-1])
    low, high = sorted((last - LAST[0] * (last - first), last))
    return low, high


def _about_a_line(curve: Curve, window: tuple[float, float]) -> PlateauReading | None:
    """What a window tells about a line; None where it holds few steps."""
    parameter, reaction = rising(curve)
    inside = (parameter >= window[0]) & (parameter <= window[1])
    if np.count_nonzero(inside) < 4:
        return None
    return read_window(parameter[inside], reaction[inside], window)


def _told(problem: Problem, space: RowSpace, found: Resolution, laboratory: Laboratory) -> str:
    """Numbers of a resolution that is not enough, and the space, mesh or grading that would do."""
    element, zone, reach = (
        laboratory.text(length, "length", 3) for length in (found.element, found.zone, found.reach)
    )
    ways = ", or ".join(_ways(problem, space, found))
    return (
        f"{found.elements:.2g} elements of {element} in the process zone of {zone}, and "
        f"{found.elements_in_reach:.2g} in the reach of the law, {reach}; space {space.name} needs "
        f"{found.needed:.2g} in the zone: take {ways}"
    )


def _ways(problem: Problem, space: RowSpace, found: Resolution) -> list[str]:
    """What would give the process zone the elements that it needs."""
    along, across = space.elements
    if problem.adhesion.side in ("left", "right"):
        return [f"mesh = '{along}x{_rounded_up(_SPARE * across * found.needed / found.elements)}'"]
    sizes = np.diff(space.rows[0].breakpoints)
    spare = _SPARE if np.ptp(sizes) < EVEN else _SPARE_GRADED
    wanted = _rounded_up(spare * along * found.needed / found.elements)
    ways = [f"mesh = '{wanted}x{across}'"] if wanted <= _MOST_PROPOSED else [f"{wanted} elements along"]
    usual = SplineSpace.uniform(3, 1, 2)
    if found.needed > needed_elements(usual) and found.elements >= _SPARE * needed_elements(usual):
        ways.append("space = 'N2.1'")
    if problem.drive.side in ("bottom", "top"):
        # the front stays near where it starts
        grading = _grading(along, found.zone / found.needed / _SPARE / ends_along(problem, space)[-1])
        ways += [] if grading is None else [f"grade the elements towards the front, by up to 1:{grading}"]
    return ways


def _grading(elements: int, smallest: float) -> int | None:
    """Ratio of the last of so many elements to the first one, the latter being a share of them all."""

    def share(logarithm: float) -> float:
        rate = logarithm / (elements - 1)
        return float(np.expm1(rate) / np.expm1(rate * elements)) - smallest

    largest = float(np.log(STRONGEST_GRADING))
    if elements < 2 or not share(largest) < 0 < share(1e-6):
        return None
    return _rounded_up(float(np.exp(brentq(share, 1e-6, largest))))


def _rounded_up(number: float) -> int:
    """The next number of two digits and zeros."""
    unit: int = 10 ** max(floor(log10(number)) - 1, 0)
    return int(ceil(number / unit) * unit)
