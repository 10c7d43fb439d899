"""The resolution of the peeling front by the elements of the adhering side, estimated and measured.

At a front the attraction rises and falls over a length that depends on law, material and thickness. With the
strength sigma and the work of adhesion W of the law, E' = E/(1 - nu^2) and the height h,

    l_I = E' W / sigma^2                    in a thick body (Irwin's and Hillerborg's characteristic length),
    l_s = (E' W / sigma^2)^(1/4) h^(3/4)    in a slender one (Yang and Cox, Int. J. Fract. 133, 2005; Turon,
                                            Davila, Camanho and Costa, Eng. Fract. Mech. 74, 2007)

up to factors. The process zone is the part where the attraction exceeds half of its peak
(`front.process_zone`). Its estimate is 1/(1/(0.47 l_s) + 1/(1.45 l_I)): the shorter length dominates. The
factors were fitted to strips that a moment peels from a rigid substrate, with exponential, bilinear and van
der Waals laws and l_I from 0.02 h to 88 h, where it is right within a quarter (`benchmarks/resolution.py`).
Of l_I, 1.45 is near twice the 9 pi/32 of a crack with the same body on both sides (Rice, 1968): one side is
rigid here, which halves the compliance.

The reach of the law is the length over which the attraction falls from its peak to a fiftieth of it. At a
front the gap grows with the square of the distance. So the reach is 0.88 sqrt(d_r/d_z) process zones, where
the attraction has fallen to a fiftieth at the opening d_r and to a half at d_z (fitted in the same way).

Two bodies that adhere to each other have the process zone of one body on a rigid substrate with

    1/E' = 1/E'_1 + 1/E'_2,    1/(E' h^3) = 1/(E'_1 h_1^3) + 1/(E'_2 h_2^3),

as the openings of both add up: those of half spaces, and those of bent strips. Of two equal bodies this is
one of them and its mirror image.

A body that touches the substrate, such as a cylinder, is attracted where its shape leaves a small gap: where
that part is shorter than the estimate, its length is used.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import sqrt
from typing import Self

import numpy as np

from isopeel.assembly.interface import InterfacePoints
from isopeel.assembly.spaces import SpaceOfBodies, spaces_by_name
from isopeel.common.arrays import BoolArray, FloatArray
from isopeel.common.errors import InputError
from isopeel.physics.adhesion import AdhesionLaw
from isopeel.physics.batch import evaluate_substrate
from isopeel.physics.materials.base import plane_strain_modulus
from isopeel.post.driven import driven_on
from isopeel.post.front import ProcessZone
from isopeel.post.law import law_character
from isopeel.problem import Boundary, Problem
from isopeel.results.curve import Curve
from isopeel.splines.nurbs import Side
from isopeel.splines.space import SplineSpace

#: Process zone over the lengths of slender and of thick bodies, and reach over process zone (see above).
_SLENDER, _THICK, _REACH = 0.47, 1.45, 0.88
#: Number of places along the adhering side at which its gap at rest is evaluated.
_PLACES = 2001
_OPPOSITE: dict[Side, Side] = {"left": "right", "right": "left", "bottom": "top", "top": "bottom"}
#: Variation of a gap, as a share of the length of the joint, that is round-off.
EVEN = 1e-9


@dataclass(frozen=True)
class Resolution:
    """A process zone on the adhering side, and the elements there; lengths in L0."""

    zone: float  # length of the process zone
    reach: float  # length over which the law acts ahead of its peak
    element: float  # the longest element in the zone
    needed: float  # number of elements in the zone that the space needs
    stretches: tuple[tuple[float, float], ...]  # of the side, around the fronts, where elements count
    contact: float | None = None  # half of the width over which a body touches, where that is a part of it

    @property
    def elements(self) -> float:
        """Elements in the process zone."""
        return self.zone / self.element

    @property
    def elements_in_reach(self) -> float:
        """Elements in the reach of the law."""
        return self.reach / self.element

    @property
    def is_enough(self) -> bool:
        """Whether the zone has the elements that the space needs."""
        return self.elements >= self.needed

    def on(self, problem: Problem, space: SpaceOfBodies, interface: str = "") -> "Resolution":
        """Return the resolution of the same zone on another space."""
        ends = ends_along(problem, space, interface)
        longest = max(_longest(ends, *stretch) for stretch in self.stretches)
        needed = needed_elements(functions_along(problem, space, interface))
        return replace(self, element=longest, needed=needed)

    def summary(self) -> dict[str, float]:
        """Plain numbers."""
        return {
            "length": self.zone,
            "elements": self.elements,
            "needed": self.needed,
            "reach": self.reach,
            "elements_in_reach": self.elements_in_reach,
        }


def process_zone_length(irwin: float, height: float) -> float:
    """Return the estimated length of the process zone of a body of a height, from l_I = E' W/sigma^2."""
    slender = sqrt(sqrt(irwin * height**3))
    return 1 / (1 / (_SLENDER * slender) + 1 / (_THICK * irwin))


def needed_elements(functions: SplineSpace) -> float:
    """Return the number of elements in the process zone with which a plateau is right within about 1 %.

    It follows from the number of functions needed in the zone: 1 for smooth splines, 0.7 for those of degree
    4 and more, 1.8 for C0 splines of degree 2 and more (`benchmarks/resolution.py`).
    """
    smooth = functions.degree - 1
    if functions.elements > 1:
        smooth = int(np.median(functions.continuities))
    if smooth == 0 and functions.degree > 1:
        return 1.8 / functions.degree
    return (0.7 if smooth >= 3 else 1.0) / (functions.degree - smooth)


def estimated(problem: Problem, space: SpaceOfBodies, interface: str = "") -> Resolution | None:
    """Return the estimated resolution where the front on an interface starts; None if its law has no peak.

    A body that lies on the substrate begins to peel at the ends of the adhering part that face the drive. A
    body that touches it begins at the edge of the contact: that given by its shape and the law, or that of
    Johnson, Kendall and Roberts at pull-off where it is wider.
    """
    law = problem.interface_of(interface).law
    try:
        character = law_character(law)
    except InputError:
        return None
    places, gap = _at_rest(problem, space, interface)
    opened = character.softened_gap - law.equilibrium_gap
    modulus, height = compliant(problem, interface)
    irwin = modulus * character.work_of_adhesion / character.strength**2
    touches, lowest = gap - gap.min() < opened, int(np.argmin(gap))
    edge = None
    if touches.all():
        fronts = [float(places[end]) for end in _ends_at_the_drive(problem, interface)]
        limit = float(places[-1] - places[0])
    else:
        limit = _beside(places, touches, lowest)
        radius = limit**2 / (2 * opened)
        edge = max(limit, float((2 * character.work_of_adhesion * radius**2 / (np.pi * modulus)) ** (1 / 3)))
        around = places[lowest] + np.array([-edge, edge])
        fronts = [float(front) for front in around if places[0] <= front <= places[-1]] or [float(places[-1])]
    zone = min(process_zone_length(irwin, height), limit)
    stretches = tuple((front - zone, front + zone) for front in fronts)
    return _resolution(problem, space, zone, stretches, edge, interface)


def measured(problem: Problem, space: SpaceOfBodies, zone: ProcessZone, interface: str = "") -> Resolution:
    """Return the resolution of a process zone that was found in a state, and of the reach beside it."""
    before = estimated(problem, space, interface)
    contact = None if before is None else before.contact
    return _resolution(problem, space, zone.length, ((zone.start, zone.end),), contact, interface)


def _resolution(
    problem: Problem,
    space: SpaceOfBodies,
    zone: float,
    stretches: tuple[tuple[float, float], ...],
    contact: float | None,
    interface: str,
) -> Resolution:
    reach = zone * _reach(problem.interface_of(interface).law)
    return Resolution(zone, reach, zone, 1.0, stretches, contact).on(problem, space, interface)


def elements_are_tall(problem: Problem, space: SpaceOfBodies, body: str = "") -> bool:
    """Return whether the first element above a lower side that adheres is twice as high as the shortest long.

    Of several bodies one is chosen by its name.
    """
    name = body or problem.body.name
    shape, own = problem.body_of(name).shape, spaces_by_name(problem, space)[name]
    length, height = (
        max(shape.boundary(side).length() for side in pair) for pair in (("bottom", "top"), ("left", "right"))
    )
    first = height * np.diff(own.across.breakpoints)[0]
    lower = any(one.boundary.body == name and one.side == "bottom" for one in problem.faces)
    return bool(lower and first > 2 * length * np.diff(own.rows[0].breakpoints).min())


def lies_flat(problem: Problem, space: SpaceOfBodies, interface: str = "") -> bool:
    """Return whether the adhering part is everywhere as far from what it adheres to at rest."""
    places, gap = _at_rest(problem, space, interface)
    return bool(np.ptp(gap) <= EVEN * (places[-1] - places[0]))


def parts_at_once(problem: Problem, space: SpaceOfBodies, interface: str = "") -> bool:
    """Return whether a joint opens uniformly, without a front, as below a bar that is pulled.

    Of several bodies each must be so, or have both of these sides held.
    """
    adhesion = problem.interface_of(interface)
    boundaries = [adhesion.boundary]
    if isinstance(adhesion.against, Boundary):
        boundaries.append(adhesion.against)
    flat = all(one.is_whole and _stays_flat(problem, one) for one in boundaries)
    return bool(flat and lies_flat(problem, space, interface))


def _stays_flat(problem: Problem, boundary: Boundary) -> bool:
    """Return whether a body is driven, or held beside another one, on the side opposite to a boundary."""
    opposite = _OPPOSITE[boundary.side]
    across = 0 if boundary.side in ("bottom", "top") else 1
    beside = {"left", "right"} if across == 0 else {"bottom", "top"}
    supports = [one for one in problem.supports if one.boundary.body == boundary.body]
    held = beside <= {one.side for one in supports if across in one.components and one.boundary.is_whole}
    alone = held or problem.body_of(boundary.body).material.poissons_ratio == 0
    driven = problem.driven_side == opposite and driven_on(problem, boundary.body)
    fixed = len(problem.bodies) > 1 and is_held(problem, boundary.body, opposite)
    return bool(alone and (driven or fixed))


def is_held(problem: Problem, body: str, side: Side) -> bool:
    """Return whether a whole side of a body is held: a lower or upper one along y, another one along x."""
    across = 1 if side in ("bottom", "top") else 0
    return any(
        (one.boundary.body, one.side) == (body, side) and across in one.components and one.boundary.is_whole
        for one in problem.supports
    )


@dataclass(frozen=True)
class Zones:
    """The process zone as estimated before the first step, and as measured in stored states.

    The measured ones are those of the states with a front, in order, each with its parameter.
    """

    estimated: Resolution | None = None
    measured: Sequence[tuple[float, Resolution]] = ()

    @classmethod
    def of(
        cls,
        problem: Problem,
        space: SpaceOfBodies,
        curve: Curve,
        zones: Mapping[int, ProcessZone],
        interface: str = "",
    ) -> Self:
        """Return the zones on an interface; `zones` are the process zones of steps of a curve."""
        found = [
            (float(curve.parameter[step]), measured(problem, space, zone, interface))
            for step, zone in zones.items()
            if zone.length > 0
        ]
        return cls(estimated(problem, space, interface), found)

    @property
    def last(self) -> tuple[float, Resolution] | None:
        """Parameter and process zone of the last state that has a front."""
        return self.measured[-1] if self.measured else None

    @property
    def worst(self) -> tuple[float, Resolution] | None:
        """Parameter and process zone of the state with the fewest elements in it."""
        return min(self.measured, key=lambda item: item[1].elements, default=None)

    def summary(self, parameter: str) -> dict[str, dict[str, float] | None]:
        """Return plain numbers in L0: the estimated and the last measured zone, with its named parameter."""
        last = self.last
        return {
            "estimated": None if self.estimated is None else self.estimated.summary(),
            "measured": None if last is None else {parameter: last[0], **last[1].summary()},
        }


def _reach(law: AdhesionLaw) -> float:
    """Return the reach of a law over the process zone; 1 of a law without a peak."""
    try:
        character = law_character(law)
    except InputError:
        return 1.0
    opened, spent = (gap - law.equilibrium_gap for gap in (character.softened_gap, character.spent_gap))
    return _REACH * sqrt(spent / opened)


def functions_along(problem: Problem, space: SpaceOfBodies, interface: str = "") -> SplineSpace:
    """Return the functions along the adhering side."""
    boundary = problem.interface_of(interface).boundary
    own = spaces_by_name(problem, space)[boundary.body]
    rows: dict[Side, SplineSpace] = {"bottom": own.rows[0], "top": own.rows[-1]}
    return rows.get(boundary.side, own.across)


def ends_along(problem: Problem, space: SpaceOfBodies, interface: str = "") -> FloatArray:
    """Return the ends (elements + 1,) of the elements along the adhering side at rest, from its start."""
    ends = functions_along(problem, space, interface).breakpoints
    boundary = problem.interface_of(interface).boundary
    curve = problem.body_of(boundary.body).shape.boundary(boundary.side)
    # chords of parts of each element: the elements of a bent side are its arcs
    parts = (ends[:-1, None] + np.diff(ends)[:, None] * np.arange(4) / 4).ravel()
    points = curve.evaluate(np.append(parts, ends[-1]))
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1).reshape(-1, 4).sum(axis=1)
    return np.concatenate([[0.0], np.cumsum(lengths)])


def _longest(ends: FloatArray, start: float, end: float) -> float:
    """Return the longest element, of ends (elements + 1,), that overlaps a part of the side."""
    covered = (ends[1:] > start) & (ends[:-1] < end)
    return float(np.diff(ends)[covered].max()) if covered.any() else float(np.diff(ends)[-1])


def _ends_at_the_drive(problem: Problem, interface: str) -> list[int]:
    """Return the ends of an adhering part that face the drive, 0 and -1 for its start and its end.

    Where the drive acts on the other body only, they are the ends next to it; without such a drive both.
    """
    boundary, against = problem.interface_of(interface).boundary, problem.interface_of(interface).against
    loaded = {one.side for one in driven_on(problem, boundary.body)}
    ends = [end for side, end in (("left", 0), ("right", -1)) if side in loaded]
    if loaded or not isinstance(against, Boundary):
        return ends or [0, -1]
    drives = [one for one in driven_on(problem, against.body) if one.side in ("left", "right")]
    if not drives:
        return [0, -1]
    side = problem.body_of(boundary.body).shape.boundary(boundary.side)
    at = side.evaluate(np.array(boundary.part))
    other = problem.body_of(against.body).shape
    distances = [np.linalg.norm(at - other.boundary(one.side).evaluate([0.5]), axis=1) for one in drives]
    return sorted({-int(np.argmin(one)) for one in distances}, reverse=True)


def _at_rest(problem: Problem, space: SpaceOfBodies, interface: str) -> tuple[FloatArray, FloatArray]:
    """Return places (n,) along the adhering part, from the start of its side, and the gaps at rest there."""
    adhesion = problem.interface_of(interface)
    curve = problem.body_of(adhesion.boundary.body).shape.boundary(adhesion.side)
    along = np.linspace(adhesion.start, adhesion.end, _PLACES)
    points = curve.evaluate(along)
    first = curve.length(adhesion.start) if adhesion.start > 0 else 0.0
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if isinstance(adhesion.against, Boundary):
        at_rest = np.zeros((sum(one.size for one in spaces_by_name(problem, space).values()), 2))
        gap = InterfacePoints(problem, space, along[:, None], interface=interface).gap(at_rest)[:, 0]
    else:
        gap, _, _ = evaluate_substrate(adhesion.against.kernel, adhesion.against.parameters, points)
    return first + np.concatenate([[0.0], np.cumsum(steps)]), gap


def _beside(places: FloatArray, touches: BoolArray, lowest: int) -> float:
    """Return the length of the contact on one side of the lowest place, where it is longer."""
    apart = np.flatnonzero(~touches)
    before, after = apart[apart < lowest], apart[apart > lowest]
    start = places[before[-1] + 1] if before.size else places[0]
    end = places[after[0] - 1] if after.size else places[-1]
    step = float(np.diff(places).max())
    return max(float(places[lowest] - start), float(end - places[lowest]), step)


def body_height(problem: Problem, interface: str = "") -> float:
    """Return the thickness of the body above the adhering side, in the middle of the adhering part."""
    return _height_above(problem, problem.interface_of(interface).boundary)


def compliant(problem: Problem, interface: str = "") -> tuple[float, float]:
    """Return E' and height of the body that has the front of an interface on a rigid substrate, see above."""
    adhesion = problem.interface_of(interface)
    boundaries = [adhesion.boundary]
    if not isinstance(adhesion.against, Boundary):
        modulus = plane_strain_modulus(problem.body_of(adhesion.boundary.body).material)
        return modulus, _height_above(problem, adhesion.boundary)
    boundaries.append(adhesion.against)
    moduli = np.array([plane_strain_modulus(problem.body_of(one.body).material) for one in boundaries])
    heights = np.array([_height_above(problem, one) for one in boundaries])
    modulus = 1 / float(np.sum(1 / moduli))
    return modulus, float((modulus * np.sum(1 / (moduli * heights**3))) ** (-1 / 3))


def _height_above(problem: Problem, boundary: Boundary) -> float:
    shape = problem.body_of(boundary.body).shape
    at, ends = (boundary.start + boundary.end) / 2, (0.0, 1.0)
    if boundary.side in ("bottom", "top"):
        points = shape.evaluate(np.full(2, at), np.array(ends))
    else:
        points = shape.evaluate(np.array(ends), np.full(2, at))
    return float(np.linalg.norm(points[1] - points[0]))
