"""A side that faces a side of another body, as a term of the system."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from isopeel.assembly.closest_point_kernel import NONE
from isopeel.assembly.facing_curve import FacingCurve, facing_curve
from isopeel.assembly.facing_kernel import (
    FacingData,
    Partners,
    add_facing,
    find_partners,
    read_facing,
    respond_to,
)
from isopeel.assembly.interface_kernel import Response
from isopeel.assembly.loops import Loops
from isopeel.assembly.opening import closed_opening, initial_openings, opened
from isopeel.assembly.packing import Packed, packed
from isopeel.assembly.sizes import extent
from isopeel.assembly.smoothed_curve import is_lagrange, smoothed_curve
from isopeel.assembly.spaces import Spaces
from isopeel.assembly.tables import SideTable
from isopeel.common.arrays import BoolArray, FloatArray, IntArray
from isopeel.common.errors import InputError
from isopeel.physics.batch import evaluate_law
from isopeel.problem import Boundary, Interface

#: A gap at which nothing acts, in sizes of the largest body.
_FAR = 1e3
#: Couplings that are softer than this share of the closed joint need no place in a tangent. Where two arms of
#: a peel are far apart, a point and its partner may be far apart along the bodies, too: the band would be
#: wider than the bodies need, for entries that change the convergence of Newton's method by this rate only.
_NEGLIGIBLE = 1e-4


@dataclass(frozen=True, eq=False)
class FacingTerm:
    """The interaction of a side with the closest points of a curve, at the points of a table.

    The history is as that of an `InterfaceTerm`.
    """

    adhesion: Interface
    table: SideTable
    curve: FacingCurve
    size: int  # number of functions of all bodies
    far: float  # a gap at which nothing acts
    closed: float  # an opening up to this one counts as closed: the round-off of positions

    @property
    def loops(self) -> Loops:
        """See `isopeel.assembly.terms`."""
        return add_facing

    @property
    def has_potential(self) -> bool:
        """See `isopeel.assembly.terms`."""
        return self.adhesion.has_potential

    def couplings(self) -> tuple[IntArray, ...]:
        """See `isopeel.assembly.terms`; of the points and their partners where the bodies are made."""
        found = self.partners(np.zeros((self.size, 2)))
        return self._pairs(found, found.kind != NONE)

    def couplings_at(self, displacement: FloatArray) -> tuple[IntArray, ...]:
        """Return the couplings at coefficients (size, 2) that are not negligible in a tangent."""
        law, found = self.adhesion.law, self.partners(displacement)
        gaps = np.append(found.gap, law.equilibrium_gap)
        stiffness = np.abs(evaluate_law(law.kernel, law.parameters, gaps, np.zeros(gaps.size))[2])
        return self._pairs(found, (found.kind != NONE) & (stiffness[:-1] > _NEGLIGIBLE * stiffness[-1]))

    def _pairs(self, found: Partners, chosen: BoolArray) -> tuple[IntArray, ...]:
        points = np.repeat(self.table.functions, self.table.weights.shape[1], axis=0)
        pairs = np.concatenate([points[chosen], self.curve.functions[found.segment[chosen]]], axis=1)
        return (np.unique(pairs, axis=0),) if chosen.any() else ()

    def data(self, unknowns: IntArray) -> Packed:
        """See `isopeel.assembly.terms`."""
        adhesion, table, curve = self.adhesion, self.table, self.curve
        tangents = np.stack([-table.normals[..., 1], table.normals[..., 0]], axis=-1)
        return packed(
            FacingData(
                law=adhesion.law.kernel.address,
                parameters=adhesion.law.parameters,
                equilibrium_gap=float(adhesion.law.equilibrium_gap),
                irreversible=adhesion.irreversible,
                augmented=adhesion.penetration is not None,
                share=1.0 if adhesion.scheme == "biased" else 0.5,
                mutual=adhesion.scheme != "two-half-pass",
                far=self.far,
                functions=table.functions,
                values=table.values,
                weights=table.weights,
                positions=table.positions,
                normals=table.normals,
                slopes=np.einsum("eqJm,eqJ->eqm", table.gradients, tangents),
                unknowns=unknowns[table.functions],
                segment_functions=curve.functions,
                segment_values=curve.values,
                segment_weights=curve.weights,
                shape=curve.shape,
                orientation=curve.orientation,
                segment_unknowns=unknowns[curve.functions],
            )
        )

    def initial(self) -> FloatArray:
        """See `isopeel.assembly.terms`."""
        return initial_openings(self.adhesion, self.opening(None), self.closed)

    def commit(self, displacement: FloatArray, history: FloatArray) -> FloatArray:
        """See `isopeel.assembly.terms`."""
        if not self.adhesion.irreversible:
            return history
        return opened(self.opening(displacement), history, self.closed)

    def partners(self, displacement: FloatArray) -> Partners:
        """Return the partners of all points, at coefficients (size, 2)."""
        u = np.ascontiguousarray(displacement).view()
        u.setflags(write=False)
        found: Partners = find_partners(self._facing, u)
        return found

    @cached_property
    def _facing(self) -> FacingData:
        # with the types of the assembly
        facing: FacingData = read_facing.py_func(*self.data(np.zeros((self.size, 2), dtype=np.int64)))
        return facing

    def opening(self, displacement: FloatArray | None) -> FloatArray:
        """Return the openings (E Q,), gaps minus the equilibrium gap, at coefficients (size, 2) or zero."""
        u = np.zeros((self.size, 2)) if displacement is None else displacement
        opening: FloatArray = self.gap(u) - self.adhesion.law.equilibrium_gap
        return opening

    def gap(self, displacement: FloatArray) -> FloatArray:
        """Return the gaps (E Q,) at coefficients (size, 2); `far` at points without a partner."""
        gap: FloatArray = self.partners(displacement).gap
        return gap

    @property
    def against(self) -> Boundary:
        """The boundary of the other body."""
        assert isinstance(self.adhesion.against, Boundary)
        return self.adhesion.against

    def energy_without_partner(self, one: FloatArray, other: FloatArray) -> tuple[float, float]:
        """Return the energies at points that have a partner in one only of two states (size, 2).

        The first is that of points off an end of the curve, the second that of points that turn away from it.
        """
        states = self.partners(one), self.partners(other)
        law, last = self.adhesion.law, len(self.curve.ends) - 2
        off, away = 0.0, 0.0
        for has, lacks in (states, states[::-1]):
            lost = (has.kind != NONE) & (lacks.kind == NONE)
            gaps, areas = has.gap[lost], self.table.weights.ravel()[lost]
            energy = np.abs(evaluate_law(law.kernel, law.parameters, gaps, np.zeros(gaps.size))[0]) * areas
            at_end = (lacks.segment == 0) & (lacks.place == 0.0)
            at_end |= (lacks.segment == last) & (lacks.place == 1.0)
            off += float(energy[at_end[lost]].sum())
            away += float(energy[~at_end[lost]].sum())
        return off, away

    def respond(self, displacement: FloatArray, history: FloatArray) -> Response:
        """Return the state of all points, at coefficients (size, 2) after a history (E Q,)."""
        found: Response = respond_to(self._facing, self.partners(displacement), history)
        return found


def facing_term(spaces: Spaces, interface: Interface, side: SideTable) -> FacingTerm:
    """Return the term of a side, at the points of a table with gradients, that faces another body."""
    problem, against = spaces.problem, interface.against
    assert isinstance(against, Boundary)
    smooth = interface.smoothed and _check_lagrange(spaces, interface, against)
    curve = smoothed_curve(spaces, against) if smooth else facing_curve(spaces, against)
    closed = closed_opening(problem, interface)
    return FacingTerm(interface, side.of_values(), curve, spaces.size, _FAR * extent(problem), closed)


def _check_lagrange(spaces: Spaces, interface: Interface, against: Boundary) -> bool:
    """Return whether a side consists of Lagrange elements; raises InputError where no smoothed side does."""
    found = is_lagrange(spaces, against)
    if not found and (interface.scheme == "biased" or not is_lagrange(spaces, interface.boundary)):
        allowed = "closest points are found on sides that are smooth; it needs Lagrange elements, such as L2"
        faces = [one.faces for one in spaces.problem.interfaces]
        number = next(n for n, of_one in enumerate(faces, start=1) if interface in of_one)
        raise InputError(f"interface.{number}.smoothed", True, allowed)
    return found
