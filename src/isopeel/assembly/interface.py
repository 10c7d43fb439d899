"""The state of an interface at any points of its side, by the same kernel as in the assembly."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from isopeel.assembly.closest_point_kernel import NONE
from isopeel.assembly.contact import with_contact_stiffness
from isopeel.assembly.facing_term import FacingTerm, facing_term
from isopeel.assembly.interface_kernel import projected_areas
from isopeel.assembly.interface_term import InterfaceTerm, substrate_tangents
from isopeel.assembly.opening import closed_opening
from isopeel.assembly.pair_term import PairTerm, pair_term
from isopeel.assembly.spaces import SpaceOfBodies, Spaces, check_coefficients, spaces_by_name
from isopeel.assembly.tables import element_ends, side_points, table_at, usual_points
from isopeel.common.arrays import BoolArray, FloatArray
from isopeel.common.errors import InputError
from isopeel.physics.adhesion.irreversible import NOT_CLOSED
from isopeel.physics.batch import evaluate_law
from isopeel.physics.joints import JointLaw
from isopeel.problem import Boundary, Problem


@dataclass(frozen=True, eq=False)
class InterfaceState:
    """The state of an interface at points (n, k), in the units of the problem.

    Tractions and energies are per reference area, even if the law acts on the projected area. The traction is
    T n_o + t t_o, with the normal n_o at the point, and the tangent t_o at its initial position; of a joint
    law both are those of the mean direction of both faces.
    """

    position: FloatArray  # x (n, k, 2)
    gap: FloatArray
    normal: FloatArray  # n_o, of the substrate (n, k, 2)
    stretch: FloatArray  # of the side; nan at a corner where two sides meet tangentially
    normal_traction: FloatArray  # T, repulsion positive
    tangential_traction: FloatArray  # t
    traction: FloatArray  # on the body (n, k, 2)
    opening: FloatArray  # the maximum opening; zero at points that have not closed yet
    softening: BoolArray  # whether the traction decreases beyond the maximum opening
    energy: FloatArray  # the energy that closing would release
    dissipated: FloatArray


class InterfacePoints:
    """Points of the side of an interface, on the spaces of a problem, at which states are evaluated.

    `parameters` (n, k) are in [0, 1] along the side, each row on one element; `weights` (n, k) are those of a
    quadrature over the parameter, by default zero. If there are several interfaces, the name selects one.
    """

    def __init__(
        self,
        problem: Problem,
        space: SpaceOfBodies,
        parameters: FloatArray,
        weights: FloatArray | None = None,
        interface: str = "",
    ) -> None:
        spaces = with_contact_stiffness(Spaces.on(problem, space))
        problem = self._problem = spaces.problem
        self._spaces = space
        self._name = interface
        self._interface_name = interface or problem.interface_names[0]
        self.parameters: FloatArray = parameters
        adhesion = self._adhesion = problem.interface_of(interface)
        shape, own = problem.body_of(adhesion.boundary.body).shape, spaces.of[adhesion.boundary.body]
        weights = np.zeros(parameters.shape) if weights is None else weights
        table = table_at(shape, own, adhesion.side, parameters, weights)
        table = replace(table, functions=spaces.places[adhesion.boundary.body].start + table.functions)
        #: Weights of the points in integrals over the reference length.
        self.lengths: FloatArray = table.weights
        self._projected = adhesion.traction == "projected"
        self._table = table if self._projected else table.of_values()
        self._tangents = np.stack([-table.normals[..., 1], table.normals[..., 0]], axis=-1)
        self._term: InterfaceTerm | FacingTerm | PairTerm
        if isinstance(adhesion.law, JointLaw):
            self._term = pair_term(spaces, adhesion, table)
        elif isinstance(adhesion.against, Boundary):
            self._term = facing_term(spaces, adhesion, self._table)
        else:
            self._tangents = substrate_tangents(adhesion.against, table.positions)
            closed = closed_opening(problem, adhesion)
            self._term = InterfaceTerm(adhesion, self._table, self._tangents, closed)
        self._contact: InterfacePoints | None = None

    @classmethod
    def of_contact(
        cls, problem: Problem, space: SpaceOfBodies, count: int | None = None, interface: str = ""
    ) -> Self:
        """Return the points at which the assembly evaluates the interface, `count` on each element."""
        boundary = problem.interface_of(interface).boundary
        own = spaces_by_name(problem, space)[boundary.body]
        return cls(problem, space, *side_points(own, boundary.side, boundary.part, count), interface)

    def history(self, displacement: FloatArray, maximum_openings: FloatArray | None) -> FloatArray:
        """Return the maximum openings (n, k) of an irreversible joint, `NOT_CLOSED` if it has not closed yet.

        They follow from the `maximum_openings` of a step, which are at the points of the assembly of all
        interfaces, and from its coefficients (size, 2). Between these points, the excess over the present
        opening is interpolated linearly along the side; beyond the first and the last point it is constant.
        A point has closed if the nearest point of the assembly has closed. If the maximum openings are nan,
        they are not known: then the present openings are used. Raises InputError if they are missing, or if
        they or the coefficients are of another space.

        Of contact with multipliers these are the overlaps that they replace, which are interpolated linearly.
        Of a joint law these are its variables (variables, n, k), which are interpolated linearly; negative
        ones mean that a value is unknown, and are those of the nearest point.
        """
        if isinstance(self._term, PairTerm):
            self._checked(displacement)
            return self._variables(self._term.law, maximum_openings)
        if self._adhesion.penetration is not None:
            self._checked(displacement)
            return self._replaced(maximum_openings)
        return self._largest(self._checked(displacement), maximum_openings)

    def state(self, displacement: FloatArray, maximum_openings: FloatArray | None = None) -> InterfaceState:
        """Evaluate a state with coefficients (size, 2).

        An irreversible joint needs the `maximum_openings`, and raises the errors of `history`.
        """
        u = self._checked(displacement)
        adhesion, law = self._adhesion, self._adhesion.law
        history = np.zeros(self.parameters.shape)
        if adhesion.has_history or isinstance(law, JointLaw):
            history = self.history(u, maximum_openings)
        known = history.ravel()
        known.setflags(write=False)
        response = self._term.respond(u, known)
        area = np.ones(self.parameters.size)
        table = self._table
        if self._projected:
            area = projected_areas(table.functions, table.gradients, table.normals, response.normal, u)
        T, shear = area * response.traction, -response.shear[0]
        opening = np.maximum(response.gap - law.equilibrium_gap, 0.0)
        softening = response.derivative > 0
        tangents = self._tangents
        if isinstance(self._term, PairTerm):
            opening = np.maximum(self._term.opening(u), 0.0)
            softening = self._term.softens(u, known)
            turned = np.stack([response.normal[1], -response.normal[0]], axis=-1)
            tangents = turned.reshape(tangents.shape)
        if adhesion.irreversible:
            waits = history.ravel() < 0
            opening = np.where(waits, 0.0, np.maximum(opening, history.ravel()))
            farthest = np.where(waits, response.gap, law.equilibrium_gap + opening)
            rigid = not isinstance(adhesion.against, Boundary)
            seen = response.curvature * (rigid and adhesion.substrate.constant_curvature)
            softening = evaluate_law(law.kernel, law.parameters, farthest, seen)[2] > 0
        shape = self.parameters.shape
        normal = np.moveaxis(response.normal, 0, -1).reshape(*shape, 2)
        T, shear = T.reshape(shape), shear.reshape(shape)
        return InterfaceState(
            position=np.moveaxis(response.position, 0, -1).reshape(*shape, 2),
            gap=response.gap.reshape(shape),
            normal=normal,
            stretch=self._stretch(u),
            normal_traction=T,
            tangential_traction=shear,
            traction=T[..., None] * normal + shear[..., None] * tangents,
            opening=opening.reshape(shape),
            softening=softening.reshape(shape),
            energy=(area * response.potential).reshape(shape),
            dissipated=(area * response.dissipated).reshape(shape),
        )

    def gap(self, displacement: FloatArray) -> FloatArray:
        """Return the gaps (n, k) at coefficients (size, 2); far from all bodies where there is no partner."""
        return self._term.gap(self._checked(displacement)).reshape(self.parameters.shape)

    def has_partner(self, displacement: FloatArray) -> BoolArray:
        """Return whether the points (n, k) have a partner on another body; on a substrate all have one."""
        term, u = self._term, self._checked(displacement)
        has = np.ones(self.parameters.size, dtype=bool)
        if isinstance(term, FacingTerm):
            has = term.partners(u).kind != NONE
        elif isinstance(term, PairTerm):
            has = term.paired.ravel()
        return has.reshape(self.parameters.shape)

    def _checked(self, displacement: FloatArray) -> FloatArray:
        """Return the coefficients (size, 2) with the types of compiled code."""
        check_coefficients(spaces_by_name(self._problem, self._spaces), displacement)
        u = np.ascontiguousarray(displacement, dtype=np.float64).view()
        u.setflags(write=False)
        return u

    def _opening(self, u: FloatArray) -> FloatArray:
        """Return the present openings (n k,), zero where the joint is closed."""
        return np.maximum(self._term.opening(u), 0.0)

    def _largest(self, u: FloatArray, maximum_openings: FloatArray | None) -> FloatArray:
        adhesion = self._adhesion
        here = self._opening(u)
        if maximum_openings is not None and len(self._problem.faces) > 1:
            parts = maximum_openings_by_name(self._problem, self._spaces, maximum_openings)
            maximum_openings = parts[self._name or self._problem.interface_names[0]]
        if maximum_openings is not None and np.isnan(maximum_openings).any():
            return here.reshape(self.parameters.shape)
        own = spaces_by_name(self._problem, self._spaces)[adhesion.boundary.body]
        elements = element_ends(own, adhesion.side, adhesion.boundary.part).size - 1
        if (
            maximum_openings is None
            or maximum_openings.ndim != 2
            or len(maximum_openings) != elements
            or not maximum_openings.size
        ):
            allowed = f"an irreversible joint needs its maximum openings, on {elements} elements"
            raise InputError(
                "maximum_openings", None if maximum_openings is None else maximum_openings.shape, allowed
            )
        if self._contact is None or self._contact.parameters.shape != maximum_openings.shape:
            self._contact = InterfacePoints.of_contact(
                self._problem, self._spaces, maximum_openings.shape[1], self._name
            )
        known = maximum_openings.ravel()
        excess = np.where(known < 0, 0.0, np.maximum(known - self._contact._opening(u), 0.0))
        at, places = self.parameters.ravel(), self._contact.parameters.ravel()
        nearest = np.searchsorted((places[1:] + places[:-1]) / 2, at)
        largest = np.where(known[nearest] < 0, NOT_CLOSED, here + np.interp(at, places, excess))
        return largest.reshape(self.parameters.shape)

    def _replaced(self, overlaps: FloatArray | None) -> FloatArray:
        if overlaps is None or np.isnan(overlaps).any():
            raise InputError("maximum_openings", None, "contact with a penetration needs its multipliers")
        known = maximum_openings_by_name(self._problem, self._spaces, overlaps)[self._interface_name]
        if self._contact is None or self._contact.parameters.shape != known.shape:
            self._contact = InterfacePoints.of_contact(
                self._problem, self._spaces, known.shape[1], self._name
            )
        at, places = self.parameters.ravel(), self._contact.parameters.ravel()
        return np.interp(at, places, known.ravel()).reshape(self.parameters.shape)

    def _variables(self, law: JointLaw, history: FloatArray | None) -> FloatArray:
        shape = (len(law.history), *self.parameters.shape)
        if not law.history:
            return np.zeros(shape)
        if history is None:
            raise InputError("maximum_openings", None, "a joint with damage needs its history")
        if np.isnan(history).any():
            return np.broadcast_to(np.reshape(law.initial_history(), (-1, 1, 1)), shape)
        known = maximum_openings_by_name(self._problem, self._spaces, history)[self._interface_name]
        if self._contact is None or self._contact.parameters.shape != known.shape[1:]:
            self._contact = InterfacePoints.of_contact(
                self._problem, self._spaces, known.shape[2], self._name
            )
        at, places = self.parameters.ravel(), self._contact.parameters.ravel()
        nearest = np.searchsorted((places[1:] + places[:-1]) / 2, at)
        flat = known.reshape(len(known), -1)
        between = np.stack([np.interp(at, places, np.maximum(one, 0.0)) for one in flat])
        return np.where(flat[:, nearest] < 0, flat[:, nearest], between).reshape(shape)

    def _stretch(self, u: FloatArray) -> FloatArray:
        table = self._table
        tangent = np.stack([-table.normals[..., 1], table.normals[..., 0]], axis=-1)
        slopes = np.einsum("nkJm,nkJ->nkm", table.gradients, tangent)
        change = np.einsum("nkm,nmi->nki", slopes, u[table.functions])
        stretch: FloatArray = np.linalg.norm(tangent + change, axis=-1)
        return stretch


def maximum_openings_by_name(
    problem: Problem, space: SpaceOfBodies, maximum_openings: FloatArray
) -> dict[str, FloatArray]:
    """Return the maximum openings (E, Q) of each interface by its name, from those of all in a step.

    Of a joint law these are its variables (variables, E, Q). Raises InputError if they are of other spaces.
    """
    spaces = spaces_by_name(problem, space)
    boundaries = [interface.boundary for interface in problem.faces]
    elements = [element_ends(spaces[one.body], one.side, one.part).size - 1 for one in boundaries]
    points = [usual_points(spaces[one.body], one.side) for one in boundaries]
    if maximum_openings.ndim == 2 and len(maximum_openings) == sum(elements):
        # as many on each element, by default or as given for all
        points = [maximum_openings.shape[1]] * len(boundaries)
    joints = [isinstance(interface.law, JointLaw) for interface in problem.faces]
    rows = [len(one.history_variables) * count for one, count in zip(problem.faces, elements, strict=True)]
    sizes = [count * each for count, each in zip(rows, points, strict=True)]
    if any(joints) and maximum_openings.size not in (0, sum(sizes)):
        each = maximum_openings.size // sum(rows)
        points = [each] * len(boundaries)
        sizes = [count * each for count in rows]
    ends = np.cumsum(sizes)
    if maximum_openings.size != ends[-1]:
        allowed = f"the interfaces have {', '.join(map(str, elements))} elements"
        raise InputError("maximum_openings", maximum_openings.shape, allowed)
    parts = np.split(maximum_openings.ravel(), ends[:-1])
    names = problem.interface_names
    shapes = [
        (len(one.history_variables), count, each) if joint else (count, each)
        for one, joint, count, each in zip(problem.faces, joints, elements, points, strict=True)
    ]
    return {name: part.reshape(shape) for name, part, shape in zip(names, parts, shapes, strict=True)}
