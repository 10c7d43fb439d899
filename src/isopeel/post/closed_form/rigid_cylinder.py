"""A rigid cylinder pulled off a rigid flat substrate."""

from itertools import pairwise
from math import sqrt

import numpy as np

from isopeel.physics.adhesion import AdhesionLaw
from isopeel.post.law import evaluate_flat, law_character


def rigid_cylinder_pull_off(law: AdhesionLaw, radius: float) -> float:
    """Largest pull per length, max over z of 2 int_0^inf -T(z + x^2/(2 R)) dx, of any law of adhesion.

    The limit of stiff bodies, small radii and far-reaching laws, where adhesion bends nothing: for a cylinder
    what Bradley (Phil. Mag. 13, 1932) found for spheres. The gap is that of a parabola, so the law must act
    over gaps much smaller than the radius. Where the attraction has one peak, the largest pull lies between
    the equilibrium gap and the gap of that peak: from the one on the attraction of every point falls, and up
    to the other the points near the middle, which count most, attract ever more. Raises InputError as
    `law_character` does.
    """
    from scipy.integrate import quad
    from scipy.optimize import brentq, minimize_scalar

    character = law_character(law)
    strongest, spent = character.strongest_gap, character.spent_gap

    def traction(gap: float) -> float:
        return float(evaluate_flat(law, np.array([gap]))[1][0])

    # quadrature would step over a rise or a fall that is narrow, unless it lies at the end of a part
    fallen = brentq(lambda gap: traction(gap) + character.strength / 2, strongest, spent, xtol=1e-12 * spent)

    def push(closest: float) -> float:
        ends = (sqrt(2 * radius * (gap - closest)) for gap in (closest, strongest, fallen, spent))
        total = 0.0
        for start, end in pairwise((*ends, np.inf)):
            # the last part is little, or nothing at all
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
    # at a maximum, the root of the wanted accuracy will do
    xatol = 1e-6 * (strongest - character.equilibrium_gap)
    return -float(minimize_scalar(push, bounds=bounds, method="bounded", options={"xatol": xatol}).fun)
