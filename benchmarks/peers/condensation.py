"""Condensation of a library's vectors and matrices: the rotated face, and fixed degrees of freedom."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.sparse import csr_matrix

from peers.laws import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Freedoms:
    """The degrees of freedom of a strip, in the numbering of a library."""

    count: int
    fixed: IntArray
    face_x: IntArray  # of the right face's nodes, along x
    face_y: IntArray  # of the same nodes, along y
    arm: FloatArray  # heights of these nodes over the middle of the face

    def turn(self, theta: float) -> tuple[FloatArray, FloatArray]:
        """Return the displacement of the face along x and y, when it is rotated about its fixed centre."""
        return -np.sin(theta) * self.arm, (np.cos(theta) - 1) * self.arm


class Condensation:
    """u = T z + u0(theta), with T of zeros and ones: a residual becomes T^T R, a tangent T^T K T.

    The unknowns z are in the order of the library; the centre of the face comes last, along x and along y.
    Tangents are CSR, whole or a triangle, always with one pattern; each one overwrites the last.
    """

    def __init__(
        self,
        freedoms: Freedoms,
        row_starts: IntArray,
        columns: IntArray,
        part: Literal["lower", "upper", "whole"],
    ) -> None:
        self._freedoms = freedoms
        bound = np.concatenate([freedoms.fixed, freedoms.face_x, freedoms.face_y])
        free = np.setdiff1d(np.arange(freedoms.count), bound)
        n = free.size + 2
        self._unknown = np.full(freedoms.count, n)
        self._unknown[free] = np.arange(free.size)
        self._unknown[freedoms.face_x], self._unknown[freedoms.face_y] = n - 2, n - 1
        self.unknowns = n

        i = self._unknown[np.repeat(np.arange(freedoms.count), np.diff(row_starts))]
        j = self._unknown[columns]
        within = {"lower": j <= i, "upper": i <= j, "whole": np.full(i.shape, True)}[part]
        kept = np.flatnonzero((i < n) & (j < n) & within)
        places, first, position = np.unique(i[kept] * n + j[kept], return_index=True, return_inverse=True)
        # nearly all entries have their own place; only those of the face are summed
        self._alone = kept[first]
        shared = np.setdiff1d(np.arange(kept.size), first)
        self._added, self._added_to = kept[shared], position[shared]
        starts = np.searchsorted(places, n * np.arange(n + 1)).astype(np.int32)
        indices = (places % n).astype(np.int32)
        self.pattern = csr_matrix((np.zeros(places.size), indices, starts), shape=(n, n))

    def displacement(self, state: FloatArray, theta: float) -> FloatArray:
        """Return u (count,) of a state (unknowns + 1,)."""
        u = np.take(state, self._unknown)
        along_x, along_y = self._freedoms.turn(theta)
        u[self._freedoms.face_x] += along_x
        u[self._freedoms.face_y] += along_y
        return u

    def residual(self, forces: FloatArray) -> FloatArray:
        """Return T^T R (unknowns,)."""
        return np.bincount(self._unknown, forces, self.unknowns + 1)[:-1].astype(np.float64, copy=False)

    def tangent(self, entries: FloatArray) -> csr_matrix:
        """Return T^T K T from the entries of K, in the order of its pattern."""
        # with other modes numpy.take uses a buffer
        np.take(entries, self._alone, out=self.pattern.data, mode="clip")
        np.add.at(self.pattern.data, self._added_to, entries[self._added])
        return self.pattern

    def moment(self, forces: FloatArray, theta: float) -> float:
        """Return the work of the internal forces (count,) per rotation of the face."""
        f = self._freedoms
        work = np.cos(theta) * forces[f.face_x] + np.sin(theta) * forces[f.face_y]
        return float(-(f.arm @ work))
