"""Which cases a seed draws."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from trials.case import Drawn, Trial
from trials.dice import Dice
from trials.families import cantilevers, columns, cylinders, double_cantilevers, moments, pads, patches, tapes


@dataclass(frozen=True)
class Family:
    """A family of cases: how one is drawn, and its weight among all."""

    draw: Callable[[Dice], Drawn]
    weight: float


#: The weights are shares in percent: peeling, which most users do, has half of them.
FAMILIES = {
    "tapes": Family(tapes.draw, 22),
    "moments": Family(moments.draw, 16),
    "double cantilevers": Family(double_cantilevers.draw, 12),
    "cylinders": Family(cylinders.draw, 12),
    "cantilevers": Family(cantilevers.draw, 12),
    "pads": Family(pads.draw, 10),
    "columns": Family(columns.draw, 6),
    "patches": Family(patches.draw, 10),
}


def trial(seed: int, number: int) -> Trial:
    """Case `number` of a seed, which the cases before it take no part in."""
    random = np.random.default_rng((seed, number))
    weights = np.array([family.weight for family in FAMILIES.values()])
    chosen = list(FAMILIES)[int(random.choice(len(weights), p=weights / weights.sum()))]
    return Trial(seed, number, chosen, FAMILIES[chosen].draw(Dice(random)))
