"""The strip in FElupe, with QDLDL.

A solid body of FElupe's neo-Hooke on a plane field, and adhesion as an integral form on the lower face.
FElupe stores the sparsity patterns of both.
"""

from collections.abc import Iterator

import felupe
import numpy as np
import qdldl
from numpy.polynomial import Polynomial
from scipy.sparse import csc_matrix, csr_matrix

from peers.condensation import Condensation
from peers.grid import Grid, gauss
from peers.laws import (
    ADHERING_LENGTH,
    EQUILIBRIUM_GAP,
    LAME_LAMBDA,
    SHEAR_MODULUS,
    FloatArray,
    IntArray,
    adhesion,
)
from peers.newton import LoadStep, trace


class LagrangeLine:
    """Lagrange functions of a degree on [-1, 1]."""

    def __init__(self, degree: int) -> None:
        nodes = np.linspace(-1, 1, degree + 1)
        vanishing = [Polynomial.fromroots(nodes[nodes != node]) for node in nodes]
        self._functions = [product / product(node) for product, node in zip(vanishing, nodes, strict=True)]

    def function(self, r: FloatArray) -> FloatArray:
        return np.array([function(r[0]) for function in self._functions])

    def gradient(self, r: FloatArray) -> FloatArray:
        return np.array([[function.deriv()(r[0])] for function in self._functions])


class LagrangeByLinear:
    """The element that FElupe lacks: Lagrange along x times linear along y, numbered along x first."""

    def __init__(self, degree: int) -> None:
        self._x, self._y = LagrangeLine(degree), LagrangeLine(1)

    def function(self, r: FloatArray) -> FloatArray:
        return np.outer(self._y.function(r[1:]), self._x.function(r)).ravel()

    def gradient(self, r: FloatArray) -> FloatArray:
        x, y = self._x.function(r), self._y.function(r[1:])
        slopes = np.outer(y, self._x.gradient(r)), np.outer(self._y.gradient(r[1:]), x)
        return np.stack([slope.ravel() for slope in slopes], axis=1)


class FelupeStrip:
    """The strip, with the interface that Newton's method needs."""

    def __init__(self, grid: Grid) -> None:
        points, cells = grid.points, grid.cells
        self._bulk = self._solid(points, cells, grid.degree)
        self._last_column = self._solid(points, cells[grid.last_column], grid.degree)
        self._face = self._face_field(points, grid)
        stiffness = self._bulk.assemble.matrix()
        self._condensation = Condensation(grid.freedoms(), stiffness.indptr, stiffness.indices, "lower")
        self.unknowns = self._condensation.unknowns
        at_rest = np.zeros((grid.degree + 1, len(grid.adhering)))
        self._places = _places(self._adhesive_stiffness(at_rest), stiffness)
        self._solver: qdldl.Solver | None = None

    def displacement(self, state: FloatArray, theta: float) -> FloatArray:
        return self._condensation.displacement(state, theta)

    def assemble(self, u: FloatArray) -> tuple[FloatArray, csc_matrix]:
        for field in (self._bulk.field, self._face):
            field[0].values[:] = u.reshape(-1, 2)
        traction, slope = adhesion(EQUILIBRIUM_GAP + self._face[0].interpolate()[1])
        forces = self._bulk.assemble.vector(self._bulk.field) + self._adhesive_force(traction)
        stiffness = self._bulk.assemble.matrix()
        stiffness.data[self._places] += self._adhesive_stiffness(slope).data
        lower = self._condensation.tangent(stiffness.data)
        # QDLDL takes upper triangles by columns, which are lower ones by rows
        upper = csc_matrix((lower.data, lower.indices, lower.indptr), shape=lower.shape)
        return self._condensation.residual(forces.toarray().ravel()), upper

    def solve(self, tangent: csc_matrix, right_hand_side: FloatArray) -> FloatArray:
        if self._solver is None:
            self._solver = qdldl.Solver(tangent, upper=True)
        else:
            self._solver.update(tangent, upper=True)
        solution: FloatArray = self._solver.solve(right_hand_side)
        return solution

    def moment(self, u: FloatArray, theta: float) -> float:
        solid = self._last_column
        solid.field[0].values[:] = u.reshape(-1, 2)
        return self._condensation.moment(solid.assemble.vector(solid.field).toarray().ravel(), theta)

    def _solid(self, points: FloatArray, cells: IntArray, degree: int) -> felupe.SolidBody:
        (x, weight_x), (y, weight_y) = gauss(degree + 1), gauss(2)
        quadrature = felupe.quadrature.Scheme(
            2 * np.array(np.meshgrid(x, y)).reshape(2, -1).T - 1, 4 * np.outer(weight_y, weight_x).ravel()
        )
        mesh = felupe.Mesh(points, cells, "lagrange by linear")
        region = felupe.Region(mesh, LagrangeByLinear(degree), quadrature, uniform=True)
        # a plane field: in FElupe's FieldPlaneStrain the law would be evaluated in three dimensions
        field = felupe.FieldContainer([felupe.Field(region, dim=2)])
        return felupe.SolidBody(felupe.NeoHookeCompressible(SHEAR_MODULUS, LAME_LAMBDA), field)

    def _face_field(self, points: FloatArray, grid: Grid) -> felupe.FieldContainer:
        x, weight = gauss(grid.degree + 1)
        quadrature = felupe.quadrature.Scheme(2 * x[:, None] - 1, 2 * weight)
        mesh = felupe.Mesh(points, grid.adhering, "lagrange line")
        region = felupe.Region(mesh, LagrangeLine(grid.degree), quadrature, grad=False)
        region.dV = np.full((len(x), 1), ADHERING_LENGTH / len(grid.adhering)) * weight[:, None]
        return felupe.FieldContainer([felupe.Field(region, dim=2)])

    def _adhesive_force(self, traction: FloatArray) -> csr_matrix:
        force = np.stack([np.zeros_like(traction), -traction])
        return felupe.IntegralForm([force], self._face, self._face.region.dV, grad_v=[False]).assemble()

    def _adhesive_stiffness(self, slope: FloatArray) -> csr_matrix:
        moduli = np.zeros((2, 2, *slope.shape))
        moduli[1, 1] = -slope
        form = felupe.IntegralForm(
            [moduli], self._face, self._face.region.dV, self._face, grad_v=[False], grad_u=[False]
        )
        return form.assemble()


def _places(part: csr_matrix, whole: csr_matrix) -> IntArray:
    """Return the indices in `whole` of the entries of `part`."""
    keys = []
    for matrix in (part, whole):
        rows = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
        keys.append(rows * matrix.shape[1] + matrix.indices)
    places: IntArray = np.searchsorted(keys[1], keys[0])
    return places


def start(degree: int, elements: tuple[int, int], angles: Iterator[float]) -> Iterator[LoadStep]:
    """Return the path of FElupe."""
    return trace(FelupeStrip(Grid(degree, elements)), angles)
