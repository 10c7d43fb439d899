"""The cases that a seed draws."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from trials.case import Drawn, Table, Trial
from trials.dice import Dice
from trials.families import cantilevers, columns, cylinders, double_cantilevers, moments, pads, patches, tapes


@dataclass(frozen=True)
class Family:
    """A family of cases: the function that draws one, and its weight among all."""

    draw: Callable[[Dice], Drawn]
    weight: float
    fine: Table  # a discretization on which the closed form holds within 1 %


_BEAM: Table = {"mesh": "300x3"}
#: The weights are shares in percent: peeling, which most users do, has half of them.
FAMILIES = {
    "tapes": Family(tapes.draw, 22, _BEAM),
    "moments": Family(moments.draw, 16, _BEAM),
    "double cantilevers": Family(double_cantilevers.draw, 12, _BEAM),
    "cylinders": Family(cylinders.draw, 12, {"space": "N2", "mesh": "100x24", "grading": [200.0, 200.0]}),
    "cantilevers": Family(cantilevers.draw, 12, _BEAM),
    "pads": Family(pads.draw, 10, {"mesh": "4x4"}),
    "columns": Family(columns.draw, 6, _BEAM),
    "patches": Family(patches.draw, 10, _BEAM),
}


def trial(seed: int, number: int) -> Trial:
    """Return the case with a number of a seed, which does not depend on the cases before it."""
    random = np.random.default_rng((seed, number))
    weights = np.array([family.weight for family in FAMILIES.values()])
    chosen = list(FAMILIES)[int(random.choice(len(weights), p=weights / weights.sum()))]
    return Trial(seed, number, chosen, FAMILIES[chosen].draw(Dice(random)))


def refined(one: Trial) -> Trial:
    """Return the case on a fine discretization; a half cylinder cannot be graded towards its middle."""
    table = dict(FAMILIES[one.family].fine)
    body = one.drawn.sections["body"]
    assert isinstance(body, Mapping)
    if body.get("shape") == "half-cylinder":
        table |= {"mesh": "300x16", "grading": [1.0, 1.0]}
    sections = {**one.drawn.sections, "discretization": table}
    return replace(one, drawn=replace(one.drawn, sections=sections))
