"""Contact with multipliers: the method of augmented Lagrange multipliers, by Uzawa's loop.

A law T(x) that only repels pushes bodies apart where they overlap, x < 0. With multipliers it is evaluated
at x - h: the pressure of the overlap h acts where the surfaces meet. With a stiffness k it is k h:

    T = max(k h - k x, 0),    Phi = (T^2 - (k h)^2)/(2 k)

(Simo and Laursen, Comput. Struct. 42, 1992; Wriggers, Computational Contact Mechanics, Sec. 6.3.3). Between
two updates h is constant, so that there is an energy. After an equilibrium h becomes max(h - x, 0), which
keeps the pressure, until the gap of all points in contact, x < h, is small. The potential is zero at x = 0.
"""

import numpy as np

from isopeel.common.arrays import FloatArray, frozen


def replaced_overlap(opening: FloatArray, before: FloatArray) -> FloatArray:
    """Return the overlaps (n,) that multipliers replace after an equilibrium with openings x (n,)."""
    return frozen(np.maximum(before - opening, 0.0))


def largest_gap(opening: FloatArray, replaced: FloatArray) -> float:
    """Return the largest gap |x| of points in contact; zero where none is."""
    gaps = np.abs(opening[opening < replaced])
    return float(gaps.max()) if gaps.size else 0.0
