"""Adhesion by an interaction of two powers of the gap."""

from dataclasses import dataclass
from functools import cache
from typing import ClassVar, Self

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.quantities import Length, Number, SurfaceEnergy
from isopeel.physics.batch import ADHESION_SIGNATURE, BatchFunction, compile_batch


@dataclass(frozen=True)
class LennardJones:
    """Traction T(r) = C [(r_eq/r)^m - (r_eq/r)^n], repulsion positive; C from the work of adhesion.

    W = C r_eq (m - n)/((m - 1) (n - 1)). With the exponents 9 and 3, for half spaces of Lennard-Jones
    molecules, C = 8 W/(3 r_eq) (Greenwood, Proc. R. Soc. Lond. A 453, 1997): `VanDerWaals` on a flat
    substrate. The traction is continued by its tangent below the equilibrium gap. The law is that of a flat
    substrate, whatever the curvature of the substrate.

    work_of_adhesion: W, energy per area to part the surfaces; equilibrium_gap: r_eq, a length. Raises
    InputError unless both are positive and m > n > 1.
    """

    name: ClassVar[str] = "lennard-jones"
    work_of_adhesion: SurfaceEnergy
    equilibrium_gap: Length
    repulsive_exponent: Number = 9.0
    attractive_exponent: Number = 3.0

    def __post_init__(self) -> None:
        """Check the constants."""
        for name in ("work_of_adhesion", "equilibrium_gap"):
            if not 0 < getattr(self, name) < np.inf:
                raise InputError(f"adhesion.{name}", getattr(self, name), "it must be positive")
        m, n = self.repulsive_exponent, self.attractive_exponent
        if not 1 < n < np.inf:
            raise InputError("adhesion.attractive_exponent", n, "it must be larger than 1")
        if not n < m < np.inf:
            raise InputError("adhesion.repulsive_exponent", m, "it must be larger than the attractive one")

    @property
    def strength(self) -> float:
        """Largest attraction C (n/m)^(n/(m - n)) (1 - n/m), at (r_eq/r)^(m - n) = n/m."""
        m, n = self.repulsive_exponent, self.attractive_exponent
        return float(self._stress * (n / m) ** (n / (m - n)) * (1 - n / m))

    @classmethod
    def like(cls, _strength: float, work_of_adhesion: float, equilibrium_gap: float) -> Self:
        """The law of this work and gap, which give its strength."""
        return cls(work_of_adhesion, equilibrium_gap)

    @property
    def parameters(self) -> FloatArray:
        """Gap r_eq, stress C, exponents m and n."""
        exponents = self.repulsive_exponent, self.attractive_exponent
        return np.array([self.equilibrium_gap, self._stress, *exponents], dtype=np.float64)

    @property
    def kernel(self) -> BatchFunction:
        """Batch function of potential, traction and its derivative."""
        return _compiled()

    @property
    def _stress(self) -> float:
        m, n = self.repulsive_exponent, self.attractive_exponent
        return self.work_of_adhesion / self.equilibrium_gap * (m - 1) * (n - 1) / (m - n)


@cache
def _compiled() -> BatchFunction:
    return compile_batch(ADHESION_SIGNATURE, _lennard_jones)


def _lennard_jones(
    gap: FloatArray,
    _curvature: FloatArray,
    parameters: FloatArray,
    count: int,
    potential: FloatArray,
    traction: FloatArray,
    derivative: FloatArray,
) -> None:
    r_eq = parameters[0]
    stress = parameters[1]
    m = parameters[2]
    k = parameters[3]
    for n in range(count):
        below = min(gap[n] - r_eq, 0.0)
        r = max(gap[n], r_eq)
        repulsion = stress * (r_eq / r) ** m
        attraction = stress * (r_eq / r) ** k
        dT = (k * attraction - m * repulsion) / r
        # Phi(r) = integral of T from r to infinity
        Phi = r * (repulsion / (m - 1.0) - attraction / (k - 1.0))
        potential[n] = Phi - 0.5 * dT * below * below
        traction[n] = repulsion - attraction + dT * below
        derivative[n] = dT
