"""The element that scikit-fem lacks: Lagrange of any degree along x times linear along y."""

import numpy as np
from numpy.polynomial import Polynomial
from skfem import Dofs, MeshQuad
from skfem.element import Element, ElementH1
from skfem.refdom import RefQuad

from peers.laws import FloatArray, IntArray


class ElementQuadLagrangeByLinear(ElementH1):  # type: ignore[misc]
    """Numbered along x first."""

    refdom = RefQuad

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


class NumberedDofs(Dofs):  # type: ignore[misc]
    """Degrees of freedom by their numbers (functions, elements), below `count`."""

    def __init__(self, mesh: MeshQuad, element: Element, numbers: IntArray, count: int) -> None:
        self.topo, self.element, self.N = mesh, element, count
        self.element_dofs = numbers.astype(np.int32)
