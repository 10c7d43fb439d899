"""Constraints: which degrees of freedom are held, follow the drive or others, and the order of unknowns."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Self

import numpy as np

from isopeel.assembly.numbering import half_bandwidth, number_by_neighbours, number_by_place
from isopeel.assembly.sizes import ROUND_OFF, extent
from isopeel.assembly.spaces import HELD, Spaces
from isopeel.assembly.tie_kernel import Followers, follow, lead
from isopeel.assembly.ties import TiedFunctions, tied_functions
from isopeel.common.arrays import BoolArray, FloatArray, IntArray
from isopeel.common.compilation import compiled
from isopeel.common.errors import InputError
from isopeel.problem import Boundary, Constraint, Load


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
    """The map u = C (T z + u0 + g(parameter)) from unknowns z to the coefficients u of the displacement.

    Each coefficient has one unknown or none (T has one 1 in a row, or none), so that a condensation
    with T is exact and costs nothing: `unknowns` (size, 2) is the number of the unknown, or HELD. The tied
    degrees of freedom of a boundary share one unknown per component. Held, prescribed and tied components
    begin with their displacement in the `base` state, which is u0, the `offset`.

    C sets the coefficients of functions that follow others (`isopeel.assembly.ties`); it is one without
    ties. A function that follows one other has the unknown of that. One that follows several has an unknown
    of its own, which is always zero, so that a tangent has the same rows before and after it is condensed.

    All unknowns y are those of the displacement, z, and after them the global ones: the size of a load whose
    displacement is prescribed.
    """

    unknowns: IntArray
    count: int  # of z
    global_unknowns: int
    offset: FloatArray  # (size, 2)
    motions: tuple[Motion, ...]  # of boundaries that the drive moves
    driven: IntArray  # their functions
    tied: TiedFunctions
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
        displace(
            self.unknowns,
            unknown_values,
            self.offset,
            self.driven,
            self.moved(parameter),
            self.tied.followers,
            u,
        )
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
        leading = self.tied.leading
        y[self.unknowns[leading]] = free[leading]
        return y[:-1]

    def condense(self, forces: FloatArray) -> FloatArray:
        """T^T C^T f (count,) of forces f (size, 2) that work on the coefficients."""
        totals = np.zeros(self.count)
        if len(self.tied.followers.functions):
            forces = forces.copy()
            lead(self.tied.followers, forces)
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
    followers: Followers,
    u: FloatArray,
) -> None:
    """Set u = C (T z + u0 + g), (size, 2), of the values z (count,) and what the drive moves by."""
    for f in range(len(unknowns)):
        for i in range(2):
            u[f, i] = offset[f, i] + (values[unknowns[f, i]] if unknowns[f, i] >= 0 else 0.0)
    for k in range(len(driven)):
        for i in range(2):
            u[driven[k], i] += moved[k, i]
    follow(followers, u)


@compiled
def condense(unknowns: IntArray, forces: FloatArray, totals: FloatArray) -> None:
    """Add T^T f of forces (size, 2), which act on leading functions only, to totals (count,)."""
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

    Bodies are numbered one after another, or all together if there are links or ties between them.

    `elements` are arrays (E, m), by names of bodies, of the functions of each element, which are coupled with
    each other, `links` the same of elements of two bodies. `base` (size, 2) are the coefficients of the state
    that the drive begins with, by default those of the bodies as they are.

    Raises InputError where a held component belongs to a boundary that the drive moves along it, where such
    boundaries meet and do not move alike, where nothing of the bodies is left to move, where a side does not
    lie on the one that it follows, or where what is held or moved follows several functions.
    """
    problem, tied = spaces.problem, tied_functions(spaces)
    u0 = np.zeros((spaces.size, 2)) if base is None else base
    # groups[function, component]: what shares one unknown has one group
    groups = np.arange(2 * spaces.size).reshape(spaces.size, 2)
    offset = np.zeros((spaces.size, 2))
    motions = _motions(spaces, spaces.control_points() + u0, tied)
    for motion in motions:
        driven = motion.functions
        for component, freedom in enumerate(motion.constraint.freedoms):
            if freedom != "free":
                groups[driven, component] = groups[driven[0], component] if freedom == "tied" else HELD
                offset[driven, component] = u0[driven, component]
    for support in problem.supports:
        held = _leading(spaces, support.boundary, tied, "held")
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
    groups = groups[tied.copies]
    unknowns = np.empty(groups.shape, dtype=np.int64)
    count, together = 0, bool(links) or bool(problem.ties)
    parts = [
        (place, spaces.of[name].greville, elements.get(name, ())) for name, place in spaces.places.items()
    ]
    if together:
        every = [functions for found in elements.values() for functions in found]
        # points of two bodies at one place differ by round-off, which must not order them
        positions = np.round((spaces.control_points() + u0) / (ROUND_OFF * extent(problem)))
        parts = [(slice(0, spaces.size), positions, tied.coupled([*every, *links]))]
    for place, positions, coupled in parts:
        of_part = np.where(groups[place] == HELD, HELD, groups[place] - 2 * place.start)
        own = [functions - place.start for functions in coupled]
        numberings = [number_by_place(of_part, positions, axis) for axis in (0, 1)]
        if together and own:
            numberings.append(number_by_neighbours(of_part, own))
        numbers = min(numberings, key=lambda numbering: half_bandwidth(numbering, own))
        unknowns[place] = np.where(numbers == HELD, HELD, numbers + count)
        count += int(numbers.max()) + 1
    of_load = isinstance(problem.drive, Load) and problem.drive.control == "displacement"
    driven = np.concatenate([np.empty(0, np.int64), *(motion.own_functions for motion in motions)])
    return Constraints(unknowns, count, int(of_load), offset, motions, driven, tied)


def _leading(spaces: Spaces, boundary: Boundary, tied: TiedFunctions, field: str) -> IntArray:
    """Return the functions (m,) of a boundary, or those whose coefficients they have.

    Raises InputError for the field where one of them follows several others.
    """
    functions = tied.copies[spaces.boundary(boundary)]
    if np.isin(functions, tied.of_several).any():
        allowed = "points of it are tied to another side, with another mesh; hold or move that body there"
        raise InputError(field, f"{boundary.body}.{boundary.side}", allowed)
    return functions


def _motions(spaces: Spaces, points: FloatArray, tied: TiedFunctions) -> tuple[Motion, ...]:
    """Return the motions of the boundaries that the drive moves, of control points (size, 2)."""
    problem = spaces.problem
    drive = problem.drive
    if not isinstance(drive, Constraint):
        return ()
    taken = np.empty(0, np.int64)
    motions: list[Motion] = []
    for name, (boundary, factor) in zip(problem.driven_names, problem.driven, strict=True):
        functions = _leading(spaces, boundary, tied, "drive.on")
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
