"""PARDISO as an expert uses it: symmetric, with the analysis of a pattern reused."""

import numpy as np
from pypardiso import PyPardisoSolver
from pypardiso.pardiso_wrapper import PyPardisoError
from scipy.sparse import csr_matrix

from scikit_fem_strip.problem import FloatArray

POSITIVE_DEFINITE, INDEFINITE, NOT_POSITIVE_DEFINITE = 2, -2, -4
ANALYSIS, FACTORIZATION_AND_SOLUTION = 11, 23
# own parameters; minimum degree ordering (the fastest on a strip); pivots: perturbed below 1e-8, 1x1 and 2x2.
# What is absent is 0: above all, no iterative refinement
PARDISO_PARAMETERS = {1: 1, 2: 0, 10: 8, 21: 1}


class SymmetricSolver:
    """Solves with upper triangles: by Cholesky, or LDL^T where that fails; analyses only new patterns."""

    def __init__(self) -> None:
        self._solvers = {kind: PyPardisoSolver(mtype=kind) for kind in (POSITIVE_DEFINITE, INDEFINITE)}
        for solver in self._solvers.values():
            for parameter, value in PARDISO_PARAMETERS.items():
                solver.set_iparm(parameter, value)
        self._pattern: dict[int, csr_matrix] = {}

    def solve(self, matrix: csr_matrix, right_hand_side: FloatArray) -> FloatArray:
        try:
            return self._solve(POSITIVE_DEFINITE, matrix, right_hand_side)
        except PyPardisoError as error:
            if error.value != NOT_POSITIVE_DEFINITE:
                raise
        return self._solve(INDEFINITE, matrix, right_hand_side)

    def _solve(self, kind: int, matrix: csr_matrix, right_hand_side: FloatArray) -> FloatArray:
        # PyPardisoSolver.solve would analyse the pattern each time and refine the solution twice
        solver = self._solvers[kind]
        if not _same_pattern(self._pattern.get(kind), matrix):
            solver.set_phase(ANALYSIS)
            solver._call_pardiso(matrix, np.zeros_like(right_hand_side))
            self._pattern[kind] = matrix
        solver.set_phase(FACTORIZATION_AND_SOLUTION)
        solution: FloatArray = solver._call_pardiso(matrix, right_hand_side)
        return solution


def _same_pattern(known: csr_matrix | None, matrix: csr_matrix) -> bool:
    return known is not None and all(
        np.array_equal(getattr(known, name), getattr(matrix, name)) for name in ("indptr", "indices")
    )
