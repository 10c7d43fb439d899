"""The nodes and elements of the strip, for libraries that need arrays."""

from dataclasses import dataclass

import numpy as np

from peers.condensation import Freedoms
from peers.laws import ADHERING_LENGTH, HEIGHT, LENGTH, FloatArray, IntArray


@dataclass(frozen=True)
class Grid:
    """Lagrange elements of `degree` along x and linear along y; nodes are numbered column by column."""

    degree: int
    elements: tuple[int, int]

    @property
    def points(self) -> FloatArray:
        """Nodes (count, 2)."""
        x = np.linspace(0, LENGTH, self.degree * self.elements[0] + 1)
        y = np.linspace(0, HEIGHT, self.elements[1] + 1)
        return np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)

    @property
    def cells(self) -> IntArray:
        """Nodes of each element, along x first; elements are numbered column by column."""
        along, across = self.elements
        rows = across + 1
        local = [k * rows + j for j in (0, 1) for k in range(self.degree + 1)]
        first = self.degree * rows * np.arange(along)[:, None] + np.arange(across)
        cells: IntArray = first.reshape(-1, 1) + np.array(local)
        return cells

    @property
    def adhering(self) -> IntArray:
        """Nodes (elements, degree + 1) of the part of the lower face that adheres."""
        count = round(self.elements[0] * ADHERING_LENGTH / LENGTH)
        return self.cells[: count * self.elements[1] : self.elements[1], : self.degree + 1]

    @property
    def last_column(self) -> IntArray:
        """Elements at the right face."""
        along, across = self.elements
        return np.arange((along - 1) * across, along * across)

    def freedoms(self) -> Freedoms:
        """Return the degrees of freedom, those of a node one after the other."""
        rows = self.elements[1] + 1
        count = rows * (self.degree * self.elements[0] + 1)
        left, face = np.arange(rows), np.arange(count - rows, count)
        arm = np.linspace(-HEIGHT / 2, HEIGHT / 2, rows)
        return Freedoms(2 * count, 2 * left, 2 * face, 2 * face + 1, arm)


def gauss(count: int) -> tuple[FloatArray, FloatArray]:
    """Return the Gauss points and weights on [0, 1]."""
    points, weights = np.polynomial.legendre.leggauss(count)
    return (points + 1) / 2, weights / 2
