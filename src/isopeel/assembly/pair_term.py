"""A side that is joined to a side of another body at fixed pairs of points, as a term of the system."""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from isopeel.assembly.closest_point_kernel import NONE, closest_places, segments_at
from isopeel.assembly.facing_curve import facing_curve
from isopeel.assembly.interface_kernel import Response
from isopeel.assembly.loops import Loops
from isopeel.assembly.packing import Packed, packed
from isopeel.assembly.pair_kernel import (
    JointResponse,
    Jumps,
    PairData,
    add_pairs,
    find_jumps,
    read_pairs,
    respond_to_jumps,
)
from isopeel.assembly.spaces import Spaces
from isopeel.assembly.tables import SideTable, table_at
from isopeel.common.arrays import BoolArray, FloatArray, IntArray, frozen
from isopeel.physics.joints import JointLaw
from isopeel.problem import Boundary, Interface

if TYPE_CHECKING:
    from scipy.sparse import csr_array

#: Slopes below this share of the largest one are round-off.
_ROUND_OFF = 1e-12


@dataclass(frozen=True, eq=False)
class PairTerm:
    """A joint law between the points of a table and the closest points of the undeformed other side.

    The history are the variables of the law, each at the points (E Q,), one variable after another.
    """

    adhesion: Interface
    law: JointLaw
    table: SideTable
    paired: BoolArray  # (E, Q) whether a point has a partner
    other_functions: IntArray  # (E, Q, n) that do not vanish at the partner
    values: FloatArray  # (E, Q, m + n), this and the following as in `PairData`
    slopes: FloatArray
    distances: FloatArray
    tangents: FloatArray
    size: int  # number of functions of all bodies

    @property
    def loops(self) -> Loops:
        """See `isopeel.assembly.terms`."""
        return add_pairs

    @property
    def has_potential(self) -> bool:
        """See `isopeel.assembly.terms`: at the history of the last accepted step there is one."""
        return True

    def couplings(self) -> tuple[IntArray, ...]:
        """See `isopeel.assembly.terms`."""
        own = np.broadcast_to(
            self.table.functions[:, None], (*self.paired.shape, self.table.functions.shape[1])
        )
        pairs = np.concatenate([own, self.other_functions], axis=2)[self.paired]
        return (np.unique(pairs, axis=0),) if len(pairs) else ()

    def data(self, unknowns: IntArray) -> Packed:
        """See `isopeel.assembly.terms`."""
        table, law = self.table, self.law
        t = self.tangents / np.linalg.norm(self.tangents, axis=-1, keepdims=True)
        normal = np.stack([-t[..., 1], t[..., 0]], axis=-1)
        initial = np.stack([np.sum(self.distances * one, axis=-1) for one in (normal, t)], axis=-1)
        return packed(
            PairData(
                law=law.joint_kernel.address,
                parameters=law.joint_parameters,
                variables=len(law.history),
                functions=table.functions,
                other_functions=self.other_functions,
                values=self.values,
                slopes=self.slopes,
                weights=np.where(self.paired, table.weights, 0.0),
                distances=self.distances,
                tangents=self.tangents,
                initial=initial,
                unknowns=unknowns[table.functions],
                other_unknowns=unknowns[self.other_functions],
            )
        )

    def initial(self) -> FloatArray:
        """See `isopeel.assembly.terms`."""
        return frozen(np.repeat(np.array(self.law.initial_history()), self.paired.size))

    def commit(self, displacement: FloatArray, history: FloatArray) -> FloatArray:
        """See `isopeel.assembly.terms`."""
        if not self.law.history:
            return history
        later = self._at(displacement, history)[1].history
        return frozen(np.where(self.paired.ravel(), later, history.reshape(later.shape)).ravel())

    def jump_rates(self, unknowns: IntArray, count: int) -> "csr_array":
        """Return the matrix (2 E Q, count) from unknowns to the distances r of the pairs that are joined.

        Each row has the root of the reference length of its point as a factor. `unknowns` (size, 2) are the
        numbers of the unknowns of the functions, -1 where there is none.
        """
        from scipy.sparse import csr_array

        # the faces of a crack repel each other, but do not resist sliding
        holds = self.stiffness(np.zeros((self.size, 2)))[1].reshape(self.paired.shape) > 0
        own = np.broadcast_to(
            self.table.functions[:, None], (*self.paired.shape, self.table.functions.shape[1])
        )
        columns = np.moveaxis(unknowns[np.concatenate([own, self.other_functions], axis=2)], 3, 0)
        factors = np.sqrt(np.where(holds, self.table.weights, 0.0))
        values = np.broadcast_to(self.values * factors[..., None], columns.shape)
        rows = np.broadcast_to(np.arange(2 * self.paired.size).reshape(*columns.shape[:3], 1), columns.shape)
        free = columns >= 0
        shape = 2 * self.paired.size, count
        return csr_array((values[free], (rows[free], columns[free])), shape=shape)

    def opening(self, displacement: FloatArray | None) -> FloatArray:
        """Return the openings d_n (E Q,) at coefficients (size, 2) or zero."""
        u = np.zeros((self.size, 2)) if displacement is None else displacement
        jumps: Jumps = find_jumps(self._pairs, _read_only(u))
        opening: FloatArray = jumps.jump[0]
        return opening

    def gap(self, displacement: FloatArray) -> FloatArray:
        """Return the distances (E Q,) along the normal, at coefficients (size, 2); inf without a partner."""
        jumps: Jumps = find_jumps(self._pairs, _read_only(displacement))
        return np.where(self.paired.ravel(), jumps.distance[0], np.inf)

    def respond(self, displacement: FloatArray, history: FloatArray) -> Response:
        """Return the state of all points, at coefficients (size, 2) after a history.

        The normal is that of the mean direction of both faces, outward of the other body. Points without a
        partner have no energy and no traction.
        """
        jumps, found = self._at(displacement, history)
        side, acts = self.table, self.paired.ravel()
        moved = np.einsum("eqm,emi->eqi", side.values, displacement[side.functions])
        position = (side.positions + moved).reshape(-1, 2).T
        energies, slopes, stiffness = (
            np.where(acts, one, 0.0) for one in (found.energies, found.slopes, found.stiffness)
        )
        return Response(
            position=np.ascontiguousarray(position),
            gap=jumps.distance[0],
            normal=np.stack([-jumps.along[1], jumps.along[0]]),
            curvature=np.zeros(acts.size),
            potential=energies[0],
            traction=-slopes[0],
            derivative=-stiffness[0],
            dissipated=energies[1],
            shear=np.stack([slopes[1], stiffness[2], stiffness[1]]),
        )

    def softens(self, displacement: FloatArray, history: FloatArray) -> BoolArray:
        """Return whether the points (E Q,) have passed their strength, see `JointLaw.softens`."""
        found = self._at(displacement, history)[1]
        softer: BoolArray = self.paired.ravel() & self.law.softens(found.stiffness, found.history)
        return softer

    def stiffness(self, displacement: FloatArray) -> FloatArray:
        """Return E_nn and E_tt (2, E Q) at coefficients (size, 2) before any damage by steps."""
        stiffness = self._at(displacement, self.initial())[1].stiffness[[0, 2]]
        return np.where(self.paired.ravel(), stiffness, 0.0)

    def directions(self, displacement: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the positions of the points, their distances r from the partners, and t, all (E Q, 2)."""
        jumps: Jumps = find_jumps(self._pairs, _read_only(displacement))
        side, t = self.table, jumps.along.T
        moved = np.einsum("eqm,emi->eqi", side.values, displacement[side.functions])
        normal = np.stack([-t[:, 1], t[:, 0]], axis=1)
        distance = jumps.distance[0][:, None] * normal + jumps.distance[1][:, None] * t
        return (side.positions + moved).reshape(-1, 2), distance, t

    def _at(self, displacement: FloatArray, history: FloatArray) -> tuple[Jumps, JointResponse]:
        jumps: Jumps = find_jumps(self._pairs, _read_only(displacement))
        return jumps, respond_to_jumps(self._pairs, jumps.jump, _read_only(history.ravel()))

    @cached_property
    def _pairs(self) -> PairData:
        # with the types of the assembly
        pairs: PairData = read_pairs.py_func(*self.data(np.zeros((self.size, 2), dtype=np.int64)))
        return pairs


def _read_only(values: FloatArray) -> FloatArray:
    """Return an array with the type that the assembly passes to compiled code."""
    view = np.ascontiguousarray(values).view()
    view.setflags(write=False)
    return view


def pair_term(spaces: Spaces, interface: Interface, side: SideTable) -> PairTerm:
    """Return the term of a joint, at the points of a table with gradients.

    The undeformed points are paired with the closest points of the whole other side. A point has no partner
    where its projection leaves the end of that side, or where both outward normals have a common direction.
    """
    problem, against, law = spaces.problem, interface.against, interface.law
    assert isinstance(against, Boundary)
    assert isinstance(law, JointLaw)
    shape = problem.body_of(against.body).shape
    curve = facing_curve(spaces, against)
    at_rest = segments_at(
        curve.functions, curve.values, curve.weights, curve.shape, np.zeros((spaces.size, 2))
    )
    points = side.weights.shape
    kinds, segments, places = closest_places(at_rest, side.positions.reshape(-1, 2))
    parameters = curve.ends[segments] + places * np.diff(curve.ends)[segments]
    other = table_at(
        shape, spaces.of[against.body], against.side, parameters[:, None], np.zeros((parameters.size, 1))
    )
    own_tangents, own_slopes = _tangents(side)
    tangents, slopes = _tangents(other)
    # both boundaries run anticlockwise, so that faces which face each other run against each other
    tangents, slopes = -tangents.reshape(*points, 2), -slopes[:, 0]
    opposed = np.sum(own_tangents * tangents, axis=-1) > 0
    paired = (kinds.reshape(points) != NONE) & opposed
    # where faces do not face each other, the sum of both tangents may vanish
    tangents = np.where(paired[..., None], tangents, own_tangents)
    own = _used(side.values, own_slopes)
    theirs = _used(other.values[:, 0], slopes)
    values = other.values[:, 0][:, theirs].reshape(*points, -1)
    return PairTerm(
        adhesion=interface,
        law=law,
        table=SideTable(
            functions=np.ascontiguousarray(side.functions[:, own]),
            values=np.ascontiguousarray(side.values[..., own]),
            gradients=np.ascontiguousarray(side.gradients[..., own]),
            weights=side.weights,
            positions=side.positions,
            normals=side.normals,
        ),
        paired=paired,
        other_functions=(spaces.places[against.body].start + other.functions[:, theirs]).reshape(*points, -1),
        values=np.concatenate([side.values[..., own], -values], axis=2),
        slopes=np.concatenate([own_slopes[..., own], slopes[:, theirs].reshape(*points, -1)], axis=2),
        distances=side.positions - other.positions.reshape(*points, 2),
        tangents=own_tangents + tangents,
        size=spaces.size,
    )


def _tangents(table: SideTable) -> tuple[FloatArray, FloatArray]:
    """Return unit tangents (E, Q, 2) anticlockwise, and the slopes (E, Q, m) of the functions along them."""
    tangents = np.stack([-table.normals[..., 1], table.normals[..., 0]], axis=-1)
    return tangents, np.einsum("eqJm,eqJ->eqm", table.gradients, tangents)


def _used(values: FloatArray, slopes: FloatArray) -> IntArray:
    """Return which of the functions (..., m) of elements do not vanish on the side."""
    acts = (values != 0) | (np.abs(slopes) > _ROUND_OFF * np.abs(slopes).max())
    (used,) = np.nonzero(acts.any(axis=tuple(range(values.ndim - 1))))
    return used
