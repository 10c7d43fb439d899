"""The assembled system: a problem on a spline space, as the solver sees it."""

from copy import copy
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from psutil import virtual_memory

from isopeel.assembly.body_kernel import add_body
from isopeel.assembly.body_term import BodyTerm
from isopeel.assembly.constraints import Constraints, constrain, half_bandwidth
from isopeel.assembly.equations import Equations
from isopeel.assembly.interface_term import InterfaceTerm
from isopeel.assembly.loads import AssembledLoad
from isopeel.assembly.loops import Loops, Sums, add_terms, term_list
from isopeel.assembly.start import ROUND_OFF, check_start, extent
from isopeel.assembly.tables import BodyTable, SideTable, body_table, side_table
from isopeel.assembly.terms import Term
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.matrix.band import BandMatrix, Storage
from isopeel.problem import Problem
from isopeel.splines.rows import RowSpace


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """Energies and forces of one state; forces are derivatives of the energy where there is one."""

    stored_energy: float
    adhesive_energy: float
    dissipated_energy: float
    lowest_determinant: float  # of F at the quadrature points
    forces: FloatArray  # (size, 2), on every coefficient
    residual: FloatArray  # (count,), on every unknown; the forces less those of the load


def bytes_needed(space: RowSpace) -> int:
    """Estimate of a system's memory from above: its tables, and its tangent stored for a pivoted LU."""
    along, across, rows = space.degree + 1, space.across.degree + 1, len(space.rows)
    elements = space.elements[0], space.elements[0] * space.elements[1]
    # maps and weight of each point; functions and unknowns of each row, if every row is of its own kind
    tables = elements[1] * along * across * 7 + elements[0] * rows * along * (2 * along + 2)
    # unknowns are numbered along the shorter side first, and degree + 1 functions of a row overlap
    half_bandwidth = 2 * min(along * rows, across * space.rows[0].size)
    # compiled code has tables of its own
    return 8 * (2 * tables + 2 * space.size * (3 * half_bandwidth + 1))


class System:
    """Forces and tangents of a problem on a space. Tables are made once; the pattern never changes.

    The adhesive force has `contact_points` Gauss points per element, one more than the degree by default.
    `base` are the coefficients (size, 2) of the state that the drive begins with, if it is not the body as
    it is. Raises InputError where the memory does not suffice, where problem and space do not fit together,
    where the body overlaps the substrate, or where it can move as a whole without a force.

    Tangents share one array per storage: each call of `linearize` overwrites the last one's.
    """

    #: What the forces of the body are made by.
    body_loops: ClassVar[tuple[Loops]] = (add_body,)

    def __init__(
        self,
        problem: Problem,
        space: RowSpace,
        contact_points: int | None = None,
        base: FloatArray | None = None,
    ) -> None:
        needed, free = bytes_needed(space), virtual_memory().available
        if needed > free:
            allowed = (
                f"it needs up to {needed / 2**30:.1f} GiB of memory, and {free / 2**30:.1f} GiB are free"
            )
            raise InputError("mesh", "{}x{}".format(*space.elements), allowed)
        shape = problem.body.shape
        adhesion = problem.adhesion
        self.problem = problem
        self.space = space.weighted(shape)
        self.body: BodyTable = body_table(shape, self.space)
        of_body = BodyTerm(problem.body.material, self.body, *self.body_loops)
        functions = of_body.couplings()
        self.constraints: Constraints = constrain(problem, self.space, functions, base)
        self.half_bandwidth: int = half_bandwidth(self.constraints.unknowns, functions)
        part = adhesion.start, adhesion.end
        side = side_table(shape, self.space, adhesion.side, part, contact_points)
        # only the projected force asks for the deformation gradient
        self.adhesive: SideTable = side if adhesion.traction == "projected" else side.of_values()
        self.load: AssembledLoad | None = AssembledLoad.of(
            problem.drive, shape, self.space, self.constraints, base
        )
        tangents = check_start(problem, self.space, self.adhesive, self.constraints, self.load, base)
        # gaps are known to the round-off of positions
        of_side = InterfaceTerm(adhesion, self.adhesive, tangents, ROUND_OFF * extent(problem))
        #: What forces and tangent are the sum of.
        self.terms: tuple[Term, ...] = of_body, of_side
        #: Maximum openings (E, Q) at the points of the adhesive force, for irreversible adhesion. At first
        #: those of the body as it is made: a base with a history comes with its own.
        self.maximum_openings: FloatArray = of_side.initial().reshape(self.adhesive.weights.shape)
        #: Young's modulus times the area of the body: what energies are measured against.
        self.energy_scale: float = problem.body.material.youngs_modulus * self.body.area
        self._workspaces: dict[Storage, FloatArray] = {}
        self._no_forces = np.zeros(self.constraints.count)
        held = self.constraints
        listed = [(term.loops, term.data(held.unknowns), term.initial().size) for term in self.terms]
        self.equations = Equations(term_list(listed), held.unknowns, held.offset, held.driven)

    def without_joint(self) -> Self:
        """The same body without what a substrate does to it. It shares the arrays of tangents."""
        loose = copy(self)
        kept = [k for k, term in enumerate(self.terms) if not isinstance(term, InterfaceTerm)]
        loose.equations = self.equations._replace(terms=self.equations.terms.only(kept))
        return loose

    @property
    def load_is_unknown(self) -> bool:
        """Whether the size of the load is one more unknown, after those of the displacement."""
        return self.load is not None and self.load.load.control == "displacement"

    @property
    def count(self) -> int:
        """Number of unknowns y: those of the displacement, and the size of a load that is unknown."""
        return self.constraints.count + self.load_is_unknown

    def state(self, unknown_values: FloatArray, parameter: float) -> tuple[FloatArray, float]:
        """Coefficients u (size, 2) and size of the load, of unknowns y (count,) at a parameter."""
        u = self.constraints.displacement(unknown_values[: self.constraints.count], parameter)
        if self.load is None:
            return u, 0.0
        return u, float(unknown_values[-1]) if self.load_is_unknown else parameter

    def external(self, load: float) -> FloatArray:
        """Forces (count,) of a dead load of a size on the unknowns of the displacement."""
        if self.load is None:
            return self._no_forces
        return load * self.constraints.condense(self.load.pattern)

    def unknown_values(self, displacement: FloatArray, parameter: float) -> FloatArray:
        """Unknowns y (count,) of coefficients u (size, 2); the size of an unknown load is left at zero."""
        z = self.constraints.unknown_values(displacement, parameter)
        # a dead load enters the equations linearly: Newton's method finds it at once
        return np.append(z, 0.0) if self.load_is_unknown else z

    def reaction(
        self, equilibrium: Equilibrium, displacement: FloatArray, load: float, parameter: float
    ) -> float:
        """What answers the parameter: the force or moment that moves, the load, or its displacement."""
        if self.load is None:
            return self.constraints.reaction(equilibrium.forces, parameter)
        return load if self.load_is_unknown else self.load.displacement(displacement)

    def potential(
        self, equilibrium: Equilibrium, displacement: FloatArray, load: float, parameter: float
    ) -> tuple[float, float]:
        """Energy that is least in a stable state, and its derivative by the parameter along a path."""
        reaction = self.reaction(equilibrium, displacement, load, parameter)
        energy = equilibrium.stored_energy + equilibrium.adhesive_energy + equilibrium.dissipated_energy
        if self.load is None or self.load_is_unknown:
            return energy, reaction
        return energy - load * reaction, -reaction

    def control(self, displacement: FloatArray, parameter: float) -> tuple[float, FloatArray, FloatArray]:
        """What the displacement of an unknown load misses, and the last column and row of the tangent."""
        assert self.load is not None
        missed = parameter - self.load.displacement(displacement)
        column = -self.constraints.condense(self.load.forces(displacement))
        return missed, column, -self.constraints.condense(self.load.pattern)

    @property
    def storage(self) -> Storage:
        """Symmetric where all forces have a potential."""
        turning = self.load is not None and self.load.load.follows
        symmetric = not turning and all(term.has_potential for term in self.terms)
        return "symmetric" if symmetric else "general"

    def inverted_point(self, displacement: FloatArray) -> tuple[FloatArray, float] | None:
        """Reference position (2,) and determinant of F at the most inverted quadrature point, if any is."""
        table, shape = self.body, self.problem.body.shape
        worst: tuple[FloatArray, float] | None = None
        xi = table.xi.ravel()
        for row, places in enumerate(table.eta):
            for eta in places:
                at = np.full(xi.size, eta)
                basis = self.space.basis(xi, at, row)
                local = displacement[basis.functions]
                derivatives = np.einsum("nmi,nam->nia", local, basis.derivatives)
                F = np.eye(2) + derivatives @ np.linalg.inv(shape.jacobian(xi, at))
                determinant = np.linalg.det(F)
                n = int(np.argmin(determinant))
                if determinant[n] <= 0 and (worst is None or determinant[n] < worst[1]):
                    worst = shape.evaluate(xi[n : n + 1], at[:1])[0], float(determinant[n])
        return worst

    def accept(self, displacement: FloatArray) -> None:
        """Update the maximum openings by an equilibrium, coefficients (size, 2)."""
        of_side = self.terms[1]
        self.maximum_openings = of_side.commit(displacement, self.maximum_openings.ravel()).reshape(
            self.maximum_openings.shape
        )

    def equilibrium(self, displacement: FloatArray, load: float = 0.0) -> Equilibrium:
        """Energies, forces and residual of coefficients u (size, 2) under a load of a size."""
        return self._assemble(displacement, load, None)

    def linearize(
        self,
        displacement: FloatArray,
        storage: Storage | None = None,
        load: float = 0.0,
        openings: FloatArray | None = None,
    ) -> tuple[Equilibrium, BandMatrix]:
        """The same with the tangent dR/dz, in `general` storage where it may not be positive definite.

        Irreversible adhesion has opened by `openings` (E, Q), by default by those noted last.
        """
        storage = storage or self.storage
        width = self.half_bandwidth + 1 if storage == "symmetric" else 3 * self.half_bandwidth + 1
        if storage not in self._workspaces:
            # one more row takes what no unknown wants
            self._workspaces[storage] = np.empty((self.constraints.count + 1, width))
        band = self._workspaces[storage]
        band.fill(0.0)
        matrix = BandMatrix(band, self.half_bandwidth, storage)
        return self._assemble(displacement, load, matrix, openings), matrix

    def _assemble(
        self,
        displacement: FloatArray,
        load: float,
        matrix: BandMatrix | None,
        openings: FloatArray | None = None,
    ) -> Equilibrium:
        band = np.empty((0, 0)) if matrix is None else matrix.workspace
        diagonal = 0 if matrix is None or matrix.storage == "symmetric" else 2 * self.half_bandwidth
        forces = np.zeros(displacement.shape)
        sums = Sums(forces, band, diagonal, matrix is not None)
        noted = self.maximum_openings if openings is None else openings
        # loops are compiled for contiguous arrays alone
        energies = add_terms(self.equations.terms, noted.ravel(), np.ascontiguousarray(displacement), sums)
        unbalanced = forces
        if self.load is not None:
            unbalanced = forces - load * self.load.forces(displacement)
            if matrix is not None and self.load.load.follows:
                self.load.add_stiffness(band, diagonal, load)
        residual = self.constraints.condense(unbalanced)
        return Equilibrium(*energies, forces, residual)
