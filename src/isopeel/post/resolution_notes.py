"""Notes on fronts that have too few elements, with a discretization that has enough."""

from collections.abc import Sequence
from math import ceil, floor, log, log10

import numpy as np

from isopeel.assembly.spaces import SpaceOfBodies, spaces_by_name
from isopeel.common.errors import InputError
from isopeel.post.closed_form.strip import free_strip
from isopeel.post.crack import jumps
from isopeel.post.front import POINTS, front_profile
from isopeel.post.laboratory import Laboratory
from isopeel.post.law import law_character
from isopeel.post.plateau import PlateauReading, read_window, rising
from isopeel.post.readings import LAST
from isopeel.post.resolution import (
    EVEN,
    Resolution,
    Zones,
    body_height,
    compliant,
    ends_along,
    estimated,
    needed_elements,
    parts_at_once,
    process_zone_length,
)
from isopeel.problem import Problem
from isopeel.results.curve import Curve
from isopeel.results.fields import StoredState
from isopeel.results.notes import Note, Remedy
from isopeel.splines.rows import RowSpace, row_space
from isopeel.splines.space import SplineSpace

#: Element columns times rows, with those of the degree across, for which a run takes minutes.
_MOST_COLUMNS = 20_000
#: Factor on the elements along up to which more of them are proposed instead of a grading; and those tried.
_FEW_MORE = 2.0
#: Largest ratio of the lengths of neighbouring elements.
_NEIGHBOURS = 1.3
_ROWS = (10, 16, 24, 32)
_TIMES, _GRADINGS = (1.0, 1.5, 2.0, 3.0, 4.0), (2, 5, 10, 20, 50, 100, 200, 500, 1000)
#: Oscillation of a plateau over its mean above which the mean may be wrong by a percent: 3 to 5 % on strips.
SWINGS = 0.04
#: Number of jumps of a strip on a flat substrate that are too many for its start and its end alone.
JUMPS = 3
#: Factor on the needed elements of a proposed mesh; larger for a graded one, where additional elements
#: shorten the short elements less.
_SPARE, _SPARE_GRADED = 1.1, 1.4


def estimate_notes(problem: Problem, space: SpaceOfBodies, laboratory: Laboratory) -> list[Note]:
    """Return notes, before the first step, where a front has too few elements, with a remedy."""
    found = (_estimate_note(problem, space, laboratory, name) for name in problem.interface_names)
    return [note for note in found if note is not None]


def _estimate_note(
    problem: Problem, space: SpaceOfBodies, laboratory: Laboratory, interface: str
) -> Note | None:
    found = estimated(problem, space, interface)
    if found is None or found.is_enough or parts_at_once(problem, space, interface):
        return None
    source = "estimated from law, material and thickness"
    return _zone_note(problem, space, found, laboratory, source, interface)


def peels(problem: Problem, space: SpaceOfBodies, states: Sequence[StoredState], interface: str = "") -> bool:
    """Return whether half of a joint's strength was reached somewhere in one of the last and largest states.

    A joint without such a place is a support, which has no front.
    """
    try:
        strength = law_character(problem.interface_of(interface).law).strength
    except InputError:
        return False
    looked_at = [max(states, key=lambda state: abs(state.parameter)), states[-1]] if states else []
    pulls = (
        front_profile(
            problem, space, state.displacement, POINTS, state.maximum_openings, interface
        ).attraction.max()
        for state in looked_at
    )
    return not states or any(pull > strength / 2 for pull in pulls)


def zone_note(
    problem: Problem, space: SpaceOfBodies, zones: Zones, laboratory: Laboratory, interface: str
) -> Note | None:
    """Return a note where a measured front, or else the estimated one, has too few elements, else None."""
    if zones.worst is None:
        return _estimate_note(problem, space, laboratory, interface)
    value, front = zones.worst
    if front.is_enough:
        return None
    # a front that the elements do not resolve is as long as an element
    if zones.estimated is not None and zones.estimated.elements < front.elements:
        return _estimate_note(problem, space, laboratory, interface)
    where = f"measured at the front at {laboratory.parameter(problem.drive.parameter_column, value)}"
    return _zone_note(problem, space, front, laboratory, where, interface)


def oscillation_notes(
    problem: Problem, curve: Curve, plateau: PlateauReading | None, steady: tuple[float, float] | None
) -> list[Note]:
    """Return notes where the front of a strip moves from element to element: its reaction swings by SWINGS.

    The swing is that of a `plateau`, or else that about a line in the `steady` window, or in the last fifth
    of the path where the front jumped. A strip on flat ground peels steadily, except for its start and its
    end, which may jump.
    """
    if free_strip(problem) is None:
        return []
    jumped = int(jumps(curve).sum())
    if plateau is None:
        window = steady or (_last_part(curve) if jumped >= JUMPS else None)
        plateau = None if window is None else _about_a_line(curve, window)
    if plateau is None or not plateau.amplitude > SWINGS * abs(plateau.mean):
        return []
    swing = f"the reaction oscillates by {100 * plateau.amplitude / abs(plateau.mean):.2g} % of its mean"
    if jumped >= JUMPS:
        swing += f", and the front jumped {jumped} times"
    text = f"{swing}, but it should be steady: the elements along the strip are too long for its front"
    return [Note("resolution", text)]


def _last_part(curve: Curve) -> tuple[float, float]:
    """Return the last part of the path in which a steady reaction is looked for."""
    first, last = float(curve.parameter[0]), float(curve.parameter[-1])
    low, high = sorted((last - LAST[0] * (last - first), last))
    return low, high


def _about_a_line(curve: Curve, window: tuple[float, float]) -> PlateauReading | None:
    """Return the plateau about a line in a window; None where the window has too few steps."""
    parameter, reaction = rising(curve)
    inside = (parameter >= window[0]) & (parameter <= window[1])
    if np.count_nonzero(inside) < 4:
        return None
    return read_window(parameter[inside], reaction[inside], window)


def _zone_note(
    problem: Problem,
    space: SpaceOfBodies,
    found: Resolution,
    laboratory: Laboratory,
    source: str,
    interface: str,
) -> Note:
    """Return the note on an insufficient resolution, with the source of its numbers."""
    name = problem.interface_of(interface).boundary.body
    own = spaces_by_name(problem, space)[name]
    element, zone, reach = (
        laboratory.text(length, "length", 3) for length in (found.element, found.zone, found.reach)
    )
    text = (
        f"{found.elements:.2g} elements of {element} in the process zone of {zone}, and "
        f"{found.elements_in_reach:.2g} in the reach of the law, {reach} ({source}); space {own.name} "
        f"needs {found.needed:.2g} in the process zone"
    )
    remedy = _remedy(problem, space, found, interface)
    if remedy is None:
        text += f"; {_softer(problem, own, found, laboratory, interface)}"
    if len(problem.interface_names) > 1:
        text = f"{interface}: {text}"
    if remedy is not None and len(problem.bodies) > 1:
        # each body has its own mesh
        return Note("resolution", f"{text}; use {remedy.text} for the body {name}")
    return Note("resolution", text, remedy)


def _remedy(problem: Problem, spaces: SpaceOfBodies, found: Resolution, interface: str) -> Remedy | None:
    """Return a discretization that resolves the process zone and on which a run takes minutes, or None."""
    adhesion = problem.interface_of(interface)
    space = spaces_by_name(problem, spaces)[adhesion.boundary.body]
    along, across = space.elements
    more = _SPARE * found.needed / found.elements
    if adhesion.side in ("left", "right"):
        mesh = (along, _rounded_up(more * across))
        return Remedy(mesh) if _affordable(space, mesh) else None
    usual = SplineSpace.uniform(3, 1, 2)
    instead: tuple[str, ...] = ()
    if found.needed > needed_elements(usual) and found.elements >= _SPARE * needed_elements(usual):
        instead = ("space = 'N2.1'",)
    sizes = np.diff(space.rows[0].breakpoints)
    even = np.ptp(sizes) < EVEN
    wanted = (_rounded_up((more if even else more * _SPARE_GRADED / _SPARE) * along), across)
    # a front that stays near its start needs few small elements
    stays = problem.driven_side in ("bottom", "top")
    if stays and wanted[0] > _FEW_MORE * along:
        graded = _graded(problem, spaces, found, interface)
        if graded is not None:
            return graded._replace(instead=instead)
    return Remedy(wanted, None, instead) if _affordable(space, wanted) else None


def _affordable(space: RowSpace, mesh: tuple[int, int]) -> bool:
    """Return whether a run on so many elements takes no more than some minutes."""
    return mesh[0] * (mesh[1] + space.across.degree) <= _MOST_COLUMNS


def _graded(problem: Problem, spaces: SpaceOfBodies, found: Resolution, interface: str) -> Remedy | None:
    """Return the first graded mesh, of few elements first, that resolves a front in one half of the side."""
    adhesion, of = problem.interface_of(interface), spaces_by_name(problem, spaces)
    body = problem.body_of(adhesion.boundary.body)
    space = of[body.name]
    along, across = space.elements
    middle = float(ends_along(problem, spaces, interface)[-1]) / 2
    sides = {np.sign(sum(stretch) / 2 - middle) for stretch in found.stretches}
    if len(sides) > 1:
        return None
    towards = -1 if 1.0 in sides else 1
    upwards = 1 if adhesion.side == "bottom" else -1
    rows, steep = _rows(body_height(problem, interface), across, found.contact)
    for times in _TIMES:
        mesh = (_rounded_up(times * along), rows)
        if not _affordable(space, mesh):
            break
        for ratio in _GRADINGS:
            if ratio > _NEIGHBOURS ** (mesh[0] - 1):
                break
            grading = (float(ratio) ** towards, float(steep) ** upwards)
            try:
                tried = row_space(space.name, mesh, space.across.degree, grading, body.shape)
            except InputError:
                continue
            there = found.on(problem, {**of, body.name: tried}, interface)
            if there.elements >= _SPARE * there.needed:
                return Remedy(mesh, grading)
    return None


def _rows(height: float, across: int, contact: float | None) -> tuple[int, int]:
    """Return elements across and their grading with a first row no higher than a contact is wide.

    With a first row of 4 contact widths the pull-off force of a cylinder is 3.4 % too large, with one of 0.9
    widths 0.2 %.
    """
    if contact is None:
        return across, 1
    for rows in sorted({across, *(count for count in _ROWS if count > across)}):
        for ratio in (1, *_GRADINGS):
            rate = ratio ** (1 / max(rows - 1, 1))
            if rate > _NEIGHBOURS:
                break
            share = 1 / float(np.sum(rate ** np.arange(rows)))
            if height * share <= 2 * contact:
                return rows, ratio
    return max(across, _ROWS[-1]), _GRADINGS[-2]


def _softer(
    problem: Problem, space: RowSpace, found: Resolution, laboratory: Laboratory, interface: str
) -> str:
    """Return a text on the strength whose estimated process zone an affordable mesh resolves."""
    from scipy.optimize import brentq

    character = law_character(problem.interface_of(interface).law)
    modulus, height = compliant(problem, interface)
    along, across = space.elements
    most = _MOST_COLUMNS / (across + space.across.degree) / along
    # more than needed, as numbers of elements are rounded up
    longer = max(_SPARE_GRADED * found.needed / found.elements / most, 1.0) * _SPARE

    def misses(logarithm: float) -> float:
        irwin = modulus * character.work_of_adhesion / character.strength**2
        softer = float(np.exp(-2 * logarithm))
        return process_zone_length(irwin * softer, height) / process_zone_length(irwin, height) - longer

    # a zone of a slender body is longer by the root of the strength at least
    strength = character.strength * float(np.exp(brentq(misses, -2 * log(longer) - 1, 0.0)))
    return (
        "no mesh on which a run takes minutes has enough; but with a strength of "
        f"{laboratory.text(strength, 'stress', 3)} or less and the same work of adhesion, the zone is "
        "longer, and such a mesh exists"
    )


def _rounded_up(number: float) -> int:
    """Return the next number of two digits and zeros."""
    unit: int = 10 ** max(floor(log10(number)) - 1, 0)
    return int(ceil(number / unit) * unit)
