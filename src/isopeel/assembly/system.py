"""The assembled system: a problem on a spline space, as the solver sees it."""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from math import prod
from typing import TYPE_CHECKING, Self

import numpy as np
from psutil import virtual_memory

from isopeel.assembly.body_kernel import loops_of
from isopeel.assembly.body_term import BodyTerm
from isopeel.assembly.constraints import Constraints, constrain
from isopeel.assembly.contact import with_contact_stiffness
from isopeel.assembly.control import Control
from isopeel.assembly.equations import Equations
from isopeel.assembly.facing_term import FacingTerm, facing_term
from isopeel.assembly.interface_term import InterfaceTerm
from isopeel.assembly.load_term import LoadTerm, load_terms
from isopeel.assembly.loops import Loops, Sums, add_terms, term_list
from isopeel.assembly.numbering import half_bandwidth
from isopeel.assembly.opening import closed_opening
from isopeel.assembly.pair_term import PairTerm, pair_term
from isopeel.assembly.spaces import SpaceOfBodies, Spaces
from isopeel.assembly.start import check_rigid, check_start
from isopeel.assembly.tables import BodyTable, SideTable, body_of, side_of
from isopeel.assembly.terms import Term
from isopeel.assembly.tie_kernel import lead
from isopeel.common.arrays import FloatArray, frozen
from isopeel.common.errors import InputError
from isopeel.matrix.band import BandMatrix, Storage
from isopeel.physics.joints import JointLaw
from isopeel.problem import Boundary, Interface, Problem
from isopeel.problem.boundary import boundary_names
from isopeel.splines.nurbs import NurbsSurface
from isopeel.splines.rows import RowSpace

if TYPE_CHECKING:
    from scipy.sparse import csr_array


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """Energies and forces of one state; forces are derivatives of the energy where there is one."""

    stored_energy: float
    adhesive_energy: float
    dissipated_energy: float
    lowest_determinant: float  # of F at the quadrature points
    forces: FloatArray  # (size, 2), on every coefficient; those on followers moved to what they follow
    residual: FloatArray  # (count,), on every unknown


def bytes_needed(*spaces: RowSpace) -> int:
    """Estimate of a system's memory from above: its tables, and its tangent stored for a pivoted LU."""
    tables = unknowns = half_bandwidth = 0
    for space in spaces:
        along, across, rows = space.degree + 1, space.across.degree + 1, len(space.rows)
        elements = space.elements[0], space.elements[0] * space.elements[1]
        # maps and weight of each point; functions and unknowns of each row, if every row is of its own kind
        tables += elements[1] * along * across * 7 + elements[0] * rows * along * (2 * along + 2)
        # unknowns are numbered along the shorter side first, and degree + 1 functions of a row overlap
        half_bandwidth = max(half_bandwidth, 2 * min(along * rows, across * space.rows[0].size))
        unknowns += 2 * space.size
    # compiled code has tables of its own
    return 8 * (2 * tables + unknowns * (3 * half_bandwidth + 1))


def _with_law(
    term: InterfaceTerm | FacingTerm | PairTerm, interface: Interface
) -> InterfaceTerm | FacingTerm | PairTerm:
    """Return a term of an interface that has another law."""
    if isinstance(term, PairTerm):
        assert isinstance(interface.law, JointLaw)
        return replace(term, adhesion=interface, law=interface.law)
    return replace(term, adhesion=interface)


class System:
    """Forces and tangents of a problem on a space. Tables are made once; the pattern never changes.

    Several bodies have a space each, by their names; their functions are numbered one body after another. The
    adhesive force has `contact_points` Gauss points per element, one more than the degree by default. `base`
    are the coefficients (size, 2) of the state that the drive begins with, if it is not the bodies as they
    are. Bodies share the tables of those of the system `like` that have the very same shape; they must have
    the same space there. Raises InputError where the memory does not suffice, where problem and spaces do not
    fit together, where a body overlaps the substrate, can move as a whole without a force, or cannot without
    strain.

    Tangents share one array per storage: each call of `linearize` overwrites the last one's.
    """

    def __init__(
        self,
        problem: Problem,
        space: SpaceOfBodies,
        contact_points: int | None = None,
        base: FloatArray | None = None,
        like: Self | None = None,
    ) -> None:
        self.spaces: Spaces = with_contact_stiffness(Spaces.on(problem, space))
        problem = self.problem = self.spaces.problem
        given = tuple(self.spaces.of.values())
        needed, free = bytes_needed(*given), virtual_memory().available
        if needed > free:
            allowed = (
                f"it needs up to {needed / 2**30:.1f} GiB of memory, and {free / 2**30:.1f} GiB are free"
            )
            raise InputError("mesh", ", ".join("{}x{}".format(*one.elements) for one in given), allowed)
        for body in problem.bodies:
            check_rigid(self.spaces.of[body.name], body.shape)
        known = {} if like is None or like.spaces.places != self.spaces.places else like._tables
        tables = [known.get(body.shape) or body_of(self.spaces, body) for body in problem.bodies]
        self.bodies: tuple[BodyTerm, ...] = tuple(
            BodyTerm(body, table, self.body_loops(table))
            for body, table in zip(problem.bodies, tables, strict=True)
        )
        faces = [self._face(interface, contact_points) for interface in problem.faces]
        #: The sides that face other bodies.
        self.facing: tuple[FacingTerm, ...] = tuple(one for one in faces if isinstance(one, FacingTerm))
        pairs = [found for one in faces if isinstance(one, PairTerm) for found in one.couplings()]
        couplings = {term.body.name: term.couplings() for term in self.bodies}
        links = [*pairs]
        for term in self.facing:
            # partners may be far from those of the undeformed bodies
            links += term.couplings() if base is None else term.couplings_at(base)
        self.constraints: Constraints = constrain(self.spaces, couplings, base, links)
        unknowns = self.constraints.unknowns
        #: Of the tangents of the bodies and of fixed pairs.
        self.half_bandwidth: int = max(
            half_bandwidth(unknowns, self.constraints.tied.coupled(found))
            for found in (*couplings.values(), pairs)
        )
        self.loads: tuple[LoadTerm, ...] = load_terms(self.spaces, self.constraints, base)
        #: Those that are held.
        self.held: tuple[LoadTerm, ...] = tuple(load for load in self.loads if not load.of_drive)
        driving = tuple(load for load in self.loads if load.of_drive)
        #: How the parameter of the drive enters the equations.
        self.control: Control = Control(
            self.constraints, driving, tuple(one.factor for one in problem.driven)
        )
        tangents = iter(check_start(self.spaces, faces, self.control, base))
        self.interfaces: tuple[InterfaceTerm | FacingTerm | PairTerm, ...] = tuple(
            face
            if isinstance(face, FacingTerm | PairTerm)
            else InterfaceTerm(interface, face, next(tangents), closed_opening(problem, interface))
            for interface, face in zip(problem.faces, faces, strict=True)
        )
        self._complete()

    def _complete(self) -> None:
        """Set what follows from the terms of bodies, interfaces and loads."""
        problem = self.problem
        #: Whether an interface is damaged as it opens.
        self.irreversible: bool = any(interface.has_history for interface in problem.interfaces)
        #: Whether multipliers of contact are in the history.
        self.has_multipliers: bool = any(one.penetration is not None for one in problem.interfaces)
        #: What forces and tangent are the sum of.
        self.terms: tuple[Term, ...] = *self.bodies, *self.interfaces, *self.loads
        #: Whether all forces are derivatives of an energy, so that the tangent is symmetric.
        self.has_potential: bool = all(term.has_potential for term in self.terms)
        #: Maximum openings at the points of the adhesive force, for irreversible adhesion: the history from
        #: which forces are evaluated. It is that of the undeformed bodies, unless `after` sets another one.
        #: They are (E, Q), elements of one interface after those of another; (n, 1) where these differ in Q,
        #: and where an interface has a joint law: then the variables of its history take their place.
        self.maximum_openings: FloatArray = self._shaped([term.initial() for term in self.interfaces])
        #: Young's modulus times the area of the bodies: what energies are measured against.
        self.energy_scale: float = sum(
            term.body.material.youngs_modulus * term.table.area for term in self.bodies
        )
        self._tangents: dict[Storage, BandMatrix] = {}
        self.equations: Equations = self._equations()

    @staticmethod
    def body_loops(table: BodyTable) -> Loops:
        """Return what makes the forces of a body."""
        return loops_of(table)

    @property
    def _tables(self) -> dict[NurbsSurface, BodyTable]:
        return {term.body.shape: term.table for term in self.bodies}

    def _equations(self) -> Equations:
        held = self.constraints
        listed = [(term.loops, term.data(held.unknowns), term.initial().size) for term in self.terms]
        return Equations(term_list(listed), held.unknowns, held.offset, held.driven, held.tied.followers)

    def with_physics_of(self, problem: Problem) -> Self:
        """Return the same system with the materials and laws of a problem that differs in nothing else.

        It shares the tables. The start is not checked again.
        """
        other = copy(self)
        other.spaces = with_contact_stiffness(replace(self.spaces, problem=problem))
        problem = other.problem = other.spaces.problem
        other.bodies = tuple(
            replace(term, body=body) for term, body in zip(self.bodies, problem.bodies, strict=True)
        )
        other.interfaces = tuple(
            _with_law(term, face) for term, face in zip(self.interfaces, problem.faces, strict=True)
        )
        other.facing = tuple(one for one in other.interfaces if isinstance(one, FacingTerm))
        other._complete()
        return other

    def under(self, share: float) -> Self:
        """The same system under a share of the held loads. It shares the arrays of tangents."""
        lighter = copy(self)
        lighter.held = tuple(replace(load, size=share * load.size) for load in self.held)
        lighter.loads = *self.control.loads, *lighter.held
        lighter.terms = *self.bodies, *self.interfaces, *lighter.loads
        lighter.equations = lighter._equations()
        return lighter

    def _face(self, interface: Interface, contact_points: int | None) -> SideTable | FacingTerm | PairTerm:
        side = side_of(self.spaces, interface.boundary, contact_points)
        if isinstance(interface.law, JointLaw):
            return pair_term(self.spaces, interface, side)
        if not isinstance(interface.against, Boundary):
            # only the projected force needs the deformation gradient
            return side if interface.traction == "projected" else side.of_values()
        return facing_term(self.spaces, interface, side)

    def half_bandwidth_at(self, displacement: FloatArray) -> int:
        """Return that of the tangent at coefficients (size, 2): partners of sides that face may change."""
        unknowns = self.constraints.unknowns
        coupled = self.constraints.tied.coupled
        of_facing = (
            half_bandwidth(unknowns, coupled(term.couplings_at(displacement))) for term in self.facing
        )
        return max((self.half_bandwidth, *of_facing))

    def without_joint(self) -> Self:
        """The same bodies without what a substrate does to them. It shares the arrays of tangents."""
        return self.only([t for t, term in enumerate(self.terms) if term not in self.interfaces])

    def only(self, kept: Sequence[int]) -> Self:
        """The same unknowns with the forces of some terms, by their numbers."""
        lighter = copy(self)
        lighter.equations = self.equations._replace(terms=self.equations.terms.only(kept))
        return lighter

    @property
    def space(self) -> RowSpace:
        """That of the only body."""
        return self.spaces.of[self.problem.body.name]

    @property
    def body(self) -> BodyTable:
        """The table of the only body."""
        (body,) = self.bodies
        return body.table

    @property
    def adhesive(self) -> SideTable:
        """The table of the only interface."""
        (interface,) = self.interfaces
        return interface.table

    def after(self, maximum_openings: FloatArray) -> Self:
        """Return the same system after a history. It shares the arrays of tangents."""
        later = copy(self)
        later.maximum_openings = frozen(maximum_openings)
        return later

    def commit(self, displacement: FloatArray) -> FloatArray:
        """Return the maximum openings after an equilibrium, coefficients (size, 2), that is accepted."""
        if not self.irreversible:
            return self.maximum_openings
        before = self.maximum_openings_of(self.maximum_openings).values()
        terms = zip(self.interfaces, before, strict=True)
        return self._shaped([term.commit(displacement, opened.ravel()) for term, opened in terms])

    def maximum_openings_of(self, maximum_openings: FloatArray) -> dict[str, FloatArray]:
        """Return the maximum openings (E, Q) of each interface, of a joint variables (k, E, Q), by name."""
        found, start, flat = {}, 0, maximum_openings.ravel()
        for name, term in zip(self.problem.interface_names, self.interfaces, strict=True):
            shape: tuple[int, ...] = term.table.weights.shape
            if isinstance(term, PairTerm):
                shape = len(term.law.history), *shape
            end = start + prod(shape)
            found[name] = flat[start:end].reshape(shape)
            start = end
        return found

    def _shaped(self, parts: Sequence[FloatArray]) -> FloatArray:
        """Return the maximum openings of all interfaces, from those (n,) of each."""
        counts = {
            1 if isinstance(term, PairTerm) else term.table.weights.shape[1] for term in self.interfaces
        }
        if len(parts) == 1:
            return parts[0].reshape(-1, counts.pop())
        joined = np.concatenate([np.zeros(0), *parts])
        return frozen(joined.reshape(-1, counts.pop() if len(counts) == 1 else 1))

    @property
    def global_unknowns(self) -> int:
        """Number of unknowns that belong to no function: one where the size of a load is found."""
        return self.constraints.global_unknowns

    @property
    def count(self) -> int:
        """Number of unknowns y: those of the displacement, and the global ones."""
        return self.constraints.total

    @property
    def storage(self) -> Storage:
        """Of the tangent."""
        return "symmetric" if self.has_potential else "general"

    def jump_rates(self) -> "csr_array | None":
        """Return the matrix (rows, unknowns of the displacement) of `PairTerm.jump_rates` for all joints.

        None without a joint that holds bodies together.
        """
        joints = [term for term in self.interfaces if isinstance(term, PairTerm)]
        if not joints:
            return None
        from scipy.sparse import vstack

        of = self.constraints
        found = vstack([term.jump_rates(of.unknowns, of.count) for term in joints], format="csr")
        return found if found.nnz and np.any(found.data) else None

    def state(self, unknown_values: FloatArray, parameter: float) -> tuple[FloatArray, float]:
        """Coefficients u (size, 2) and size of the load, of unknowns y (count,) at a parameter."""
        u = self.constraints.displacement(unknown_values, parameter)
        return u, self.control.load(unknown_values, parameter)

    def unknown_values(self, displacement: FloatArray, parameter: float) -> FloatArray:
        """Unknowns y (count,) of coefficients u (size, 2); the size of an unknown load is left at zero."""
        return self.constraints.unknown_values(displacement, parameter)

    def reaction(
        self, equilibrium: Equilibrium, displacement: FloatArray, load: float, parameter: float
    ) -> float:
        """What works on the parameter: the force or moment that moves, the load, or its displacement."""
        return self.control.reaction(equilibrium.forces, displacement, load, parameter)

    def held_work(self, displacement: FloatArray) -> float:
        """Work of the loads that are held, since the base state, at coefficients u (size, 2)."""
        return sum((load.size * load.displacement(displacement) for load in self.held), 0.0)

    def potential(
        self, equilibrium: Equilibrium, displacement: FloatArray, load: float, parameter: float
    ) -> tuple[float, float]:
        """Energy that is least in a stable state, and its derivative by the parameter along a path."""
        reaction = self.reaction(equilibrium, displacement, load, parameter)
        energy = equilibrium.stored_energy + equilibrium.adhesive_energy + equilibrium.dissipated_energy
        return self.control.potential(energy - self.held_work(displacement), load, reaction)

    def support_reactions(self, equilibrium: Equilibrium) -> dict[str, FloatArray]:
        """Return the force (2,) of each support on its body, by its name; zero along what it leaves free."""
        supports, found = self.problem.supports, {}
        for name, support in zip(boundary_names([one.boundary for one in supports]), supports, strict=True):
            functions = self.constraints.tied.copies[self.spaces.boundary(support.boundary)]
            total = equilibrium.forces[functions].sum(axis=0)
            found[name] = np.where(np.isin([0, 1], support.components), total, 0.0)
        return found

    def inverted_point(self, displacement: FloatArray) -> tuple[FloatArray, float] | None:
        """Reference position (2,) and determinant of F at the most inverted quadrature point, if any is."""
        worst: tuple[FloatArray, float] | None = None
        for term in self.bodies:
            name, table, shape = term.body.name, term.table, term.body.shape
            u, space = displacement[self.spaces.places[name]], self.spaces.of[name]
            xi = table.xi.ravel()
            for row, places in enumerate(table.eta):
                for eta in places:
                    at = np.full(xi.size, eta)
                    basis = space.basis(xi, at, row)
                    local = u[basis.functions]
                    derivatives = np.einsum("nmi,nam->nia", local, basis.derivatives)
                    F = np.eye(2) + derivatives @ np.linalg.inv(shape.jacobian(xi, at))
                    determinant = np.linalg.det(F)
                    n = int(np.argmin(determinant))
                    if determinant[n] <= 0 and (worst is None or determinant[n] < worst[1]):
                        worst = shape.evaluate(xi[n : n + 1], at[:1])[0], float(determinant[n])
        return worst

    def equilibrium(self, displacement: FloatArray, load: float = 0.0) -> Equilibrium:
        """Energies, forces and residual of coefficients u (size, 2) under a load of a size."""
        return self._assemble(displacement, load, None)

    def linearize(
        self,
        displacement: FloatArray,
        storage: Storage | None = None,
        load: float = 0.0,
    ) -> tuple[Equilibrium, BandMatrix]:
        """The same with the tangent dR/dz, in `general` storage where it may not be positive definite."""
        storage = storage or self.storage
        known, half_bandwidth = self._tangents.get(storage), self.half_bandwidth_at(displacement)
        # not in a wider band of an earlier state: a resumed path would round in another way
        if known is not None and known.half_bandwidth == half_bandwidth:
            matrix = known.zeroed()
        else:
            matrix = BandMatrix.zeros(self.constraints.count, half_bandwidth, storage)
        self._tangents[storage] = matrix
        return self._assemble(displacement, load, matrix), matrix

    def _assemble(
        self,
        displacement: FloatArray,
        load: float,
        matrix: BandMatrix | None,
    ) -> Equilibrium:
        forces = np.zeros(displacement.shape)
        sums = Sums(forces, np.empty((0, 0)), 0, False)
        if matrix is not None:
            sums = Sums(forces, matrix.workspace, matrix.diagonal, True)
        history = self.maximum_openings.ravel()
        # loops are compiled for contiguous arrays alone
        u, scalars = np.ascontiguousarray(displacement), np.array([load])
        energies = add_terms(self.equations.terms, history, scalars, u, sums)
        tied = self.constraints.tied
        lead(tied.followers, forces)
        if matrix is not None:
            tied.condense(matrix, self.constraints.unknowns)
        return Equilibrium(*energies, forces, self.constraints.condense(forces))
