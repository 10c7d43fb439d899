"""The strip in NGSolve, with its sparse Cholesky.

Symbolic forms, compiled to machine code if there is a compiler. The space has order one, with higher
functions only on the edges along x: Lagrange along x times linear along y.
"""

from collections.abc import Iterator

import netgen.meshing as netgen
import ngsolve as ng
import numpy as np

from peers.condensation import Condensation, Freedoms
from peers.grid import Grid, gauss
from peers.laws import (
    EQUILIBRIUM_GAP,
    EQUILIBRIUM_STIFFNESS,
    LAME_LAMBDA,
    SHEAR_MODULUS,
    FloatArray,
    attraction,
)
from peers.newton import LoadStep, trace


class NgsolveStrip:
    """The strip, with the interface that Newton's method needs."""

    def __init__(self, grid: Grid) -> None:
        corners = Grid(1, grid.elements)
        mesh = _mesh(corners)
        component = higher_along_x(mesh, grid.degree)
        space = component**2
        self._form, self._last_column = _forms(space, grid.degree)
        self._u, self._forces = (self._form.mat.CreateRowVector() for _ in range(2))
        _, columns, row_starts = (np.asarray(part) for part in self._form.mat.CSR())
        self._condensation = Condensation(
            _freedoms(corners, component.ndof), row_starts.astype(np.int64), columns, "whole"
        )
        self.unknowns = self._condensation.unknowns
        pattern = self._condensation.pattern.tocoo()
        self._tangent = ng.la.SparseMatrixd.CreateFromCOO(
            pattern.row.tolist(), pattern.col.tolist(), pattern.data.tolist(), *pattern.shape
        )
        self._entries = self._tangent.AsVector().FV().NumPy()
        self._inverse: ng.BaseMatrix | None = None

    def displacement(self, state: FloatArray, theta: float) -> FloatArray:
        return self._condensation.displacement(state, theta)

    def assemble(self, u: FloatArray) -> tuple[FloatArray, ng.BaseMatrix]:
        self._u.FV().NumPy()[:] = u
        self._form.AssembleLinearization(self._u)
        self._form.Apply(self._u, self._forces)
        entries, _, _ = self._form.mat.CSR()
        self._entries[:] = self._condensation.tangent(np.asarray(entries)).data
        return self._condensation.residual(self._forces.FV().NumPy()), self._tangent

    def solve(self, tangent: ng.BaseMatrix, right_hand_side: FloatArray) -> FloatArray:
        if self._inverse is None:
            self._inverse = tangent.Inverse(inverse="sparsecholesky")
        else:
            self._inverse.Update()
        given, solution = tangent.CreateColVector(), tangent.CreateRowVector()
        given.FV().NumPy()[:] = right_hand_side
        solution.data = self._inverse * given
        return np.array(solution.FV().NumPy())

    def moment(self, u: FloatArray, theta: float) -> float:
        self._u.FV().NumPy()[:] = u
        self._last_column.Apply(self._u, self._forces)
        return self._condensation.moment(self._forces.FV().NumPy(), theta)


def higher_along_x(mesh: ng.Mesh, degree: int) -> ng.FESpace:
    """Return the space of one component: Lagrange of a degree along x times linear along y."""
    component = ng.H1(mesh, order=1)
    for edge in mesh.edges:
        if np.ptp([mesh[vertex].point[1] for vertex in edge.vertices]) == 0:
            component.SetOrder(edge, degree)
    component.UpdateDofTables()
    return component


def _mesh(grid: Grid) -> ng.Mesh:
    """Return the mesh, its last column and its adhering boundary by name."""
    mesh = netgen.Mesh(dim=2)
    points = [mesh.Add(netgen.MeshPoint(netgen.Pnt(x, y, 0))) for x, y in grid.points]
    last = set(grid.last_column.tolist())
    mesh.SetMaterial(1, "rest")
    mesh.SetMaterial(2, "last")
    mesh.Add(netgen.FaceDescriptor(surfnr=1, domin=1, bc=1))
    mesh.Add(netgen.FaceDescriptor(surfnr=2, domin=2, bc=2))
    for number, (a, b, d, c) in enumerate(grid.cells):
        corners = [points[corner] for corner in (a, b, c, d)]  # so that reference axes are the strip's
        mesh.Add(netgen.Element2D(2 if number in last else 1, corners))
    for a, b in grid.adhering:
        mesh.Add(netgen.Element1D([points[a], points[b]], index=1))
    mesh.SetBCName(0, "adhering")
    return ng.Mesh(mesh)


def _freedoms(grid: Grid, count: int) -> Freedoms:
    """Return the degrees of freedom of a space that numbers all x before all y, the corners first in each."""
    first = grid.freedoms()
    return Freedoms(2 * count, first.fixed // 2, first.face_x // 2, first.face_y // 2 + count, first.arm)


def _forms(space: ng.FESpace, degree: int) -> tuple[ng.BilinearForm, ng.BilinearForm]:
    """Return the whole form, assembled once, and that of the bulk in the last column."""
    (x, weight_x), (y, weight_y) = gauss(degree + 1), gauss(2)
    points = [(a, b) for b in y for a in x]
    bulk = {ng.ET.QUAD: ng.IntegrationRule(points, np.outer(weight_y, weight_x).ravel().tolist())}
    face = {ng.ET.SEGM: ng.IntegrationRule([(a,) for a in x], weight_x.tolist())}
    u, v = space.TnT()
    work = compiled(ng.InnerProduct(stress(ng.Grad(u)), ng.Grad(v)))
    adhesive = compiled(-_traction(EQUILIBRIUM_GAP + u[1]) * v[1])
    whole, last = (ng.BilinearForm(space, symmetric=True) for _ in range(2))
    whole += work * ng.dx(intrules=bulk)
    whole += adhesive * ng.ds("adhering", intrules=face)
    last += work * ng.dx("last", intrules=bulk)
    at_rest = ng.GridFunction(space)
    whole.AssembleLinearization(at_rest.vec)
    return whole, last


def compiled(integrand: ng.CoefficientFunction) -> ng.CoefficientFunction:
    """Return the integrand compiled to machine code if there is a compiler."""
    try:
        return integrand.Compile(realcompile=True, wait=True)
    except Exception:  # NGSolve raises it without a compiler
        return integrand.Compile()


def stress(gradient: ng.CoefficientFunction) -> ng.CoefficientFunction:
    """Return the nominal stress of the neo-Hooke law at a displacement gradient."""
    F = gradient + ng.Id(2)
    factor = LAME_LAMBDA * ng.log(ng.Det(F)) - SHEAR_MODULUS
    return SHEAR_MODULUS * F + factor * ng.Inv(F).trans


def _traction(gap: ng.CoefficientFunction) -> ng.CoefficientFunction:
    beyond = gap - EQUILIBRIUM_GAP
    return ng.IfPos(beyond, attraction(gap), EQUILIBRIUM_STIFFNESS * beyond)


def start(degree: int, elements: tuple[int, int], angles: Iterator[float]) -> Iterator[LoadStep]:
    """Return the path of NGSolve."""
    ng.SetNumThreads(1)
    return trace(NgsolveStrip(Grid(degree, elements)), angles)
