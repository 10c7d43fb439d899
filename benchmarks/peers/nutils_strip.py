"""The strip in Nutils, with PARDISO.

Nutils differentiates the residual and compiles it. The geometry is a scaled index of the elements, which it
evaluates faster than nodes. Its own solvers analyse each tangent again, so pypardiso is used.
"""

from collections.abc import Iterator

import numpy as np
import treelog
from nutils import function, mesh
from nutils.function import Array
from nutils.solver import System
from scipy.sparse import csr_matrix

from peers.condensation import Condensation
from peers.grid import Grid
from peers.laws import (
    EQUILIBRIUM_GAP,
    EQUILIBRIUM_STIFFNESS,
    HEIGHT,
    LAME_LAMBDA,
    LENGTH,
    SHEAR_MODULUS,
    FloatArray,
    attraction,
)
from peers.newton import LoadStep, trace
from peers.pardiso import SymmetricSolver


class NutilsStrip:
    """The strip, with the interface that Newton's method needs."""

    def __init__(self, grid: Grid) -> None:
        topology, index = mesh.rectilinear(grid.elements)
        place = index * np.array([LENGTH, HEIGHT]) / np.array(grid.elements)
        basis = topology.basis("spline", degree=(grid.degree, 1), continuity=0)
        u, v = (function.dotarg(name, basis, shape=(2,)) for name in "uv")
        bulk = np.sum(_stress(function.grad(u, place)) * function.grad(v, place))
        bulk *= function.jacobian(place, 2)
        adhesive = -_traction(EQUILIBRIUM_GAP + u[1]) * v[1] * function.jacobian(place, 1)

        points = "gauss", (2 * grid.degree + 1, 3)
        face = topology.boundary["bottom"][: len(grid.adhering)].sample("gauss", 2 * grid.degree + 1)
        work = topology.sample(*points).integral(bulk) + face.integral(adhesive)
        self._system = System(work, trial="u", test="v")
        self._last_column = System(topology[-1:].sample(*points).integral(bulk), trial="u", test="v")

        tangent, _ = self._system.assemble_jacobian_residual({"u": np.zeros((len(basis), 2))})
        _, columns, row_starts = tangent.export("csr")
        self._condensation = Condensation(grid.freedoms(), row_starts, columns, "upper")
        self.unknowns = self._condensation.unknowns
        self.solve = SymmetricSolver()

    def displacement(self, state: FloatArray, theta: float) -> FloatArray:
        return self._condensation.displacement(state, theta)

    def assemble(self, u: FloatArray) -> tuple[FloatArray, csr_matrix]:
        tangent, residual = self._system.assemble_jacobian_residual({"u": u.reshape(-1, 2)})
        entries, _, _ = tangent.export("csr")
        return self._condensation.residual(residual), self._condensation.tangent(entries)

    def moment(self, u: FloatArray, theta: float) -> float:
        forces = self._last_column.assemble_residual({"u": u.reshape(-1, 2)})
        return self._condensation.moment(forces, theta)


def _stress(gradient: Array) -> Array:
    F = gradient + np.eye(2)
    factor = LAME_LAMBDA * np.log(np.linalg.det(F)) - SHEAR_MODULUS
    return SHEAR_MODULUS * F + factor * np.linalg.inv(F).T


def _traction(gap: Array) -> Array:
    pressed = np.minimum(gap - EQUILIBRIUM_GAP, 0)
    return attraction(np.maximum(gap, EQUILIBRIUM_GAP)) + EQUILIBRIUM_STIFFNESS * pressed


def start(degree: int, elements: tuple[int, int], angles: Iterator[float]) -> Iterator[LoadStep]:
    """Return the path of Nutils."""
    treelog.current = treelog.NullLog()
    return trace(NutilsStrip(Grid(degree, elements)), angles)
