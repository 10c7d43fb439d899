"""A joint that also holds along the substrate, until it has slid too far.

A law with the potential Phi(r) over the gap becomes, with the slip s along the substrate,

    Phi(r) exp(-s^2/d^2)                              for r >= r_eq,
    Phi(r) - Phi(r_eq) (1 - exp(-s^2/d^2))            in compression, r < r_eq,

with the sliding length d. For the exponential law this is the potential of Xu and Needleman (Model. Simul.
Mater. Sci. Eng. 1, 1993) with q = 1 and r = 0. Whatever the path, parting the surfaces takes the work of
adhesion W; along the substrate the joint has the stiffness 2 W/d^2 and the strength sqrt(2/e) W/d. In
compression slip wears out the hold along the substrate, and leaves the repulsion as it is.

The slip of a point is its displacement along the tangent that the substrate has at its first position.
"""

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.compilation import compiled


@compiled
def with_slip(
    gap: FloatArray,
    slip: FloatArray,
    sliding_length: float,
    equilibrium_gap: float,
    bottom: FloatArray,
    count: int,
    potential: FloatArray,
    traction: FloatArray,
    derivative: FloatArray,
    shear: FloatArray,
    shear_derivative: FloatArray,
    mixed_derivative: FloatArray,
) -> None:
    """Turn potential Phi, T and T' (count) of a law into V, -V_r and -V_rr at slips (count); write the rest.

    The rest is V_s, V_ss and V_rs (count), for the potential V(r, s) above; `bottom` (count) is Phi(r_eq).
    """
    for n in range(count):
        exponent = (slip[n] / sliding_length) ** 2
        hold = np.exp(-exponent)
        # 1 - exp(-x) keeps its digits at small slips
        lost = -np.expm1(-exponent)
        inside = gap[n] < equilibrium_gap
        well = bottom[n] if inside else potential[n]
        pull = 0.0 if inside else traction[n]
        slope = 0.0 if inside else derivative[n]
        rate = 2.0 * slip[n] / sliding_length**2 * hold
        potential[n] -= well * lost
        traction[n] -= pull * lost
        derivative[n] -= slope * lost
        shear[n] = -well * rate
        shear_derivative[n] = -well * 2.0 / sliding_length**2 * hold * (1.0 - 2.0 * exponent)
        mixed_derivative[n] = pull * rate
