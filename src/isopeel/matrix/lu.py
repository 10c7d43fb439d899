"""The LU factor of a band matrix, with partial pivoting."""

from dataclasses import dataclass

from scipy.linalg.lapack import dgbtrf, dgbtrs

from isopeel.common.arrays import FloatArray, IntArray
from isopeel.matrix.band import BandMatrix
from isopeel.matrix.factor import SingularError


@dataclass(frozen=True, eq=False)
class BandLU:
    """A = P L U with partial pivoting, by LAPACK gbtrf. It overwrites the matrix's entries."""

    entries: FloatArray
    pivots: IntArray
    half_bandwidth: int

    @classmethod
    def of(cls, matrix: BandMatrix) -> "BandLU":
        """Factorize; raises SingularError."""
        b = matrix.half_bandwidth
        entries, pivots, info = dgbtrf(matrix.entries.T, b, b, overwrite_ab=1)
        if info != 0:
            raise SingularError(f"pivot {info} vanishes")
        return cls(entries, pivots, b)

    def solve(self, right_side: FloatArray) -> FloatArray:
        """Solve for a right side (n,)."""
        b = self.half_bandwidth
        solution: FloatArray = dgbtrs(self.entries, b, b, right_side, self.pivots)[0]
        return solution
