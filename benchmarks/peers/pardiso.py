"""PARDISO as an expert uses it: symmetric, with one analysis of the pattern."""

import numpy as np
from pypardiso import PyPardisoSolver
from pypardiso.pardiso_wrapper import PyPardisoError
from scipy.sparse import csr_matrix

from peers.laws import FloatArray

POSITIVE_DEFINITE, INDEFINITE, NOT_POSITIVE_DEFINITE = 2, -2, -4
ANALYSIS, FACTORIZATION_AND_SOLUTION = 11, 23
# own parameters; minimum degree ordering (the fastest on a strip); pivots: perturbed below 1e-8, 1x1 and 2x2.
# All others are 0: above all, there is no iterative refinement
PARDISO_PARAMETERS = {1: 1, 2: 0, 10: 8, 21: 1}


class SymmetricSolver:
    """A solver for matrices of one pattern, given as upper triangles: Cholesky, or LDL^T if that fails."""

    def __init__(self) -> None:
        self._solvers: dict[int, PyPardisoSolver] = {}

    def __call__(self, matrix: csr_matrix, right_hand_side: FloatArray) -> FloatArray:
        if not self._solvers:
            self._solvers = {kind: _analyse(kind, matrix) for kind in (POSITIVE_DEFINITE, INDEFINITE)}
        try:
            return self._solve(POSITIVE_DEFINITE, matrix, right_hand_side)
        except PyPardisoError as error:
            if error.value != NOT_POSITIVE_DEFINITE:
                raise
        return self._solve(INDEFINITE, matrix, right_hand_side)

    def _solve(self, kind: int, matrix: csr_matrix, right_hand_side: FloatArray) -> FloatArray:
        # PyPardisoSolver.solve would analyse the pattern each time and refine the solution twice
        solution: FloatArray = self._solvers[kind]._call_pardiso(matrix, right_hand_side)
        return solution


def _analyse(kind: int, pattern: csr_matrix) -> PyPardisoSolver:
    solver = PyPardisoSolver(mtype=kind)
    for parameter, value in PARDISO_PARAMETERS.items():
        solver.set_iparm(parameter, value)
    solver.set_phase(ANALYSIS)
    solver._call_pardiso(pattern, np.zeros(pattern.shape[0]))
    solver.set_phase(FACTORIZATION_AND_SOLUTION)
    return solver
