"""A rigid cylinder pulled off a rigid flat substrate."""

from itertools import pairwise
from math import sqrt

import numpy as np

from isopeel.physics.adhesion import AdhesionLaw
from isopeel.post.law import evaluate_flat, law_character


def rigid_cylinder_pull_off(law: AdhesionLaw, radius: float) -> float:
    """Return the largest pull per length, max over z of 2 int_0^inf -T(z + x^2/(2 R)) dx, of any law.

    It is the limit of stiff bodies, small radii and long-ranged laws, where adhesion deforms nothing: for a
    cylinder the result of Bradley (Phil. Mag. 13, 1932) for spheres. The gap is that of a parabola, so the
    law must act over gaps much smaller than the radius. Where the attraction has one peak, the largest pull
    lies between the equilibrium gap and the gap of that peak: beyond the peak the attraction of every point
    falls, and below the equilibrium gap the attraction near the middle, which dominates, still grows. Raises
    InputError as `law_character`.
    """
    from scipy.integrate import quad
    from scipy.optimize import brentq, minimize_scalar

    character = law_character(law)
    strongest, spent = character.strongest_gap, character.spent_gap

    def traction(gap: float) -> float:
        return float(evaluate_flat(law, np.array([gap]))[1][0])

    # quadrature would miss a narrow rise or fall inside a part: parts end there
    fallen = brentq(lambda gap: traction(gap) + character.strength / 2, strongest, spent, xtol=1e-12 * spent)

    def push(closest: float) -> float:
        ends = (sqrt(2 * radius * (gap - closest)) for gap in (closest, strongest, fallen, spent))
        total = 0.0
        for start, end in pairwise((*ends, np.inf)):
            # the last part is small or zero
            total += quad(
                lambda place: traction(closest + place**2 / (2 * radius)),
                start,
                end,
                epsabs=1e-10 * abs(total),
                epsrel=1e-10,
                limit=200,
            )[0]
        return 2 * total

    bounds = character.equilibrium_gap, strongest
    # at a maximum, the square root of the accuracy is enough
    xatol = 1e-6 * (strongest - character.equilibrium_gap)
    return -float(minimize_scalar(push, bounds=bounds, method="bounded", options={"xatol": xatol}).fun)
