"""What a law of adhesion amounts to: strength, stiffness, losses, and the gaps at which it acts."""

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.physics.adhesion import AdhesionLaw
from isopeel.physics.adhesion.irreversible import SecantUnloading, secant_unloading
from isopeel.physics.batch import evaluate_law

#: Openings that the strongest attraction is looked for at, in the problem's unit of length.
SMALLEST, LARGEST = 1e-6, 1e6
_PER_DECADE = 50
#: Where the attraction has fallen to this share of its peak, there is no more to be seen of it.
_SPENT = 0.02


@dataclass(frozen=True)
class LawCharacter:
    """Numbers of a law on a flat substrate, in the units of the problem."""

    equilibrium_gap: float
    work_of_adhesion: float
    strength: float  # largest attraction, a stress
    strongest_gap: float  # where it acts
    stiffness: float  # -T' at the equilibrium gap, a stress per length
    spent_gap: float  # where the attraction has become small
    softened_gap: float  # where it has fallen to half of its strength
    dissipated_energy: float  # by then, per area, of irreversible adhesion; when parted, the work of adhesion
    dissipated_share: float  # of the work of opening it so far


def evaluate_flat(law: AdhesionLaw, gap: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Potential, traction (repulsion positive) and its derivative at gaps (...) to a flat substrate."""
    return evaluate_law(law.kernel, law.parameters, gap, np.zeros_like(gap))


def opened_flat(law: AdhesionLaw, gap: FloatArray) -> SecantUnloading:
    """State of irreversible adhesion at gaps (...) to a flat substrate that are the largest so far."""
    return secant_unloading(law, gap, np.maximum(gap - law.equilibrium_gap, 0.0))


@dataclass(frozen=True)
class _Response:
    """A law, which is another one's equal where it answers to a gap in the same way."""

    law: AdhesionLaw = field(compare=False)
    kernel: object
    numbers: tuple[float, ...]


def law_character(law: AdhesionLaw) -> LawCharacter:
    """Find the numbers of a law. Raises InputError where it attracts at no gap."""
    numbers = (law.equilibrium_gap, law.work_of_adhesion, *law.parameters)
    return _character(_Response(law, law.kernel, numbers))


# a run asks for them at each of its fronts
@lru_cache(maxsize=8)
def _character(response: _Response) -> LawCharacter:
    from scipy.optimize import brentq, minimize_scalar

    law = response.law
    decades = np.log10(LARGEST / SMALLEST)
    opening = np.geomspace(SMALLEST, LARGEST, round(_PER_DECADE * decades) + 1)
    attraction = -evaluate_flat(law, law.equilibrium_gap + opening)[1]
    at = int(np.argmax(attraction))
    if not attraction[at] > 0 or at == 0 or attraction[-1] >= 0.5 * attraction[at]:
        allowed = f"it must attract most at an opening between {SMALLEST:g} and {LARGEST:g}"
        raise InputError("adhesion", type(law).__name__, allowed)

    def repulsion(logarithm: float) -> float:
        gap = np.array([law.equilibrium_gap + np.exp(logarithm)])
        return float(evaluate_flat(law, gap)[1][0])

    # the grid's neighbours hold the peak between them
    bounds = np.log(opening[at - 1]), np.log(opening[at + 1])
    peak = minimize_scalar(repulsion, bounds=bounds, method="bounded", options={"xatol": 1e-9})

    def last_above(share: float) -> int:
        # of the peak itself, which is above that on the grid
        return at + int(np.flatnonzero(attraction[at:-1] >= -share * peak.fun)[-1])

    half = last_above(0.5)
    softened = law.equilibrium_gap + np.exp(
        brentq(lambda z: repulsion(z) - 0.5 * peak.fun, *np.log(opening[half : half + 2]), xtol=1e-13)
    )
    opened = opened_flat(law, np.array([softened]))
    dissipated, stored = float(opened.dissipated[0]), float(opened.stored[0])
    stiffness = -evaluate_flat(law, np.array([law.equilibrium_gap]))[2][0]
    return LawCharacter(
        law.equilibrium_gap,
        law.work_of_adhesion,
        float(-peak.fun),
        law.equilibrium_gap + float(np.exp(peak.x)),
        float(stiffness),
        law.equilibrium_gap + float(opening[last_above(_SPENT) + 1]),
        float(softened),
        dissipated,
        dissipated / (dissipated + stored),
    )
