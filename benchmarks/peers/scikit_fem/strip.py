"""The strip's mesh, bases and unknowns, which all assemblies share."""

import numpy as np
from skfem import CellBasis, FacetBasis, MeshQuad

from peers.grid import gauss
from peers.laws import ADHERING_LENGTH, HEIGHT, LENGTH, FloatArray, IntArray, invert, stress
from peers.scikit_fem.element import ElementQuadLagrangeByLinear, NumberedDofs


class Strip:
    """Lagrange of `degree` along x, linear along y, on `elements` (along x, along y).

    Nodes are numbered column by column, so the rotated right face comes last. A state has the unknown
    displacements along x, then along y, each with the centre of the face last, then a zero for fixed ones.
    """

    def __init__(self, degree: int, elements: tuple[int, int]) -> None:
        x, y = np.linspace(0, LENGTH, elements[0] + 1), np.linspace(0, HEIGHT, elements[1] + 1)
        mesh = MeshQuad.init_tensor(x, y)
        # init_tensor runs through y first: rotated so that the reference axes are those of the strip
        self._mesh = MeshQuad(mesh.p, mesh.t[[0, 3, 2, 1]])
        self._element = ElementQuadLagrangeByLinear(degree)
        self._adhering = self._mesh.facets_satisfying(lambda x: (x[1] < 1e-9) & (x[0] < ADHERING_LENGTH))

        corner_x, corner_y = self._mesh.p[:, self._mesh.t[0]]
        column, row = np.searchsorted(x, corner_x - 1e-9), np.searchsorted(y, corner_y - 1e-9)
        rows = y.size
        local = [[k * rows + j] for j in (0, 1) for k in range(degree + 1)]
        self.nodes: IntArray = degree * rows * column + row + local
        numbers = np.arange(rows * (degree * elements[0] + 1))
        self.face = numbers[-rows:]
        # one unknown for the whole face: its centre's
        free = np.minimum(numbers, self.face[0])
        along_x, along_y = free - rows, free + free[-1] - rows + 1
        self.unknowns = int(along_y[-1]) + 1
        along_x[:rows] = self.unknowns
        self.unknown: IntArray = np.array([along_x, along_y])
        self._arm = y - HEIGHT / 2

        self.bulk, self.contact = self.bases(numbers, numbers.size)
        self._last_column = CellBasis(
            self._mesh,
            self._element,
            quadrature=self.bulk.quadrature,
            elements=np.flatnonzero(column == column.max()),
            dofs=self.bulk.dofs,
        )

    def bases(self, numbers: IntArray, count: int) -> tuple[CellBasis, FacetBasis]:
        """Return the bases of the bulk and the adhering face for these numbers of nodes, below `count`."""
        dofs = NumberedDofs(self._mesh, self._element, numbers[self.nodes], count)
        (x, weight_x), (y, weight_y) = gauss(self._element.degree + 1), gauss(2)
        points = np.array(np.meshgrid(x, y)).reshape(2, -1), np.outer(weight_y, weight_x).ravel()
        return (
            CellBasis(self._mesh, self._element, quadrature=points, dofs=dofs),
            FacetBasis(
                self._mesh, self._element, quadrature=(x[None], weight_x), facets=self._adhering, dofs=dofs
            ),
        )

    def displacement(self, state: FloatArray, theta: float) -> FloatArray:
        """Return the displacement (2, nodes) of a state whose face is rotated by theta."""
        u: FloatArray = np.take(state, self.unknown)
        u[:, self.face] += np.outer([-np.sin(theta), np.cos(theta) - 1], self._arm)
        return u

    def moment(self, u: FloatArray, theta: float) -> float:
        """Return dE/dtheta: the work of the stresses per rotation of the face."""
        turn = np.zeros_like(u)
        turn[:, self.face] = np.outer([-np.cos(theta), -np.sin(theta)], self._arm)
        F = deformation_gradient(self._last_column, u)
        work = stress(F, *invert(F)) * gradient(self._last_column, turn)
        return float(np.sum(work * self._last_column.dx))


# CellBasis.interpolate does the same as the next two functions, but sorts all degrees of freedom first
def interpolate(basis: FacetBasis, field: FloatArray) -> FloatArray:
    """Return the values (elements, points) of a field (nodes,)."""
    terms = zip(field[basis.element_dofs], basis.basis, strict=True)
    return np.array(sum(local[:, None] * function for local, (function,) in terms))


def gradient(basis: CellBasis, field: FloatArray) -> FloatArray:
    """Return the gradient (2, 2, elements, points) of a field (2, nodes)."""
    terms = zip(field.T[basis.element_dofs], basis.basis, strict=True)
    return np.array(sum(local.T[:, None, :, None] * function.grad for local, (function,) in terms))


def deformation_gradient(basis: CellBasis, u: FloatArray) -> FloatArray:
    """Return F (2, 2, elements, points) of a displacement (2, nodes)."""
    F = gradient(basis, u)
    F[0, 0] += 1
    F[1, 1] += 1
    return F
