"""The numbers of a law of adhesion: strength, stiffness, losses, and the gaps at which it acts."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.physics.adhesion import AdhesionLaw, Contact
from isopeel.physics.adhesion.irreversible import SecantUnloading, secant_unloading
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.physics.batch import evaluate_law

#: Range of openings in which the strongest attraction is searched, in the problem's unit of length.
SMALLEST, LARGEST = 1e-6, 1e6
_PER_DECADE = 50
#: The attraction is spent where it has fallen to this share of its peak.
_SPENT = 0.02
#: Places per bisection of an opening, and number of bisections: from neighbours on the grid to round-off.
_PLACES, _ROUNDS = 65, 10


@dataclass(frozen=True)
class LawCharacter:
    """Numbers of a law on a flat substrate, in the units of the problem."""

    equilibrium_gap: float
    work_of_adhesion: float
    strength: float  # largest attraction, a stress
    strongest_gap: float  # where it acts
    stiffness: float  # -T' at the equilibrium gap, a stress per length
    spent_gap: float  # where the attraction has become small
    softened_gap: float  # where the attraction has fallen to half of its strength
    dissipated_energy: float  # up to there, per area, if irreversible; in all it is the work of adhesion
    dissipated_share: float  # of the work done up to there


def evaluate_flat(law: AdhesionLaw, gap: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return potential, traction (repulsion positive) and derivative at gaps (...) to a flat substrate."""
    return evaluate_law(law.kernel, law.parameters, gap, np.zeros_like(gap))


def opened_flat(law: AdhesionLaw, gap: FloatArray) -> SecantUnloading:
    """Return the state of irreversible adhesion on a flat substrate, at largest gaps (...) so far."""
    return secant_unloading(law, gap, np.maximum(gap - law.equilibrium_gap, 0.0))


@dataclass(frozen=True)
class _Response:
    """A law; two are equal where their traction depends on the gap in the same way."""

    law: AdhesionLaw = field(compare=False)
    kernel: object
    numbers: tuple[float, ...]


def law_character(law: AdhesionLaw) -> LawCharacter:
    """Return the numbers of a law. Raises InputError where it attracts at no gap."""
    if isinstance(law.law if isinstance(law, Mirrored) else law, Contact):
        allowed = "it only repels, so that it has no strength and no work of adhesion"
        raise InputError("adhesion", Contact.name, allowed)
    numbers = (law.equilibrium_gap, law.work_of_adhesion, *law.parameters)
    return _character(_Response(law, law.kernel, numbers))


# cached: a run needs them at each of its fronts
@lru_cache(maxsize=8)
def _character(response: _Response) -> LawCharacter:
    law = response.law
    decades = np.log10(LARGEST / SMALLEST)
    opening = np.geomspace(SMALLEST, LARGEST, round(_PER_DECADE * decades) + 1)
    attraction = -evaluate_flat(law, law.equilibrium_gap + opening)[1]
    at = int(np.argmax(attraction))
    if not attraction[at] > 0 or at == 0 or attraction[-1] >= 0.5 * attraction[at]:
        allowed = f"it must attract most at an opening between {SMALLEST:g} and {LARGEST:g}"
        raise InputError("adhesion", type(law).__name__, allowed)

    def attraction_at(openings: FloatArray) -> FloatArray:
        return -evaluate_flat(law, law.equilibrium_gap + openings)[1]

    # the peak lies between the neighbours on the grid
    strongest = _narrowed(opening[at - 1], opening[at + 1], lambda z: int(np.argmax(attraction_at(z))))
    strength = float(attraction_at(np.array([strongest]))[0])

    def last_above(share: float) -> int:
        # the exact peak is above that on the grid
        return at + int(np.flatnonzero(attraction[at:-1] >= share * strength)[-1])

    half = last_above(0.5)
    softened = law.equilibrium_gap + _narrowed(
        opening[half],
        opening[half + 1],
        lambda z: int(np.flatnonzero(attraction_at(z) >= 0.5 * strength)[-1]),
    )
    opened = opened_flat(law, np.array([softened]))
    dissipated, stored = float(opened.dissipated[0]), float(opened.stored[0])
    stiffness = -evaluate_flat(law, np.array([law.equilibrium_gap]))[2][0]
    return LawCharacter(
        law.equilibrium_gap,
        law.work_of_adhesion,
        strength,
        law.equilibrium_gap + strongest,
        float(stiffness),
        law.equilibrium_gap + float(opening[last_above(_SPENT) + 1]),
        softened,
        dissipated,
        dissipated / (dissipated + stored),
    )


def _narrowed(low: float, high: float, nearest: Callable[[FloatArray], int]) -> float:
    """Return an opening between two others, by repeated search for the `nearest` of some places between them.

    To import `scipy.optimize` for this would take longer than all else of a law.
    """
    for _ in range(_ROUNDS):
        places = np.linspace(low, high, _PLACES)
        at = nearest(places)
        low, high = places[max(at - 1, 0)], places[min(at + 1, _PLACES - 1)]
    return float(places[at])
