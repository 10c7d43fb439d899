"""Constraints: which degrees of freedom are held, which follow the drive, and the order of the unknowns."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Self

import numpy as np

from isopeel.assembly.spaces import Spaces
from isopeel.common.arrays import BoolArray, FloatArray, IntArray
from isopeel.common.compilation import compiled
from isopeel.common.errors import InputError
from isopeel.problem import Boundary, Constraint, Load

HELD = -1


@dataclass(frozen=True, eq=False)
class Motion:
    """How a constraint moves one boundary, at its factor times the parameter."""

    constraint: Constraint
    boundary: Boundary
    functions: IntArray  # (m,)
    points: FloatArray  # (m, 2) their control points in the base state
    factor: float
    own: BoolArray  # (m,) those that no earlier boundary moves

    @property
    def own_functions(self) -> IntArray:
        """The functions (n,) that are its own."""
        return self.functions[self.own]

    def moved(self, parameter: float) -> FloatArray:
        """What its own coefficients (n, 2) are moved by."""
        return self.constraint.prescribed(self.points, self.factor * parameter)[self.own]

    def rate(self, parameter: float) -> FloatArray:
        """What they change by its own motion: not by the parameter, but by the factor times that."""
        return self.constraint.rate(self.points, self.factor * parameter)[self.own]

    def agrees_with(self, other: Self) -> bool:
        """Return whether two boundaries with points in common move these alike, and leave none tied."""
        _, mine, theirs = np.intersect1d(self.functions, other.functions, return_indices=True)
        one, another = (m.constraint.prescribed(m.points, m.factor) for m in (self, other))
        is_tied = "tied" in self.constraint.freedoms
        return not len(mine) or (
            not is_tied and self.factor == other.factor and np.array_equal(one[mine], another[theirs])
        )

    def reaction(self, forces: FloatArray, parameter: float) -> float:
        """Generalised force that works on this motion, of forces (size, 2)."""
        return _work(forces, self.own_functions, np.ascontiguousarray(self.rate(parameter)))


@dataclass(frozen=True, eq=False)
class Constraints:
    """The map u = T z + u0 + g(parameter) from unknowns z to the coefficients u of the displacement.

    Each coefficient follows one unknown or none (T has one 1 in a row, or none), so that a condensation
    with T is exact and costs nothing: `unknowns` (size, 2) is the number of the unknown, or HELD. The tied
    degrees of freedom of a boundary share one unknown per component. Held, prescribed and tied components
    begin with their displacement in the `base` state, which is u0, the `offset`.

    All unknowns y are those of the displacement, z, and after them the global ones: the size of a load whose
    displacement is prescribed.
    """

    unknowns: IntArray
    count: int  # of z
    global_unknowns: int
    offset: FloatArray  # (size, 2)
    motions: tuple[Motion, ...]  # of boundaries that the drive moves
    driven: IntArray  # their functions
    # what the drive prescribes at the last parameter, and its rate: a step needs them several times
    _moved: dict[float, FloatArray] = field(default_factory=dict, init=False, repr=False)
    _rate: dict[float, FloatArray] = field(default_factory=dict, init=False, repr=False)

    @property
    def total(self) -> int:
        """Number of all unknowns y."""
        return self.count + self.global_unknowns

    def displacement(self, unknown_values: FloatArray, parameter: float) -> FloatArray:
        """Coefficients u (size, 2) of unknowns y (total,) at a value of the drive's parameter."""
        u = np.empty(self.offset.shape)
        displace(self.unknowns, unknown_values, self.offset, self.driven, self.moved(parameter), u)
        return u

    def moved(self, parameter: float) -> FloatArray:
        """What the driven coefficients (n, 2) are moved by at a value of the drive's parameter."""
        if parameter not in self._moved:
            self._moved.clear()
            moved = [motion.moved(parameter) for motion in self.motions]
            self._moved[parameter] = np.concatenate([np.empty((0, 2)), *moved])
        return self._moved[parameter]

    def rate(self, parameter: float) -> FloatArray:
        """What the driven coefficients (n, 2) change by the parameter."""
        if parameter not in self._rate:
            self._rate.clear()
            rates = [motion.factor * motion.rate(parameter) for motion in self.motions]
            self._rate[parameter] = np.concatenate([np.empty((0, 2)), *rates])
        return self._rate[parameter]

    def unknown_values(self, displacement: FloatArray, parameter: float) -> FloatArray:
        """The unknowns y (total,) of coefficients u (size, 2) that satisfy the constraints.

        Global unknowns are left at zero: a dead load enters the equations linearly, so that Newton's method
        finds it at once.
        """
        free = displacement - self.offset
        free[self.driven] -= self.moved(parameter)
        y = np.zeros(self.total + 1)
        y[self.unknowns] = free
        return y[:-1]

    def condense(self, forces: FloatArray) -> FloatArray:
        """T^T f (count,) of forces f (size, 2) that work on the coefficients."""
        totals = np.zeros(self.count)
        condense(self.unknowns, forces, totals)
        return totals

    def reaction(self, forces: FloatArray, parameter: float) -> float:
        """Generalised force that works on the parameter of a drive that moves boundaries."""
        return _work(forces, self.driven, self.rate(parameter))


@compiled
def displace(
    unknowns: IntArray,
    values: FloatArray,
    offset: FloatArray,
    driven: IntArray,
    moved: FloatArray,
    u: FloatArray,
) -> None:
    """Set u = T z + u0 + g (size, 2), of the values z (count,) and what the driven functions are moved by."""
    for f in range(len(unknowns)):
        for i in range(2):
            u[f, i] = offset[f, i] + (values[unknowns[f, i]] if unknowns[f, i] >= 0 else 0.0)
    for k in range(len(driven)):
        for i in range(2):
            u[driven[k], i] += moved[k, i]


@compiled
def condense(unknowns: IntArray, forces: FloatArray, totals: FloatArray) -> None:
    """Add T^T f of forces (size, 2) to totals (count,)."""
    for f in range(len(unknowns)):
        for i in range(2):
            if unknowns[f, i] >= 0:
                totals[unknowns[f, i]] += forces[f, i]


@compiled
def _work(forces: FloatArray, driven: IntArray, rate: FloatArray) -> float:
    """Of forces (size, 2) that move the driven functions at a rate (n, 2)."""
    total = 0.0
    for k in range(len(driven)):
        for i in range(2):
            total += forces[driven[k], i] * rate[k, i]
    return total


def constrain(
    spaces: Spaces,
    elements: Mapping[str, Sequence[IntArray]],
    base: FloatArray | None = None,
    links: Sequence[IntArray] = (),
) -> Constraints:
    """Collect a problem's constraints, and number the unknowns for a narrow band.

    Bodies are numbered one after another, or all together if there are links between them.

    `elements` are arrays (E, m), by names of bodies, of the functions of each element, which are coupled with
    each other, `links` the same of elements of two bodies. `base` (size, 2) are the coefficients of the state
    that the drive begins with, by default those of the bodies as they are.

    Raises InputError where a held component belongs to a boundary that the drive moves along it, where such
    boundaries meet and do not move alike, or where nothing of the bodies is left to move.
    """
    problem = spaces.problem
    u0 = np.zeros((spaces.size, 2)) if base is None else base
    # groups[function, component]: what shares one unknown has one group
    groups = np.arange(2 * spaces.size).reshape(spaces.size, 2)
    offset = np.zeros((spaces.size, 2))
    motions = _motions(spaces, spaces.control_points() + u0)
    for motion in motions:
        driven = motion.functions
        for component, freedom in enumerate(motion.constraint.freedoms):
            if freedom != "free":
                groups[driven, component] = groups[driven[0], component] if freedom == "tied" else HELD
                offset[driven, component] = u0[driven, component]
    for support in problem.supports:
        held = spaces.boundary(support.boundary)
        for component in support.components:
            for motion in motions:
                moves = motion.constraint.freedoms[component] in ("tied", "prescribed")
                if moves and np.isin(held, motion.functions).any():
                    moved = problem.side_name(motion.boundary)
                    allowed = f"the drive moves the side {moved}, which shares points with it"
                    raise InputError("held", problem.side_name(support.boundary), allowed)
            groups[held, component] = HELD
            offset[held, component] = u0[held, component]
    if (groups == HELD).all():
        allowed = "on this mesh the whole body is held or moved by the drive; take a finer mesh, or hold less"
        sides = [problem.side_name(support.boundary) for support in problem.supports]
        raise InputError("held", sides, allowed)
    unknowns = np.empty(groups.shape, dtype=np.int64)
    count = 0
    parts = [
        (place, spaces.of[name].greville, elements.get(name, ())) for name, place in spaces.places.items()
    ]
    if links:
        every = [functions for found in elements.values() for functions in found]
        parts = [(slice(0, spaces.size), spaces.control_points() + u0, [*every, *links])]
    for place, positions, coupled in parts:
        of_part = np.where(groups[place] == HELD, HELD, groups[place] - 2 * place.start)
        own = [functions - place.start for functions in coupled]
        numberings = [_number(of_part, positions, axis) for axis in (0, 1)]
        if links:
            numberings.append(_number_by_neighbours(of_part, own))
        numbers = min(numberings, key=lambda numbering: half_bandwidth(numbering, own))
        unknowns[place] = np.where(numbers == HELD, HELD, numbers + count)
        count += int(numbers.max()) + 1
    of_load = isinstance(problem.drive, Load) and problem.drive.control == "displacement"
    driven = np.concatenate([np.empty(0, np.int64), *(motion.own_functions for motion in motions)])
    return Constraints(unknowns, count, int(of_load), offset, motions, driven)


def _motions(spaces: Spaces, points: FloatArray) -> tuple[Motion, ...]:
    """Return the motions of the boundaries that the drive moves, of control points (size, 2)."""
    problem = spaces.problem
    drive = problem.drive
    if not isinstance(drive, Constraint):
        return ()
    taken = np.empty(0, np.int64)
    motions: list[Motion] = []
    for name, (boundary, factor) in zip(problem.driven_names, problem.driven, strict=True):
        functions = spaces.boundary(boundary)
        own = ~np.isin(functions, taken)
        motion = Motion(drive, boundary, functions, points[functions], factor, own)
        if not all(motion.agrees_with(other) for other in motions) or not own.any():
            allowed = (
                "the drive moves another boundary that shares points with it, by another motion;"
                " leave an element between"
            )
            raise InputError("drive.on", name, allowed)
        taken = np.concatenate([taken, functions])
        motions.append(motion)
    return tuple(motions)


def _number(groups: IntArray, places: FloatArray, axis: int) -> IntArray:
    """Number the groups by the place of their functions, along one axis first, then along the other."""
    place = np.repeat(places, 2, axis=0)
    component = np.tile([0, 1], len(places))
    flat = groups.ravel()
    order = np.lexsort((component, place[:, 1 - axis], place[:, axis]))
    order = order[flat[order] != HELD]
    # a group is numbered where its last member stands, next to the functions it is coupled with
    last_first = order[::-1]
    _, first = np.unique(flat[last_first], return_index=True)
    members = np.sort(len(order) - 1 - first)
    numbers = np.full(flat.size, HELD)
    numbers[flat[order[members]]] = np.arange(len(members))
    numbered: IntArray = np.where(flat == HELD, HELD, numbers[flat]).reshape(groups.shape)
    return numbered


def _number_by_neighbours(groups: IntArray, elements: Sequence[IntArray]) -> IntArray:
    """Number the groups (size, 2) by the reverse algorithm of Cuthill and McKee."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import reverse_cuthill_mckee

    known, compact = np.unique(groups, return_inverse=True)
    compact = compact.reshape(groups.shape) - int(known[0] == HELD)
    count = int(compact.max()) + 1
    pairs = []
    for functions in elements:
        members = compact[functions].reshape(len(functions), -1)
        size = members.shape[1]
        rows, columns = np.repeat(members, size, axis=1), np.tile(members, size)
        free = (rows != HELD) & (columns != HELD)
        pairs.append(np.stack([rows[free], columns[free]]))
    places = np.concatenate(pairs, axis=1)
    graph = coo_array((np.ones(places.shape[1]), tuple(places)), (count, count)).tocsr()
    order = reverse_cuthill_mckee(graph, symmetric_mode=True)
    numbers = np.append(np.empty(count, dtype=np.int64), HELD)
    numbers[order] = np.arange(count)
    numbered: IntArray = numbers[compact]
    return numbered


def half_bandwidth(unknowns: IntArray, elements: Sequence[IntArray]) -> int:
    """Largest distance of two unknowns of one element, for arrays (E, m) of the elements' functions."""
    widest = 0
    for functions in elements:
        numbers = unknowns[functions].reshape(len(functions), -1)
        highest = numbers.max(axis=1)
        lowest = np.where(numbers == HELD, highest[:, None], numbers).min(axis=1)
        widest = max(widest, int((highest - lowest).max()))
    return widest
