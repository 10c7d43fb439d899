"""Checks before the first step: whether a body overlaps the substrate, or can move without a force."""

from collections.abc import Mapping, Sequence

import numpy as np

from isopeel.assembly.closest_point_kernel import NONE
from isopeel.assembly.control import Control
from isopeel.assembly.facing_term import FacingTerm
from isopeel.assembly.interface_term import substrate_tangents
from isopeel.assembly.pair_term import PairTerm
from isopeel.assembly.sizes import ROUND_OFF, extent, extent_of
from isopeel.assembly.spaces import HELD, Spaces
from isopeel.assembly.tables import SideTable
from isopeel.assembly.tie_kernel import Followers
from isopeel.common.arrays import FloatArray, IntArray, frozen
from isopeel.common.errors import InputError
from isopeel.physics.adhesion.irreversible import check_envelope
from isopeel.physics.batch import evaluate_law, evaluate_substrate
from isopeel.problem import Boundary, Interface
from isopeel.problem.boundary import boundary_names
from isopeel.splines.nurbs import NurbsSurface
from isopeel.splines.rows import RIGID, RowSpace


def check_start(
    spaces: Spaces,
    sides: Sequence[SideTable | FacingTerm | PairTerm],
    control: Control,
    base: FloatArray | None,
) -> list[FloatArray]:
    """Return the substrate's tangents (E, Q, 2) at the points of each interface with one, where all is well.

    Raises InputError where a body overlaps the substrate or another body, where a point of it has no one
    closest point on the substrate, where it can move as a whole without a force, or where a law cannot be
    irreversible.
    """
    problem = spaces.problem
    held: list[FloatArray] = []
    tangents, idle = [], []
    numbers = [n for n, one in enumerate(problem.interfaces, start=1) for _ in one.faces]
    for number, interface, side in zip(numbers, problem.faces, sides, strict=True):
        size = extent_of(problem.body_of(interface.boundary.body))
        try:
            if isinstance(side, FacingTerm):
                rows = _check_facing(spaces, side, size, base)
                held.append(rows)
                if not len(rows):
                    idle.append(_names(interface))
                continue
            if isinstance(side, PairTerm):
                held += _held_by_pairs(spaces, side, size, base)
                continue
            several, tangent = _check_interface(interface, side, size, base)
        except InputError as error:
            if len(problem.interfaces) == 1:
                raise
            raise InputError(f"interface.{number}.{error.field}", error.value, error.allowed) from error
        held += [_of_body(spaces, interface.boundary.body, row) for row in several]
        tangents.append(frozen(tangent))
    free = _free_motion(_held(spaces, held, control), {body.name: extent_of(body) for body in problem.bodies})
    if free is not None:
        allowed = "nothing prevents this motion of the body; hold a side, or let it adhere"
        if idle:
            allowed += f" (no law acts between {'; '.join(dict.fromkeys(idle))} at the start)"
        raise InputError("held", free, allowed)
    return tangents


def _of_body(spaces: Spaces, body: str, rows: FloatArray) -> FloatArray:
    """Return rows (n, 3) for the rigid motions of one body as rows (n, 3 bodies) for those of all."""
    number, count = list(spaces.places).index(body), len(spaces.places)
    return np.pad(rows, ((0, 0), (3 * number, 3 * (count - 1 - number))))


def _held(spaces: Spaces, adhering: Sequence[FloatArray], control: Control) -> FloatArray:
    """Rows (n, 3 bodies): what rigid motions of the bodies would change of what is held, and what adheres.

    A load whose displacement is prescribed holds that, which may be of several bodies.
    """
    points, unknowns, pattern = spaces.control_points(), control.constraints.unknowns, control.pattern()
    rows, means = list(adhering), []
    for name, place in spaces.places.items():
        motions = _motions(points[place])
        rows += [_of_body(spaces, name, row) for row in _constrained(unknowns[place], motions)]
        means.append(np.einsum("ai,aim->m", pattern[place], motions))
    rows += _tied(spaces, control.constraints.tied.followers, _motions(points))
    if control.constraints.global_unknowns:
        rows.append(np.concatenate(means)[None])
    return np.concatenate(rows)


def _tied(spaces: Spaces, followers: Followers, motions: FloatArray) -> list[FloatArray]:
    """Rows (n, 3 bodies): what rigid motions would change between functions and those that they follow."""
    sizes = [place.stop - place.start for place in spaces.places.values()]
    of_body = np.repeat(np.arange(len(sizes)), sizes)
    every = np.zeros((len(motions), 2, len(sizes), 3))
    every[np.arange(len(motions)), :, of_body] = motions
    starts = followers.starts
    found = []
    for k, function in enumerate(followers.functions):
        led = slice(starts[k], starts[k + 1])
        of_leaders = np.einsum("n,nibm->ibm", followers.shares[led], every[followers.leaders[led]])
        found.append((every[function] - of_leaders).reshape(2, -1))
    return found


def _check_interface(
    interface: Interface, side: SideTable, size: float, base: FloatArray | None
) -> tuple[list[FloatArray], FloatArray]:
    """What rigid motions of a body of some size would change (n, 3), and the substrate's tangents."""
    substrate, law = interface.substrate, interface.law
    if interface.irreversible:
        check_envelope(law)
    positions = side.positions
    if base is not None:
        positions = positions + np.einsum("eqm,emi->eqi", side.values, base[side.functions])
    gap, normal, curvature = evaluate_substrate(substrate.kernel, substrate.parameters, positions)
    if not np.isfinite(gap).all():
        raise InputError("substrate", type(substrate).__name__, "it must have a closest point to every point")
    deepest = np.unravel_index(np.argmin(gap), gap.shape)
    if base is None and gap[deepest] < -ROUND_OFF * size:
        place = "{:.4g} at X = ({:.4g}, {:.4g})".format(gap[deepest], *positions[deepest])
        raise InputError("substrate.gap", place, "the body must not overlap the substrate at the start")
    if (1 + curvature * gap <= 0).any():
        allowed = (
            "the body must be nearer to it than its centre of curvature, so that the closest point is unique"
        )
        raise InputError("substrate", f"curvature radius {np.abs(1 / curvature).min():.4g}", allowed)
    seen = curvature if substrate.constant_curvature else np.zeros_like(curvature)
    stiffness = evaluate_law(law.kernel, law.parameters, gap, seen)[2]
    acts = stiffness != 0
    tangent = np.stack([-normal[..., 1], normal[..., 0]], axis=-1)
    directions = [normal, tangent] if interface.sliding_length else [normal]
    rows = [np.einsum("ni,nim->nm", d[acts], _motions(positions[acts])) for d in directions]
    return rows, tangent if base is None else substrate_tangents(substrate, side.positions)


def _check_facing(spaces: Spaces, term: FacingTerm, size: float, base: FloatArray | None) -> FloatArray:
    """What rigid motions of both bodies would change (n, 3 bodies) between points and their partners."""
    interface, law = term.adhesion, term.adhesion.law
    if interface.irreversible:
        check_envelope(law)
    found = term.partners(np.zeros((spaces.size, 2)) if base is None else base)
    has = found.kind != NONE
    if base is None:
        _check_gaps(spaces, interface, size, np.where(has, found.gap, np.inf), found.position)
    stiffness = evaluate_law(law.kernel, law.parameters, found.gap, np.zeros_like(found.gap))[2]
    acts = has & (stiffness != 0)
    normal, position = found.normal.T[acts], found.position.T[acts]
    partner = position - found.gap[acts, None] * normal
    own, others = (np.einsum("ni,nim->nm", normal, _motions(points)) for points in (position, partner))
    return _of_body(spaces, interface.boundary.body, own) - _of_body(spaces, _other(interface).body, others)


def _check_gaps(
    spaces: Spaces, interface: Interface, size: float, gap: FloatArray, position: FloatArray
) -> None:
    """Check gaps (n,), infinite without a partner, of points (2, n) between two undeformed bodies."""
    nearest = int(np.argmin(gap))
    least = gap[nearest]
    if not least <= extent(spaces.problem):
        found = np.isfinite(least)
        far = f"the smallest gap between them is {least:.4g} L0" if found else "no point faces the other side"
        allowed = f"the sides are nowhere near each other at the start: {far}"
        raise InputError("between", _names(interface), allowed)
    if least < -ROUND_OFF * size:
        place = "a gap of {:.4g} L0 at X = ({:.4g}, {:.4g}) L0".format(least, *position[:, nearest])
        bodies = f"{interface.boundary.body} and {_other(interface).body}"
        allowed = (
            f"the bodies {bodies} must not overlap at the start, nor one lie behind the side of the other"
        )
        raise InputError("between", place, allowed)


def _other(interface: Interface) -> Boundary:
    assert isinstance(interface.against, Boundary)
    return interface.against


def _names(interface: Interface) -> str:
    """Return the names of both sides, in an order that both faces of an interface have in common."""
    return " and ".join(sorted(boundary_names([interface.boundary, _other(interface)]), reverse=True))


def _held_by_pairs(spaces: Spaces, term: PairTerm, size: float, base: FloatArray | None) -> list[FloatArray]:
    """What rigid motions of both bodies would change (n, 3 bodies) of the jumps that a joint resists."""
    u = np.zeros((spaces.size, 2)) if base is None else base
    position, distance, along = term.directions(u)
    normal = np.stack([-along[:, 1], along[:, 0]], axis=1)
    if base is None:
        gap = np.where(term.paired.ravel(), np.sum(distance * normal, axis=1), np.inf)
        _check_gaps(spaces, term.adhesion, size, gap, position.T)
    names = term.adhesion.boundary.body, _other(term.adhesion).body
    rows = []
    for direction, stiffness in zip((normal, along), term.stiffness(u), strict=True):
        acts = stiffness != 0
        own, others = (
            _of_body(spaces, name, np.einsum("ni,nim->nm", direction[acts], _motions(points[acts])))
            for name, points in zip(names, (position, position - distance), strict=True)
        )
        rows.append(own - others)
    return rows


def check_rigid(space: RowSpace, shape: NurbsSurface) -> None:
    """Raise InputError where a space cannot turn a shape rigidly: a rotation would strain the body."""
    lowest = min(row.degree for row in space.rows)
    for field, value, misfit, degree, needed in zip(
        ("space", "across_degree"),
        (space.name, space.across.degree),
        space.misfit(shape),
        (lowest, space.across.degree),
        (space_.degree for space_ in shape.spaces),
        strict=True,
    ):
        if misfit <= RIGID:
            continue
        means = "the shape's lines of reduced continuity: `row_space` adds them, if it gets the `shape`"
        if degree < needed:
            means = f"degree {needed}" + (f" in all rows, such as 'N{needed}'" if field == "space" else "")
        allowed = f"a rotation would strain the body, as its shape is not in the space; take {means}"
        raise InputError(field, value, allowed)


def _motions(points: FloatArray) -> FloatArray:
    """Displacements (n, 2, 3) of points (n, 2) by the rigid motions: along x, along y, a turn."""
    ones, zeros = np.ones(len(points)), np.zeros(len(points))
    along_x = np.stack([ones, zeros, -points[:, 1]], axis=1)
    along_y = np.stack([zeros, ones, points[:, 0]], axis=1)
    return np.stack([along_x, along_y], axis=1)


def _constrained(unknowns: IntArray, motions: FloatArray) -> list[FloatArray]:
    """Rows (n, 3): what rigid motions (size, 2, 3) of the control points would change of what is held."""
    flat, numbers = motions.reshape(-1, 3), unknowns.ravel()
    order = np.argsort(numbers, kind="stable")
    shared = np.flatnonzero(np.diff(numbers[order]) == 0)
    return [flat[numbers == HELD], flat[order[shared + 1]] - flat[order[shared]]]


def _free_motion(rows: FloatArray, extents: Mapping[str, float]) -> str | None:
    """Name a rigid motion that no row (n, 3 bodies) notices, where there is one; bodies have their sizes.

    Of several bodies the one is named that moves most.
    """
    scales = np.concatenate([[1.0, 1.0, extent] for extent in extents.values()])
    _, sizes, motions = np.linalg.svd(
        np.vstack([rows, np.zeros((scales.size, scales.size))]) / scales, full_matrices=False
    )
    if sizes[-1] > ROUND_OFF * max(sizes[0], 1.0):
        return None
    body, motion = divmod(int(np.argmax(np.abs(motions[-1]))), 3)
    words = ("a motion along x", "a motion along y", "a rotation")[motion]
    return words if len(extents) == 1 else f"{words} of the body {list(extents)[body]}"
