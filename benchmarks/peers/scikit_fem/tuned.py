"""Assembly tuned by hand: scikit-fem only gives the basis at the quadrature points.

On a uniform mesh all elements share one table of products of basis functions, so that the local matrices are
BLAS products, which users of scikit-fem do not write. They are summed into one fixed pattern.
"""

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix

from peers.laws import (
    EQUILIBRIUM_GAP,
    LAME_LAMBDA,
    SHEAR_MODULUS,
    FloatArray,
    adhesion,
    invert,
    stress,
)
from peers.pardiso import SymmetricSolver
from peers.scikit_fem.program import starter
from peers.scikit_fem.strip import Strip


class TunedAssembly:
    """Residual and tangent of a strip; the next call overwrites the tangent."""

    def __init__(self, strip: Strip) -> None:
        self._unknowns, self._nodes = strip.unknowns, strip.nodes
        gradient = np.array([field.grad[:, 0] for (field,) in strip.bulk.basis])
        weighted = gradient * strip.bulk.dx[0]
        self._gradient = np.ascontiguousarray(gradient.transpose(1, 2, 0))
        self._weighted_gradient = weighted.reshape(len(gradient), -1)
        product = np.einsum("aJq,bLq->abJLq", weighted, gradient)
        xx, yy, xy, yx = (product[:, :, J, L] for J, L in ((0, 0), (1, 1), (0, 1), (1, 0)))
        self._same_component = np.concatenate([xx, yy, xy + yx], axis=-1)[np.triu_indices(len(gradient))]
        self._mixed_components = np.concatenate([xx, yy, xy, yx], axis=-1).reshape(len(gradient) ** 2, -1)
        self._moduli = np.empty((4, *strip.bulk.dx.T.shape))

        lower = len(gradient) // 2  # the functions that do not vanish on the lower face
        values = np.array([field[0] for (field,) in strip.contact.basis[:lower]])
        self._contact_nodes = strip.contact.element_dofs[:lower].astype(np.int64)
        self._contact_values = values.T
        self._weighted_values = values * strip.contact.dx[0]
        self._contact_products = (self._weighted_values[:, None] * values)[np.triu_indices(lower)]
        self._build_pattern(strip)

    def _build_pattern(self, strip: Strip) -> None:
        """Return the pattern of the upper triangle, and the operator that sums local entries into it."""
        n = self._unknowns
        x, y = strip.unknown[:, self._nodes]
        contact = strip.unknown[1, self._contact_nodes]
        self._targets = np.concatenate([x.ravel(), y.ravel(), contact.ravel()])
        upper, every = np.triu_indices(len(x)), np.indices((len(x), len(x))).reshape(2, -1)
        below = np.triu_indices(len(contact))
        blocks = [(x, x, *upper), (y, y, *upper), (x, y, *every), (contact, contact, *below)]
        first = np.concatenate([numbers[a].ravel() for numbers, _, a, _ in blocks])
        second = np.concatenate([numbers[b].ravel() for _, numbers, _, b in blocks])
        distinct = np.concatenate([np.repeat(a != b, numbers.shape[1]) for numbers, _, a, b in blocks])
        # nodes of the face share an unknown: an entry and its mirror image meet on the diagonal
        weights = np.where(distinct & (first == second), 2.0, 1.0)
        kept = np.flatnonzero(np.maximum(first, second) < n)
        rows, columns = np.minimum(first, second)[kept], np.maximum(first, second)[kept]
        places, position = np.unique(rows * n + columns, return_inverse=True)
        shape = (places.size, first.size)
        self._gather = coo_matrix((weights[kept], (position, kept)), shape=shape).tocsr()
        row_starts = np.searchsorted(places, n * np.arange(n + 1))
        self._tangent = csr_matrix((np.zeros(places.size), places % n, row_starts), shape=(n, n))
        self._local = np.empty(first.size)
        shapes = [(len(a), numbers.shape[1]) for numbers, _, a, _ in blocks]
        parts = np.split(self._local, np.cumsum([size * count for size, count in shapes])[:-1])
        self._local_blocks = [part.reshape(shape) for part, shape in zip(parts, shapes, strict=True)]

    def __call__(self, displacement: FloatArray) -> tuple[FloatArray, csr_matrix]:
        F = self._gradient @ np.take(displacement, self._nodes, axis=1)[:, None]
        F[0, 0] += 1
        F[1, 1] += 1
        inverse, factor = invert(F)
        rise = self._contact_values @ np.take(displacement[1], self._contact_nodes)
        traction, stiffness = adhesion(EQUILIBRIUM_GAP + rise)
        self._fill_local_matrices(inverse, factor, stiffness)
        self._tangent.data = self._gather @ self._local
        P = stress(F, inverse, factor)
        bulk = np.array([self._weighted_gradient @ row.reshape(-1, row.shape[-1]) for row in P])
        forces = np.concatenate([bulk.ravel(), -(self._weighted_values @ traction).ravel()])
        residual = np.bincount(self._targets, forces, self._unknowns + 1)[:-1].astype(np.float64, copy=False)
        return residual, self._tangent

    def _fill_local_matrices(self, inverse: FloatArray, factor: FloatArray, stiffness: FloatArray) -> None:
        same_x, same_y, mixed, adhesive = self._local_blocks
        (xx, xy), (yx, yy) = inverse
        both = LAME_LAMBDA - factor
        # problem.moduli, in the order of the tables: xx, yy, xy (and yx)
        for block, along_x, along_y in ((same_x, xx, yx), (same_y, xy, yy)):
            np.multiply(both, [along_x**2, along_y**2, along_x * along_y], out=self._moduli[:3])
            self._moduli[:2] += SHEAR_MODULUS
            np.matmul(self._same_component, self._moduli[:3].reshape(-1, self._nodes.shape[1]), out=block)
        straight, crossed = xx * yy, xy * yx
        np.multiply(both, [xx * xy, yx * yy], out=self._moduli[:2])
        np.subtract(LAME_LAMBDA * straight, factor * crossed, out=self._moduli[2])
        np.subtract(LAME_LAMBDA * crossed, factor * straight, out=self._moduli[3])
        np.matmul(self._mixed_components, self._moduli.reshape(-1, self._nodes.shape[1]), out=mixed)
        np.matmul(self._contact_products, -stiffness, out=adhesive)


start = starter(TunedAssembly, SymmetricSolver)
