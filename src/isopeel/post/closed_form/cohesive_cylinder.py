"""A cylinder held to an elastic half space by Dugdale's constant attraction: the theory of Maugis in a plane.

It joins the two limits of adhesive line contact: that of a crack where the attraction is strong and short
(`jkr_line_pull_off`), and that of rigid bodies where it is weak and reaches far. Baney and Hui (J. Adhesion
Sci. Technol. 11, 1997) and Johnson and Greenwood (J. Phys. D 41, 2008) give this theory; the equations below
were derived anew, as follows.

The contact is |x| < a; the attraction s acts up to |x| < c, where the gap reaches W/s. In the contact the
slope of a half space under pressure p is that of the cylinder,

    (2/(pi E*)) PV int p(t)/(x - t) dt = x/R  for |x| < a,    p = -s for a < |x| < c.

The attraction is no stronger than s anywhere, so p stays bounded at a, and the solution without a root
singularity there is

    p = E*/(2 R) sqrt(a^2 - x^2) - (2 s/pi) atan sqrt((c^2 - a^2)/(a^2 - x^2))  for |x| < a.

With c = a cosh(w) its integral, and the gap at c, from the same integral of p, are

    F = pi E* a^2/(4 R) - 2 s a sinh(w),
    W/s = a^2/(2 R) (sinh(w) cosh(w) - w) + 4 s a/(pi E*) (w sinh(w) - cosh(w) ln cosh(w)).

All per unit length; `reduced_modulus` and the sign of loads as in `line_contact`.
"""

from dataclasses import dataclass
from math import acosh, pi

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError

_WIDEST = 40.0  # angle w at which the contact is a line to round-off
_ANGLES = 1000


@dataclass(frozen=True)
class CohesiveCylinder:
    """An equilibrium of the cylinder."""

    half_width: float  # a, of the contact
    attracted_half_width: float  # c
    load: float  # per length
    strength: float
    reduced_modulus: float
    radius: float

    def pressure(self, place: FloatArray) -> FloatArray:
        """p at places x (...): -strength between a and c, zero farther out."""
        a, c, x = self.half_width, self.attracted_half_width, np.abs(place)
        root = np.sqrt(np.maximum(a**2 - x**2, 0.0))
        pull = 2 / pi * self.strength * np.arctan2(np.sqrt(c**2 - a**2), root)
        pressure: FloatArray = np.where(x < c, self.reduced_modulus / (2 * self.radius) * root - pull, 0.0)
        return pressure


def maugis_cylinder(
    ratio: float, strength: float, work: float, reduced_modulus: float, radius: float
) -> CohesiveCylinder:
    """Return the equilibrium at the ratio c/a of the attracted width to that of the contact.

    The load falls and rises again with the ratio. Raises InputError unless the ratio is larger than 1 by a
    millionth, short of which digits run out.
    """
    if not 1 + 1e-6 <= ratio < np.inf:
        raise InputError("ratio", ratio, "it must be at least 1 + 1e-6")
    attracted, load = _equilibria(np.array([acosh(ratio)]), strength, work, reduced_modulus, radius)
    c = float(attracted[0])
    return CohesiveCylinder(c / ratio, c, float(load[0]), strength, reduced_modulus, radius)


def maugis_cylinder_pull_off(strength: float, work: float, reduced_modulus: float, radius: float) -> float:
    """Return the largest pull over all ratios c/a, found numerically.

    Cylinders that attract each other without touching pull less: the attracted width falls with the gap.
    """
    from scipy.optimize import minimize_scalar

    constants = strength, work, reduced_modulus, radius
    # where the attraction is strong, the largest pull is that of a crack, at a^3 = 2 W R^2/(pi E*) and the w
    # that the attraction needs for F = -3 pi E* a^2/(4 R); where it is weak, at much larger w
    crack = pi / 2 * reduced_modulus / strength * (2 * work / (pi * reduced_modulus * radius)) ** (1 / 3)
    angles = np.geomspace(0.1 * min(crack, 1.0), _WIDEST, _ANGLES)
    at = int(np.argmin(_equilibria(angles, *constants)[1]))
    bounds = np.log(angles[max(at - 1, 0)]), np.log(angles[min(at + 1, _ANGLES - 1)])
    lowest = minimize_scalar(
        lambda log_w: float(_equilibria(np.exp([log_w]), *constants)[1][0]), bounds=bounds, method="bounded"
    )
    return -float(lowest.fun)


def _equilibria(
    angle: FloatArray, strength: float, work: float, reduced_modulus: float, radius: float
) -> tuple[FloatArray, FloatArray]:
    """Return the half-width c and load at c/a = cosh(angle)."""
    a_over_c, root = 1 / np.cosh(angle), np.tanh(angle)
    # the gap at c as square c^2 + linear c; the logarithm of cosh keeps its digits at small angles
    square = (root - angle * a_over_c**2) / (2 * radius)
    log_cosh = 0.5 * np.log1p(np.sinh(angle) ** 2)
    linear = 4 * strength / (pi * reduced_modulus) * (angle * root - log_cosh)
    critical = work / strength
    c = 2 * critical / (linear + np.sqrt(linear**2 + 4 * square * critical))
    load = pi * reduced_modulus / (4 * radius) * (a_over_c * c) ** 2 - 2 * strength * c * root
    return c, load
