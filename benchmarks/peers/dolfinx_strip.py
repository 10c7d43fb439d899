"""The strip in DOLFINx, with CHOLMOD through PETSc; written for the version in Debian 12.

Its elements have the same degree along x and y, so only linear elements can be compared.
"""

from collections.abc import Iterator

import numpy as np
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI
from petsc4py import PETSc

from peers.condensation import Condensation, Freedoms
from peers.laws import (
    ADHERING_LENGTH,
    EQUILIBRIUM_GAP,
    EQUILIBRIUM_STIFFNESS,
    HEIGHT,
    LAME_LAMBDA,
    LENGTH,
    SHEAR_MODULUS,
    FloatArray,
    IntArray,
    attraction,
)
from peers.newton import LoadStep, trace
from peers.protocol import AbsentError

POINTS_DEGREE = 3  # degree of the polynomials that 2 Gauss points per direction integrate exactly
COMPILER_OPTIONS = {"cffi_extra_compile_args": ["-O3", "-march=native"]}
SMALL = 1e-9


class DolfinxStrip:
    """The strip, with the interface that Newton's method needs."""

    def __init__(self, elements: tuple[int, int]) -> None:
        domain = mesh.create_rectangle(
            MPI.COMM_SELF, [[0, 0], [LENGTH, HEIGHT]], elements, mesh.CellType.quadrilateral
        )
        space = fem.VectorFunctionSpace(domain, ("Lagrange", 1))
        self._u = fem.Function(space)
        residual, last_column = _residuals(self._u, domain, LENGTH / elements[0])
        self._residual, self._last_column = _compiled(residual), _compiled(last_column)
        self._stiffness = _compiled(ufl.derivative(residual, self._u))
        self._forces = fem.assemble_vector(self._residual)
        self._matrix = fem.petsc.create_matrix(self._stiffness)
        row_starts, columns, _ = self._assemble_stiffness()
        self._condensation = Condensation(
            _freedoms(space.tabulate_dof_coordinates()), row_starts, columns, "whole"
        )
        self.unknowns = self._condensation.unknowns

        pattern = self._condensation.pattern
        self._tangent = PETSc.Mat().createAIJWithArrays(
            pattern.shape, (pattern.indptr, pattern.indices, pattern.data), comm=MPI.COMM_SELF
        )
        self._tangent.setOption(PETSc.Mat.Option.SPD, True)
        kinds, packages = PETSc.PC.Type, PETSc.Mat.SolverType
        self._cholesky = _solver(self._tangent, kinds.CHOLESKY, packages.CHOLMOD)
        self._lu = _solver(self._tangent, kinds.LU, packages.UMFPACK)
        self._solution = self._tangent.createVecRight()

    def displacement(self, state: FloatArray, theta: float) -> FloatArray:
        return self._condensation.displacement(state, theta)

    def assemble(self, u: FloatArray) -> tuple[FloatArray, PETSc.Mat]:
        self._u.x.array[:] = u
        self._forces.array[:] = 0
        fem.assemble_vector(self._forces.array, self._residual)
        _, _, entries = self._assemble_stiffness()
        self._condensation.tangent(entries)
        self._tangent.stateIncrease()
        return self._condensation.residual(self._forces.array), self._tangent

    def solve(self, tangent: PETSc.Mat, right_hand_side: FloatArray) -> FloatArray:
        given = PETSc.Vec().createWithArray(right_hand_side, comm=MPI.COMM_SELF)
        for solver in (self._cholesky, self._lu):
            solver.setOperators(tangent)
            solver.solve(given, self._solution)
            if solver.getConvergedReason() > 0:
                break  # else the tangent isn't positive definite
        solution: FloatArray = self._solution.array.copy()
        return solution

    def moment(self, u: FloatArray, theta: float) -> float:
        self._u.x.array[:] = u
        self._forces.array[:] = 0
        fem.assemble_vector(self._forces.array, self._last_column)
        return self._condensation.moment(self._forces.array, theta)

    def _assemble_stiffness(self) -> tuple[IntArray, IntArray, FloatArray]:
        """Return its row starts, columns and entries."""
        self._matrix.zeroEntries()
        fem.petsc.assemble_matrix(self._matrix, self._stiffness)
        self._matrix.assemble()
        parts: tuple[IntArray, IntArray, FloatArray] = self._matrix.getValuesCSR()
        return parts


def _solver(matrix: PETSc.Mat, kind: str, package: str) -> PETSc.KSP:
    """Return a direct solver, which analyses the pattern only once."""
    solver = PETSc.KSP().create(MPI.COMM_SELF)
    solver.setOperators(matrix)
    solver.setType(PETSc.KSP.Type.PREONLY)
    solver.getPC().setType(kind)
    solver.getPC().setFactorSolverType(package)
    return solver


def _residuals(u: fem.Function, domain: mesh.Mesh, length: float) -> tuple[ufl.Form, ufl.Form]:
    """Return the forms of the whole residual, and of that of the bulk in the last elements of this length."""
    last = mesh.locate_entities(domain, 2, lambda x: x[0] > LENGTH - length - SMALL)
    low = mesh.locate_entities_boundary(
        domain, 1, lambda x: (x[1] < SMALL) & (x[0] < ADHERING_LENGTH + SMALL)
    )
    tags = (
        mesh.meshtags(domain, dimension, np.sort(entities), np.ones(len(entities), dtype=np.int32))
        for dimension, entities in ((2, last), (1, low))
    )
    dx, ds = (
        ufl.Measure(kind, domain, subdomain_data=tag, metadata={"quadrature_degree": POINTS_DEGREE})
        for kind, tag in zip(("dx", "ds"), tags, strict=True)
    )
    v = ufl.TestFunction(u.function_space)
    work = ufl.inner(_stress(ufl.grad(u)), ufl.grad(v))
    return work * dx - _traction(EQUILIBRIUM_GAP + u[1]) * v[1] * ds(1), work * dx(1)


def _compiled(form: ufl.Form) -> fem.FormMetaClass:
    return fem.form(form, jit_params=COMPILER_OPTIONS)


def _freedoms(nodes: FloatArray) -> Freedoms:
    """Return the degrees of freedom, those of a node one after the other."""
    left = np.flatnonzero(nodes[:, 0] < SMALL)
    face = np.flatnonzero(nodes[:, 0] > LENGTH - SMALL)
    return Freedoms(2 * len(nodes), 2 * left, 2 * face, 2 * face + 1, nodes[face, 1] - HEIGHT / 2)


def _stress(gradient: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
    F = ufl.variable(gradient + ufl.Identity(2))
    factor = LAME_LAMBDA * ufl.ln(ufl.det(F)) - SHEAR_MODULUS
    return SHEAR_MODULUS * F + factor * ufl.inv(F).T


def _traction(gap: ufl.core.expr.Expr) -> ufl.core.expr.Expr:
    beyond = gap - EQUILIBRIUM_GAP
    return ufl.conditional(ufl.gt(beyond, 0), attraction(gap), EQUILIBRIUM_STIFFNESS * beyond)


def start(degree: int, elements: tuple[int, int], angles: Iterator[float]) -> Iterator[LoadStep]:
    """Return the path of DOLFINx."""
    if degree != 1:
        raise AbsentError(f"its elements have the same degree along x and y, not {degree} and 1")
    return trace(DolfinxStrip(elements), angles)
