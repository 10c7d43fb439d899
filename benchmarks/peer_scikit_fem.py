"""The strip peeled by a pure moment, by scikit-fem and PARDISO (pypardiso): the peer of our speed benchmark.

scikit-fem gives mesh, element, degrees of freedom and the basis at the quadrature points. The local matrices
of all elements are BLAS products, many times faster than a loop over pairs of basis functions (BilinearForm);
they are summed into the upper triangle of one fixed pattern, which PARDISO analyses once.

Lengths in nm, stresses in units of Young's modulus E0 = 2 GPa, moments in E0 nm^3 for a width of 1 nm.
"""

import argparse
import time
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray
from pypardiso import PyPardisoSolver
from pypardiso.pardiso_wrapper import PyPardisoError
from scipy.sparse import coo_matrix, csr_matrix
from skfem import CellBasis, Dofs, FacetBasis, MeshQuad
from skfem.element import ElementH1
from skfem.refdom import RefQuad
from threadpoolctl import threadpool_limits

FloatArray: TypeAlias = NDArray[np.float64]
IntArray: TypeAlias = NDArray[np.int64]

LENGTH, HEIGHT, ADHERING_LENGTH = 200.0, 10.0, 150.0
POISSON_RATIO = 0.2
LAME_LAMBDA = POISSON_RATIO / ((1 + POISSON_RATIO) * (1 - 2 * POISSON_RATIO))
SHEAR_MODULUS = 1 / (2 * (1 + POISSON_RATIO))
HAMAKER, INTERACTION_DISTANCE = 0.05, 0.4
EQUILIBRIUM_GAP = INTERACTION_DISTANCE / 15 ** (1 / 6)
MOST_ITERATIONS = 25

POSITIVE_DEFINITE, INDEFINITE, NOT_POSITIVE_DEFINITE = 2, -2, -4
ANALYSIS, FACTORIZATION_AND_SOLUTION = 11, 23
# own parameters; minimum degree ordering (the fastest on a strip); pivots: perturbed below 1e-8, 1x1 and 2x2.
# What is absent is 0: above all, no iterative refinement
PARDISO_PARAMETERS = {1: 1, 2: 0, 10: 8, 21: 1}


@dataclass(frozen=True)
class LoadStep:
    """A converged equilibrium: the turn of the face, the moment that holds it, the linear solves it took."""

    theta_deg: float
    moment: float
    iterations: int


class ElementQuadLagrangeByLinear(ElementH1):  # type: ignore[misc]
    """Lagrange of any degree along x times linear along y, numbered along x first."""

    refdom = RefQuad
    nodal_dofs = 1

    def __init__(self, degree: int) -> None:
        nodes = np.linspace(0, 1, degree + 1)
        self.degree = degree
        self.maxdeg = degree + 1
        self.doflocs = np.array([[x, y] for y in (0.0, 1.0) for x in nodes])
        vanishing = [Polynomial.fromroots(nodes[nodes != node]) for node in nodes]
        self._along_x = [product / product(node) for product, node in zip(vanishing, nodes, strict=True)]

    def lbasis(self, X: FloatArray, i: int) -> tuple[FloatArray, FloatArray]:
        row, column = divmod(i, self.degree + 1)
        polynomial = self._along_x[column]
        along_x, along_y, slope_y = polynomial(X[0]), (X[1] if row else 1 - X[1]), (1 if row else -1)
        return along_x * along_y, np.array([polynomial.deriv()(X[0]) * along_y, along_x * slope_y])


class RowwiseDofs(Dofs):  # type: ignore[misc]
    """One degree of freedom per vertex and degree - 1 per horizontal edge, none elsewhere."""

    def __init__(self, mesh: MeshQuad, element: ElementQuadLagrangeByLinear) -> None:
        self.topo, self.element = mesh, element
        horizontal, edge = np.unique(mesh.t2f[[0, 2]], return_inverse=True)
        per_edge = element.degree - 1
        lower, upper = mesh.nvertices + per_edge * edge.reshape(2, 1, -1) + np.arange(per_edge)[:, None]
        t = mesh.t
        self.element_dofs = np.vstack([t[0], lower, t[1], t[3], upper, t[2]]).astype(np.int32)
        self.N = mesh.nvertices + per_edge * horizontal.size


class SymmetricSolver:
    """PARDISO for matrices of one pattern, given as upper triangles: Cholesky, or LDL^T where that fails."""

    def __init__(self, pattern: csr_matrix) -> None:
        self._solvers = {kind: PyPardisoSolver(mtype=kind) for kind in (POSITIVE_DEFINITE, INDEFINITE)}
        for solver in self._solvers.values():
            for parameter, value in PARDISO_PARAMETERS.items():
                solver.set_iparm(parameter, value)
            solver.set_phase(ANALYSIS)
            solver._call_pardiso(pattern, np.zeros(pattern.shape[0]))
            solver.set_phase(FACTORIZATION_AND_SOLUTION)

    def solve(self, matrix: csr_matrix, right_hand_side: FloatArray) -> FloatArray:
        # PyPardisoSolver.solve would analyse the pattern each time and refine the solution twice
        solution: FloatArray
        try:
            solution = self._solvers[POSITIVE_DEFINITE]._call_pardiso(matrix, right_hand_side)
        except PyPardisoError as error:
            if error.value != NOT_POSITIVE_DEFINITE:
                raise
            solution = self._solvers[INDEFINITE]._call_pardiso(matrix, right_hand_side)
        return solution


class ScikitFemStrip:
    """The strip under its turned right face; force per reference area, exact tangent, plain Newton.

    Newton stops after the update du with |R . du| / (number of unknowns) < tolerance, in E0 nm^3.
    """

    def __init__(self, degree: int, elements: tuple[int, int] = (200, 10), tolerance: float = 1e-16) -> None:
        adhering = elements[0] * ADHERING_LENGTH / LENGTH
        if degree < 1 or min(elements) < 1 or adhering != round(adhering):
            raise ValueError(
                f"degree {degree} or mesh {elements} cannot be used; 3/4 of the elements along x must adhere"
            )
        self._tolerance = tolerance
        mesh = MeshQuad.init_tensor(
            np.linspace(0, LENGTH, elements[0] + 1), np.linspace(0, HEIGHT, elements[1] + 1)
        )
        # init_tensor runs through y first: turned so that the reference axes are the strip's
        mesh = MeshQuad(mesh.p, mesh.t[[0, 3, 2, 1]])
        element = ElementQuadLagrangeByLinear(degree)
        (x, weight_x), (y, weight_y) = _gauss(degree + 1), _gauss(2)
        points = np.array(np.meshgrid(x, y)).reshape(2, -1)
        bulk = CellBasis(
            mesh,
            element,
            quadrature=(points, np.outer(weight_y, weight_x).ravel()),
            dofs=RowwiseDofs(mesh, element),
        )
        lower = mesh.facets_satisfying(lambda x: (x[1] < 1e-9) & (x[0] < ADHERING_LENGTH))
        contact = FacetBasis(mesh, element, quadrature=(x[None], weight_x), facets=lower, dofs=bulk.dofs)
        self._number_unknowns(bulk.doflocs)
        self._tabulate(bulk, contact, degree)
        self._build_pattern()
        self._solver = SymmetricSolver(self._tangent)

    def trace(self, angles_deg: Iterable[float]) -> Iterator[LoadStep]:
        """Yield the equilibrium at each angle, starting unstressed; RuntimeError where Newton fails."""
        history = deque([(0.0, np.zeros(self.unknowns + 1))], maxlen=3)
        for angle in angles_deg:
            theta = np.deg2rad(angle)
            state, iterations = self._equilibrium(_extrapolate(history, theta), theta)
            history.append((theta, state))
            yield LoadStep(float(angle), self._moment(state, theta), iterations)

    def _number_unknowns(self, places: FloatArray) -> None:
        """Number the unknowns along the strip; last the face's two; the slot after them stays zero."""
        left, right = np.isclose(places[0], 0), np.isclose(places[0], LENGTH)
        free = np.tile(~right, (2, 1))
        free[0, left] = False
        order = np.lexsort((places[1], places[0]))
        numbers = np.zeros((places.shape[1], 2), dtype=np.int64)
        numbers[free[:, order].T] = np.arange(np.count_nonzero(free))
        self.unknowns = int(np.count_nonzero(free)) + 2
        self._unknown = np.empty((2, places.shape[1]), dtype=np.int64)
        self._unknown[:, order] = numbers.T
        self._unknown[0, left] = self.unknowns
        self._unknown[:, right] = [[self.unknowns - 2], [self.unknowns - 1]]
        self._face = np.flatnonzero(right)
        self._arm = places[:, right] - [[LENGTH], [HEIGHT / 2]]

    def _tabulate(self, bulk: CellBasis, contact: FacetBasis, degree: int) -> None:
        """Keep the basis of one element: on a uniform mesh it is that of all."""
        gradient = np.array([field.grad[:, 0] for (field,) in bulk.basis])
        weighted = gradient * bulk.dx[0]
        self._dofs = bulk.element_dofs.astype(np.int64)
        self._moduli = np.empty((4, bulk.dx.shape[1], bulk.nelems))
        self._gradient = np.ascontiguousarray(gradient.transpose(1, 2, 0))
        self._weighted_gradient = weighted.reshape(len(gradient), -1)
        product = np.einsum("aJq,bLq->abJLq", weighted, gradient)
        xx, yy, xy, yx = product[:, :, 0, 0], product[:, :, 1, 1], product[:, :, 0, 1], product[:, :, 1, 0]
        self._same_component = np.concatenate([xx, yy, xy + yx], axis=-1)[np.triu_indices(len(gradient))]
        self._mixed_components = np.concatenate([xx, yy, xy, yx], axis=-1).reshape(len(gradient) ** 2, -1)
        self._last_column = self._dofs[:, np.isin(self._dofs, self._face).any(axis=0)]

        values = np.array([field[0] for (field,) in contact.basis[: degree + 1]])
        self._contact_dofs = contact.element_dofs[: degree + 1].astype(np.int64)
        self._contact_values = values.T
        self._weighted_values = values * contact.dx[0]
        self._contact_products = (self._weighted_values[:, None] * values)[np.triu_indices(len(values))]

    def _build_pattern(self) -> None:
        """Make the upper triangle's pattern and the sparse operator that sums local entries into it."""
        n = self.unknowns
        self._targets = np.concatenate(
            [self._unknown[:, self._dofs].ravel(), self._unknown[1, self._contact_dofs].ravel()]
        )
        upper, every = np.triu_indices(len(self._dofs)), np.indices((len(self._dofs),) * 2).reshape(2, -1)
        upper_below = np.triu_indices(len(self._contact_dofs))
        blocks = [
            (0, 0, *(self._dofs[index] for index in upper)),
            (1, 1, *(self._dofs[index] for index in upper)),
            (0, 1, *(self._dofs[index] for index in every)),
            (1, 1, *(self._contact_dofs[index] for index in upper_below)),
        ]
        first = np.concatenate([self._unknown[i, dofs].ravel() for i, _, dofs, _ in blocks])
        second = np.concatenate([self._unknown[k, dofs].ravel() for _, k, _, dofs in blocks])
        distinct = np.concatenate([(dofs != others).ravel() for _, _, dofs, others in blocks])
        # degrees of freedom of the face share an unknown: an entry and its mirror image meet on the diagonal
        weights = np.where(distinct & (first == second), 2.0, 1.0)
        kept = np.flatnonzero(np.maximum(first, second) < n)
        rows, columns = np.minimum(first, second)[kept], np.maximum(first, second)[kept]
        places, position = np.unique(rows * n + columns, return_inverse=True)
        shape = (places.size, first.size)
        self._gather = coo_matrix((weights[kept], (position, kept)), shape=shape).tocsr()
        row_starts = np.searchsorted(places, n * np.arange(n + 1))
        self._tangent = csr_matrix((np.zeros(places.size), places % n, row_starts), shape=(n, n))
        self._local = np.empty(first.size)
        ends = np.cumsum([dofs.size for _, _, dofs, _ in blocks])[:-1]
        parts = zip(np.split(self._local, ends), blocks, strict=True)
        self._local_blocks = [part.reshape(block[2].shape) for part, block in parts]

    def _displacement(self, state: FloatArray, theta: float) -> FloatArray:
        displacement: FloatArray = np.take(state, self._unknown)
        cosine, sine = np.cos(theta), np.sin(theta)
        displacement[:, self._face] += np.array([[cosine - 1, -sine], [sine, cosine - 1]]) @ self._arm
        return displacement

    def _equilibrium(self, state: FloatArray, theta: float) -> tuple[FloatArray, int]:
        for iteration in range(1, MOST_ITERATIONS + 1):
            residual = self._assemble(self._displacement(state, theta))
            update = self._solver.solve(self._tangent, -residual)
            state[:-1] += update
            if abs(residual @ update) < self._tolerance * self.unknowns:
                return state, iteration
        raise RuntimeError(
            f"no equilibrium at {np.rad2deg(theta):g} degrees after {MOST_ITERATIONS} iterations"
        )

    def _assemble(self, displacement: FloatArray) -> FloatArray:
        """Return the residual (unknowns,) and leave the tangent in self._tangent."""
        F, inverse, factor = self._kinematics(displacement, self._dofs)
        same_x, same_y, mixed, adhesive = self._local_blocks
        # dP_iJ/dF_kL = mu d_ik d_JL - factor G_Jk G_Li + lambda G_Ji G_Lk, G = F^-1; JL as in _tabulate
        (xx, xy), (yx, yy) = inverse
        both = LAME_LAMBDA - factor
        for block, along_x, along_y in ((same_x, xx, yx), (same_y, xy, yy)):
            np.multiply(both, [along_x**2, along_y**2, along_x * along_y], out=self._moduli[:3])
            self._moduli[:2] += SHEAR_MODULUS
            np.matmul(self._same_component, self._moduli[:3].reshape(-1, self._dofs.shape[1]), out=block)
        straight, crossed = xx * yy, xy * yx
        np.multiply(both, [xx * xy, yx * yy], out=self._moduli[:2])
        np.subtract(LAME_LAMBDA * straight, factor * crossed, out=self._moduli[2])
        np.subtract(LAME_LAMBDA * crossed, factor * straight, out=self._moduli[3])
        np.matmul(self._mixed_components, self._moduli.reshape(-1, self._dofs.shape[1]), out=mixed)
        rise = self._contact_values @ np.take(displacement[1], self._contact_dofs)
        traction, stiffness = _adhesion(EQUILIBRIUM_GAP + rise)
        np.matmul(self._contact_products, -stiffness, out=adhesive)
        self._tangent.data = self._gather @ self._local
        bulk, contact = self._internal_forces(F, inverse, factor), -self._weighted_values @ traction
        forces = np.concatenate([bulk.ravel(), contact.ravel()])
        return np.bincount(self._targets, forces, self.unknowns + 1)[:-1].astype(np.float64, copy=False)

    def _kinematics(
        self, displacement: FloatArray, dofs: IntArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return F and F^-1 (2, 2, points, elements) and lambda ln J - mu (points, elements)."""
        F = self._gradient @ np.take(displacement, dofs, axis=1)[:, None]
        F[0, 0] += 1
        F[1, 1] += 1
        J = F[0, 0] * F[1, 1] - F[0, 1] * F[1, 0]
        if not J.min() > 0:
            raise RuntimeError("an element is inverted")
        inverse = np.array([[F[1, 1], -F[0, 1]], [-F[1, 0], F[0, 0]]]) / J
        return F, inverse, LAME_LAMBDA * np.log(J) - SHEAR_MODULUS

    def _internal_forces(self, F: FloatArray, inverse: FloatArray, factor: FloatArray) -> FloatArray:
        """Return the forces (2, basis functions, elements) of P = mu F + (lambda ln J - mu) F^-T."""
        stress = SHEAR_MODULUS * F + factor * inverse.swapaxes(0, 1)
        return np.array([self._weighted_gradient @ row.reshape(-1, row.shape[-1]) for row in stress])

    def _moment(self, state: FloatArray, theta: float) -> float:
        """Return dE/dtheta: the work of the internal forces on the face per turn."""
        forces = self._internal_forces(*self._kinematics(self._displacement(state, theta), self._last_column))
        cosine, sine = np.cos(theta), np.sin(theta)
        turn = np.zeros_like(self._unknown, dtype=np.float64)
        turn[:, self._face] = np.array([[-sine, -cosine], [cosine, -sine]]) @ self._arm
        return float(np.sum(forces * turn[:, self._last_column]))


def _gauss(count: int) -> tuple[FloatArray, FloatArray]:
    points, weights = np.polynomial.legendre.leggauss(count)
    return (points + 1) / 2, weights / 2


def _adhesion(gap: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return T and T' of a flat surface's van der Waals law, extended linearly below the equilibrium gap."""
    gap_used = np.maximum(gap, EQUILIBRIUM_GAP)
    ratio = INTERACTION_DISTANCE / gap_used
    cube = ratio**3
    scale = HAMAKER / (2 * np.pi * INTERACTION_DISTANCE**3)
    stiffness = scale / INTERACTION_DISTANCE * ratio * cube * (1 - cube**2 / 5)
    return scale * cube * (cube**2 / 45 - 1 / 3) + stiffness * (gap - gap_used), stiffness


def _extrapolate(history: Iterable[tuple[float, FloatArray]], theta: float) -> FloatArray:
    """Return the Lagrange polynomial through the converged states, at theta."""
    known = list(history)
    result = np.zeros_like(known[0][1])
    for angle, state in known:
        others = np.array([other for other, _ in known if other != angle])
        result += np.prod((theta - others) / (angle - others)) * state
    return result


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--degree", type=int, default=2)
    parser.add_argument("--mesh", default="200x10", help="elements along x times y")
    parser.add_argument("--to", type=float, default=10.0, help="last angle in degrees")
    parser.add_argument("--step", type=float, default=0.1, help="degrees per load step")
    parser.add_argument("--tolerance", type=float, default=1e-16)
    arguments = parser.parse_args()
    along_x, along_y = (int(number) for number in arguments.mesh.split("x"))
    with threadpool_limits(1):
        strip = ScikitFemStrip(arguments.degree, (along_x, along_y), arguments.tolerance)
        angles = arguments.step * np.arange(1, round(arguments.to / arguments.step) + 1)
        start = time.perf_counter()
        steps = list(strip.trace(angles))
        seconds = time.perf_counter() - start
    iterations = sum(step.iterations for step in steps) / len(steps)
    print(f"M({steps[-1].theta_deg:g}) = {steps[-1].moment:.10f} E0 nm^3")
    milliseconds = 1e3 * seconds / len(steps)
    print(f"{strip.unknowns} unknowns, {iterations:.2f} iterations and {milliseconds:.2f} ms per load step")


if __name__ == "__main__":
    main()
