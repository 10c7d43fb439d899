"""The J-integral of a front, by sections of the bodies ahead of it and behind it."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from isopeel.assembly.interface import InterfacePoints, InterfaceState
from isopeel.assembly.spaces import SpaceOfBodies, spaces_by_name
from isopeel.assembly.tables import element_ends
from isopeel.common.arrays import FloatArray
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
#: Traction over Young's modulus that is round-off.
NO_TRACTION = 1e-12
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
    layers: tuple[Arm, ...]  # of bodies that are tied to these, one upon the other
    copies: int  # 2 where the bodies are one half of a symmetric joint
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
    open end, which is the last point with a partner, the front takes less than the whole work of separation.
    `place` is that of the front along the undeformed side, from where its parameter begins.
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

    (Rice, J. Appl. Mech. 35, 1968; at finite strain with the tensor of Eshelby, J. Elast. 5, 1975). Layers
    that are tied to a body belong to its sections: nothing flows into a tie along e, where F e and P N do
    not jump. I is a mean over sections far from the front; where the faces are free or at rest, all sections
    have the same I. Neither the law of the interface nor the motion of the front is used. It is per width, in
    the units of the problem. Of several interfaces one is chosen by its name.
    """
    contour = Contours(problem, space, interface).around(state)
    return contour if isinstance(contour, str) else flow_through(problem, space, state.displacement, contour)


def flow_through(
    problem: Problem, space: SpaceOfBodies, displacement: FloatArray, contour: Contour
) -> JIntegral:
    """Return the J-integral by the sections of a contour, at coefficients (size, 2): see `j_integral`."""
    value = 0.0
    for arm in (*contour.arms, *contour.layers):
        ahead, behind = (
            section_means(problem, space, displacement, part, contour.along, np.zeros(2))
            for part in (arm.ahead, arm.behind)
        )
        value += contour.copies * (ahead.energy - behind.energy)
    return JIntegral(value, contour.copies * contour.neglected, contour.parted, contour.place)


class Contours:
    """The sections around the front of an interface, found in states of a run.

    Of several interfaces one is chosen by its name. What does not depend on the state is made once.
    """

    def __init__(self, problem: Problem, space: SpaceOfBodies, interface: str = "") -> None:
        self._problem = problem
        joint = self._joint = problem.interface_of(interface)
        self._sides = _sides(joint)
        stacks = [_layers(problem, side) for side in self._sides]
        layers = [side for stack in stacks for side in stack]
        lines = [straight_side(problem, side) for side in (*self._sides, *layers)]
        self._lines = [line for line in lines if line is not None]
        #: Why a contour around this front has no meaning; empty where it has.
        self.reason: str = _unfit(problem, joint, len(lines), self._lines)
        if self.reason:
            return
        own = spaces_by_name(problem, space)[joint.boundary.body]
        ends = element_ends(own, joint.side, joint.boundary.part)
        self._parameters = (ends[:-1, None] + np.diff(ends)[:, None] * POINTS).ravel()
        self._points = InterfacePoints(
            problem, space, self._parameters.reshape(-1, POINTS.size), interface=interface
        )

    def around(self, state: StoredState) -> Contour | str:
        """Return the sections around the front in a state, or why there are none."""
        if self.reason:
            return self.reason
        joint, whole, parameters = self._joint, self._lines, self._parameters
        found = self._points.state(state.displacement, state.maximum_openings)
        pull = np.hypot(np.maximum(-found.normal_traction, 0.0), found.tangential_traction).ravel()
        peak = int(np.argmax(pull))
        material = self._problem.body_of(joint.boundary.body).material
        if not pull[peak] > NO_TRACTION * material.youngs_modulus:
            return "the joint carries no traction"
        along = _opens_towards(found, peak) * whole[0].direction
        measured = [line.measured(whole[0].start, along) for line in whole]
        front = measured[0].place(parameters[peak])
        # sections of all bodies are at the same places, as the joint ahead of the front may carry tractions;
        # there they end with the joint
        low = max(
            min(line.place(side.start), line.place(side.end))
            for line, side in zip(measured, self._sides, strict=False)
        )
        low = max(low, *(line.ends[0] for line in measured))
        high = min(line.ends[1] for line in measured)
        for line in measured:
            for start, end in _loaded(self._problem, line, whole[0].start, along):
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
        # a point without a partner has no energy, however near the other body is
        has_partner = np.flatnonzero(self._points.has_partner(state.displacement))
        edge = int(has_partner[-1 if along @ whole[0].direction > 0 else 0])
        rest = _rest(joint, found, parameters, pull, arms[0], edge)
        if isinstance(rest, str):
            return rest
        sides, normal = len(self._sides), found.normal.reshape(-1, 2)[peak]
        copies = 2 if isinstance(joint.law, Mirrored) else 1
        place = whole[0].place(parameters[peak])
        return Contour(tuple(arms[:sides]), tuple(arms[sides:]), copies, along, normal, place, *rest)


def _sides(interface: Interface) -> list[Boundary]:
    other = interface.against
    return [interface.boundary, other] if isinstance(other, Boundary) else [interface.boundary]


def _layers(problem: Problem, side: Boundary) -> list[Boundary]:
    """Return the sides of bodies that are tied to a body opposite a side, one upon the other."""
    found: list[Boundary] = []
    outer = Boundary(side.body, OPPOSITE[side.side])
    while len(found) < len(problem.bodies):
        pairs = [(tie.boundary, tie.to) for tie in problem.ties]
        there = [other for one, other in (*pairs, *((b, a) for a, b in pairs)) if _name(one) == _name(outer)]
        found += [Boundary(one.body, one.side) for one in there]
        if len(there) != 1:
            break
        outer = Boundary(there[0].body, OPPOSITE[there[0].side])
    return found


def _unfit(problem: Problem, joint: Interface, count: int, lines: Sequence[StraightSide]) -> str:
    """Return why a contour around the front of an interface has no meaning; nothing where it has.

    `lines` are those of the `count` sides that are straight.
    """
    if not joint.has_potential:
        return "the forces of the interface have no energy"
    if not joint.adheres:
        return "nothing adheres"
    if not isinstance(joint.against, Boundary | Flat):
        return "the substrate is not flat"
    sides = _sides(joint)
    directions = [line.direction for line in lines]
    if isinstance(joint.against, Flat):
        directions.append(np.array([np.sin(joint.against.angle), -np.cos(joint.against.angle)]))
    turned = [abs(directions[0][0] * one[1] - directions[0][1] * one[0]) for one in directions]
    if len(lines) < count or max(turned) > _ROUND_OFF:
        return "the sides that face each other, and the opposite ones, are not straight and parallel"
    tied = [_name(one) for tie in problem.ties for one in (tie.boundary, tie.to)]
    if any(name in tied for name in map(_name, sides)):
        return "a part of the side of the joint is tied"
    # tied sides of the bodies, once each
    if any(tied.count(name) > 1 for line in lines for name in _faces(line.side)):
        return "several bodies are tied to one side"
    bodies = {line.side.body for line in lines}
    for other in problem.interfaces:
        beside = _sides(other)
        if joint in other.faces:
            continue
        if not {one.body for one in beside} & bodies:
            continue
        if other.adheres or {*map(_name, beside)} != {*map(_name, sides)}:
            return "another interface acts on the same body"
    return ""


def _faces(side: Boundary) -> tuple[str, str]:
    return _name(side), f"{side.body}.{OPPOSITE[side.side]}"


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
