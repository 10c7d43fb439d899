"""The positions of fronts in the stored states of a run, and the energy release rate."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple, TypeAlias

import numpy as np

from isopeel.assembly.spaces import SpaceOfBodies
from isopeel.common.arrays import FloatArray
from isopeel.post.driven import driven_boundaries, driven_on, tied_with
from isopeel.post.front import ProcessZone, process_zones
from isopeel.problem import Boundary, Problem, raises_load
from isopeel.results.curve import Curve
from isopeel.results.fields import StoredState
from isopeel.solve.step import KINDS

#: Least distance of the front from its start, and from the end of the joint, in steady peeling: in lengths of
#: the process zone.
_AWAY = 2.0
#: Share of the length of a side within which a body tied to it ends where the side ends.
_AT_THE_END = 1e-9


class Front(NamedTuple):
    """The front in one state: the peak of the adhesive traction, with its process zone.

    `crack_length` is the distance along the undeformed face to the peak: from the end where the faces of a
    crack begin if there are any, else from the loaded end or the middle of the loaded part. It is None where
    the load acts on all of the body.
    """

    zone: ProcessZone
    crack_length: float | None


#: The fronts on one interface, by the numbers of the steps whose states have one.
Fronts: TypeAlias = Mapping[int, Front]


class Release(NamedTuple):
    """The energy release rate: energy per area that the front takes while it moves between two states."""

    rate: float  # G, a surface energy
    between: tuple[float, float]  # parameters, in the unit of their column


def fronts(
    problem: Problem, space: SpaceOfBodies, states: Sequence[StoredState], interface: str = ""
) -> dict[int, Front]:
    """Return the fronts in states by the numbers of their steps; states without one are left out.

    Of several interfaces one is chosen by its name.
    """
    origin = load_position(problem, interface)
    zones = process_zones(problem, space, states, interface)
    return {
        step: Front(zone, None if origin is None else abs(zone.position - origin))
        for step, zone in zones.items()
    }


def load_position(problem: Problem, interface: str = "") -> float | None:
    """Return the place along an adhering side from which cracks are measured; None where there is none."""
    boundary = problem.interface_of(interface).boundary
    length = problem.body_of(boundary.body).shape.boundary(boundary.side).length()
    end = _cracked_end(problem, boundary)
    if end is not None:
        return end * length
    loaded = driven_on(problem, boundary.body)
    if not loaded:
        tied = tied_with(problem, boundary.body)
        loaded = tuple(one for one in driven_boundaries(problem) if one.body in tied)
    if len(loaded) != 1:
        return None
    (one,) = loaded
    if one.body != boundary.body:
        share = _share_along(problem, boundary, one)
        # of a layer that is driven at one of its ends
        return (
            length * round(share)
            if abs(share - round(share)) < _AT_THE_END and round(share) in (0, 1)
            else None
        )
    ends = (
        {"left": 0.0, "right": length}
        if boundary.side in ("bottom", "top")
        else {"bottom": 0.0, "top": length}
    )
    if one.side in ends:
        return ends[one.side]
    if one.end - one.start > 0.25:
        return None
    # a part of the opposite side, whose parameter has the direction of that of the adhering side
    return length * (one.start + one.end) / 2


def _cracked_end(problem: Problem, boundary: Boundary) -> float | None:
    """Return the end of a side, 0 or 1, from which the faces of a crack reach to a joint, if any do."""
    for one in problem.interfaces:
        for side in (one.boundary, one.against):
            if one.adheres or not isinstance(side, Boundary):
                continue
            if (side.body, side.side) != (boundary.body, boundary.side):
                continue
            if side.start == 0.0 and side.end == boundary.start:
                return 0.0
            if side.end == 1.0 and side.start == boundary.end:
                return 1.0
    return None


def _share_along(problem: Problem, boundary: Boundary, other: Boundary) -> float:
    """Return where the middle of another boundary lies along the chord of a side, from 0 to 1."""
    start, end = problem.body_of(boundary.body).shape.boundary(boundary.side).evaluate([0.0, 1.0])
    curve = problem.body_of(other.body).shape.boundary(other.side)
    middle = curve.evaluate([(other.start + other.end) / 2])[0]
    return float((middle - start) @ (end - start) / ((end - start) @ (end - start)))


def joint_ends(problem: Problem, interface: str = "") -> tuple[float, float]:
    """Return the distances from the load to the ends of the adhering part, the nearer one first."""
    adhesion = problem.interface_of(interface)
    side = problem.body_of(adhesion.boundary.body).shape.boundary(adhesion.side)
    origin = load_position(problem, interface) or 0.0
    whole = side.length()
    # a side need not be parametrized by its length: lengths of its parts are sums of chords
    points = side.evaluate(np.linspace(0.0, 1.0, 401))
    along = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1)))
    places = np.interp([adhesion.start, adhesion.end], np.linspace(0.0, 1.0, 401), along * whole / along[-1])
    near, far = sorted(abs(float(place) - origin) for place in places)
    return near, far


def crack_lengths(found: Fronts) -> dict[int, float]:
    """Return the crack lengths by the numbers of their steps, where they are given."""
    return {step: front.crack_length for step, front in found.items() if front.crack_length is not None}


def crack_length_at(problem: Problem, curve: Curve, found: Fronts, parameter: float) -> float | None:
    """Return the crack length at a parameter of a curve, linear between the stored states on both sides.

    Outside of them it is the length in the nearest state with a front, plus the length `opened` in between.
    Returns None where there is no front, or the curve turns back.
    """
    known = sorted(
        (float(curve.parameter[step]), front.crack_length)
        for step, front in found.items()
        if front.crack_length is not None
    )
    if not known:
        return None
    at, lengths = np.array(known).T
    if at[0] <= parameter <= at[-1]:
        return float(np.interp(parameter, at, lengths))
    rise = np.diff(curve.parameter)
    if not ((rise > 0).all() or (rise < 0).all()):
        return None
    nearest = int(np.argmin(np.abs(at - parameter)))
    order = np.argsort(curve.parameter)
    opening = np.interp([at[nearest], parameter], curve.parameter[order], opened(problem, curve)[order])
    return float(lengths[nearest] + opening[1] - opening[0])


def opened(problem: Problem, curve: Curve) -> FloatArray:
    """Return the length (steps,) of the joint that has opened since the first step: its energy over W.

    It is valid for a joint that lies flat; one on waves does not take W on its whole area.
    """
    taken = curve.adhesive_energy + curve.dissipated_energy
    return (taken - taken[:1]) / problem.adhesion.law.work_of_adhesion


def work_between(problem: Problem, curve: Curve, first: int, last: int) -> float:
    """Return the work of the drive and of the held loads between two steps, by the trapezoidal rule."""
    part = slice(first, last + 1)
    parameter = curve.parameter[part] / curve.parameter_column.factor
    reaction = curve.reaction[part] / curve.reaction_column.factor
    path, force = (reaction, parameter) if raises_load(problem.drive) else (parameter, reaction)
    work = float(np.sum(np.diff(path) * (force[1:] + force[:-1]) / 2))
    if curve.load_work.size:
        work += float(curve.load_work[last] - curve.load_work[first])
    return work


def release(
    problem: Problem, curve: Curve, found: Fronts, start: float | None, interface: str = ""
) -> Release | None:
    """Return the energy release rate G = (work of the drive - stored energy gained)/(motion of the front).

    It is evaluated between the last state with a front and the first one from the parameter `start` on, or an
    earlier one. The front must be away from both ends of the joint, and move by more than its own length. The
    energy released in jumps is left out, as there is no equilibrium during a jump. Returns None where there
    are no two such states, or where the path met one of their parameters more than once.
    """
    near, far = joint_ends(problem, interface)
    steady = [
        (step, front.crack_length)
        for step, front in found.items()
        if front.crack_length is not None
        and near + _AWAY * front.zone.length <= front.crack_length <= far - _AWAY * front.zone.length
    ]
    if len(steady) < 2:
        return None
    j, longer = steady[-1]
    # the front is known to a part of an element: its motion must be much longer
    distant = [one for one in steady if longer - one[1] >= _AWAY * found[j].zone.length]
    if not distant:
        return None
    inside = [one for one in distant if start is not None and abs(curve.parameter[one[0]]) >= abs(start)]
    i, crack = inside[0] if inside else distant[-1] if start is not None else distant[0]
    first, last = float(curve.parameter[i]), float(curve.parameter[j])
    if any(np.count_nonzero(curve.parameter == at) != 1 for at in (first, last)):
        return None
    jumped = float(curve.released_energy[i + 1 : j + 1][jumps(curve)[i + 1 : j + 1]].sum())
    stored = float(curve.stored_energy[j] - curve.stored_energy[i])
    gained = work_between(problem, curve, i, j) - jumped - stored
    return Release(gained / (longer - crack), (first, last))


def jumps(curve: Curve) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Return which steps (steps,) jumped, or released more than a thousandth of the range of energies."""
    varied = np.ptp(curve.stored_energy) + np.ptp(curve.adhesive_energy) if len(curve) else 0.0
    jumped: np.ndarray[tuple[int], np.dtype[np.bool_]] = (curve.kind == KINDS.index("jump")) | (
        curve.released_energy > 1e-3 * varied
    )
    return jumped
