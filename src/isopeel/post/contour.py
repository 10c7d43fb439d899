"""The J-integral of a front, by sections of the bodies ahead of it and behind it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from isopeel.assembly.interface import InterfacePoints, InterfaceState
from isopeel.assembly.spaces import SpaceOfBodies, spaces_by_name
from isopeel.assembly.tables import element_ends
from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion import Contact
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.batch import evaluate_law
from isopeel.physics.joints import JointLaw
from isopeel.physics.substrates import Flat
from isopeel.post.front import POINTS
from isopeel.post.sections import section_means
from isopeel.post.straight_side import OPPOSITE, StraightSide, straight_side
from isopeel.problem import Boundary, Interface, Problem
from isopeel.results.fields import StoredState

#: Where sections are, as shares of the way from the front to the end of the free part or of the joint.
_FROM, _TO = 0.5, 0.75
#: Traction of a joint, over its largest one, below which its faces have parted.
_PARTED = 1e-3
#: Share of the work of adhesion that is left at the open end of a joint that has parted.
_LEFT = 1e-2
#: Sine of an angle that is round-off.
_ROUND_OFF = 1e-9


@dataclass(frozen=True, eq=False)
class Arm:
    """One body at a front."""

    ahead: Boundary  # the part of its side at which sections ahead of the front begin
    behind: Boundary  # and behind it, where the joint is open
    front: float  # parameter along its side
    height: float


@dataclass(frozen=True, eq=False)
class Contour:
    """The sections around a front."""

    arms: tuple[Arm, ...]  # of the body of the interface, and of the other one if there is one
    along: FloatArray  # e (2,), along the undeformed joint towards its open part
    normal: FloatArray  # (2,) of the joint at the front in the present state, out of the other body
    place: float  # of the largest traction, along the undeformed side of the interface
    neglected: float  # energy per area that the interface has beyond the sections
    parted: bool  # whether the joint has parted at its open end


@dataclass(frozen=True)
class JIntegral:
    """The energy per area that flows to a front.

    `neglected` is the part of it that the contour does not enclose: the energy per area that the interface
    stores ahead of the sections, and that it can still take behind them. Before the joint has `parted` at its
    open end, the front takes less than the whole work of separation. `place` is that of the front along the
    undeformed side, from where its parameter begins.
    """

    value: float
    neglected: float
    parted: bool
    place: float


def j_integral(
    problem: Problem, space: SpaceOfBodies, state: StoredState, interface: str = ""
) -> JIntegral | str:
    """Return the J-integral of the front of an interface in a state, or why it is not given.

    With the unit vector e along the undeformed joint towards its open part, and N = e on all sections,

        J = sum over the bodies of I(ahead) - I(behind),  I = int [psi - e . (F - 1)^T P e] dA

    (Rice, J. Appl. Mech. 35, 1968; at finite strain with the tensor of Eshelby, J. Elast. 5, 1975). I is a
    mean over sections far from the front; where the faces are free or at rest, all sections have the same I.
    Neither the law of the interface nor the motion of the front is used. It is per width, in the units of
    the problem. Of several interfaces one is chosen by its name.
    """
    contour = find_contour(problem, space, state, interface)
    if isinstance(contour, str):
        return contour
    both = 2 if isinstance(problem.interface_of(interface).law, Mirrored) else 1
    value = 0.0
    for arm in contour.arms:
        ahead, behind = (
            section_means(problem, space, state.displacement, part, contour.along, np.zeros(2))
            for part in (arm.ahead, arm.behind)
        )
        value += both * (ahead.energy - behind.energy)
    return JIntegral(value, both * contour.neglected, contour.parted, contour.place)


def find_contour(
    problem: Problem, space: SpaceOfBodies, state: StoredState, interface: str = ""
) -> Contour | str:
    """Return the sections around the front of an interface in a state, or why there are none."""
    joint = problem.interface_of(interface)
    sides = _sides(joint)
    lines = [straight_side(problem, side) for side in sides]
    whole = [line for line in lines if line is not None]
    reason = _unfit(problem, joint, whole)
    if reason:
        return reason
    own = spaces_by_name(problem, space)[joint.boundary.body]
    ends = element_ends(own, joint.side, joint.boundary.part)
    parameters = (ends[:-1, None] + np.diff(ends)[:, None] * POINTS).ravel()
    points = InterfacePoints(problem, space, parameters.reshape(-1, POINTS.size), interface=interface)
    found = points.state(state.displacement, state.maximum_openings)
    pull = np.hypot(np.maximum(-found.normal_traction, 0.0), found.tangential_traction).ravel()
    peak = int(np.argmax(pull))
    if not pull[peak] > 0:
        return "the joint carries no traction"
    along = _opens_towards(found, peak) * whole[0].direction
    measured = [line.measured(whole[0].start, along) for line in whole]
    front = measured[0].place(parameters[peak])
    # sections of both bodies are at the same places, as the joint ahead of the front may carry tractions;
    # there they end with the joint
    low = max(
        min(line.place(side.start), line.place(side.end)) for line, side in zip(measured, sides, strict=True)
    )
    low, high = max(low, *(line.ends[0] for line in measured)), min(line.ends[1] for line in measured)
    for line in measured:
        for start, end in _loaded(problem, line, whole[0].start, along):
            if start <= front <= end:
                return f"{line.side.body} is loaded beside the front"
            low, high = (max(low, end), high) if end < front else (low, min(high, start))
    if not low < front < high:
        return "the front is at the end of the joint or of a body"
    arms = []
    for line in measured:
        ahead, behind = (
            line.part(front + _FROM * (end - front), front + _TO * (end - front)) for end in (low, high)
        )
        arms.append(Arm(ahead, behind, line.parameter(front), line.height))
    edge = -1 if along @ whole[0].direction > 0 else 0
    rest = _rest(joint, found, parameters, pull, arms[0], edge)
    if isinstance(rest, str):
        return rest
    normal = found.normal.reshape(-1, 2)[peak]
    return Contour(tuple(arms), along, normal, whole[0].place(parameters[peak]), *rest)


def _sides(interface: Interface) -> list[Boundary]:
    other = interface.against
    return [interface.boundary, other] if isinstance(other, Boundary) else [interface.boundary]


def _unfit(problem: Problem, joint: Interface, lines: Sequence[StraightSide]) -> str:
    """Return why a contour around the front of an interface has no meaning; nothing where it has."""
    if not joint.has_potential:
        return "the forces of the interface have no energy"
    if isinstance(joint.law, Contact):
        return "nothing adheres"
    if not isinstance(joint.against, Boundary | Flat):
        return "the substrate is not flat"
    sides = _sides(joint)
    directions = [line.direction for line in lines]
    if isinstance(joint.against, Flat):
        directions.append(np.array([np.sin(joint.against.angle), -np.cos(joint.against.angle)]))
    turned = [abs(directions[0][0] * one[1] - directions[0][1] * one[0]) for one in directions]
    if len(lines) < len(sides) or max(turned) > _ROUND_OFF:
        return "the sides that face each other, and the opposite ones, are not straight and parallel"
    tied = {_name(one) for tie in problem.ties for one in (tie.boundary, tie.to)}
    if tied & {f"{one.body}.{side}" for one in sides for side in (one.side, OPPOSITE[one.side])}:
        return "a side of one of the bodies is tied, and sections end there"
    for other in problem.interfaces:
        beside = _sides(other)
        if joint in other.faces:
            continue
        if not {one.body for one in beside} & {one.body for one in sides}:
            continue
        cracked = isinstance(other.law, Contact) or getattr(other.law, "initial_damage", 0.0) == 1.0
        if not cracked or {*map(_name, beside)} != {*map(_name, sides)}:
            return "another interface acts on the same body"
    return ""


def _name(boundary: Boundary) -> str:
    return f"{boundary.body}.{boundary.side}"


def _loaded(
    problem: Problem, line: StraightSide, origin: FloatArray, along: FloatArray
) -> Iterator[tuple[float, float]]:
    """Yield the places where the drive and held loads act on a side or on the opposite one."""
    side = line.side
    boundaries = [one.boundary for one in problem.driven] + [one.boundary for one in problem.loads]
    for one in boundaries:
        if one.body != side.body or one.side not in (side.side, OPPOSITE[side.side]):
            continue
        found = straight_side(problem, one)
        assert found is not None
        there = found.measured(origin, along)
        start, end = sorted((there.place(one.start), there.place(one.end)))
        yield start, end


def _opens_towards(found: InterfaceState, peak: int) -> float:
    """Return 1 if a joint is open beyond its largest traction along the side, else -1."""
    energy = (found.energy + found.dissipated).ravel()
    if peak in (0, energy.size - 1):
        return 1.0 if peak else -1.0
    return 1.0 if energy[peak + 1 :].mean() > energy[:peak].mean() else -1.0


def _rest(
    joint: Interface, found: InterfaceState, parameters: FloatArray, pull: FloatArray, arm: Arm, edge: int
) -> tuple[float, bool] | str:
    """Return the energy per area beyond the sections and whether the edge has parted, or why not."""
    ahead, behind = (
        (parameters >= part.start) & (parameters <= part.end) for part in (arm.ahead, arm.behind)
    )
    if isinstance(joint.law, JointLaw):
        limit = _PARTED * pull.max()
        if pull[behind].max(initial=0.0) > limit:
            return "the joint still carries traction where the arms are cut behind the front"
        energy = (found.energy + found.dissipated).ravel()
        return (float(energy[ahead].mean()) if ahead.any() else 0.0), bool(pull[edge] <= limit)
    law, gap = joint.law, found.gap.ravel()
    potential, _, _ = evaluate_law(law.kernel, law.parameters, gap, np.zeros(gap.size))
    stored = float(potential[ahead].mean()) + law.work_of_adhesion if ahead.any() else 0.0
    # beyond the joint nothing attracts
    left = -float(potential[behind].mean()) if behind.any() else 0.0
    return stored + left, bool(-potential[edge] <= _LEFT * law.work_of_adhesion)
