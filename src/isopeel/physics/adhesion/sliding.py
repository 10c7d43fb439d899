"""A joint that also holds along the substrate, until it has slid too far.

A law with the potential Phi(r) over the gap becomes, with the slip s along the substrate,

    Phi(r) exp(-s^2/d^2)                              for r >= r_eq,
    Phi(r) - Phi(r_eq) (1 - exp(-s^2/d^2))            in compression, r < r_eq,

with the sliding length d. For the exponential law this is the potential of Xu and Needleman (Model. Simul.
Mater. Sci. Eng. 1, 1993) with q = 1 and r = 0. Whatever the path, parting the surfaces takes the work of
adhesion W; along the substrate the joint has the stiffness 2 W/d^2 and the strength sqrt(2/e) W/d. In
compression slip wears out the hold along the substrate, and leaves the repulsion as it is.

The slip of a point is its displacement along the tangent that the substrate has at its first position. The
gap stays that to the closest point. With fixed pairs (`physics.joints`) it would be measured from the plane
of the first tangent, which a curved substrate leaves: on a cylinder of radius 100 nm, a point in contact that
has slid by 10 nm lies 0.5 nm below this plane, and the equilibrium gap is 0.4 nm.
"""

import numpy as np

from isopeel.common.compilation import inner


@inner
def slipped(
    s: float, d: float, law: tuple[float, float, float], worn: tuple[float, float, float]
) -> tuple[float, float, float, float, float, float]:
    """Return V, -V_r, -V_rr, V_s, V_ss and V_rs at a slip s, for the potential V(r, s) above.

    `law` is Phi, T and T' at the gap r; `worn` is what of them the slip wears out: all, or Phi(r_eq), 0 and 0
    in compression.
    """
    exponent = (s / d) ** 2
    hold = np.exp(-exponent)
    # 1 - exp(-x) with all digits at small slips
    lost = -np.expm1(-exponent)
    well, pull, slope = worn
    rate = 2.0 * s / d**2 * hold
    stiffness = -well * 2.0 / d**2 * hold * (1.0 - 2.0 * exponent)
    potential, traction, derivative = law[0] - well * lost, law[1] - pull * lost, law[2] - slope * lost
    return potential, traction, derivative, -well * rate, stiffness, pull * rate
