"""Which runs a study has: each is a choice of one value for each factor.

A grid combines all values of all factors. The other designs are samples of the unit cube, of which each
factor takes a coordinate: a Latin hypercube, Sobol's sequence (`scipy.stats.qmc`), and the points of
Saltelli's scheme, from which `scipy.stats.sobol_indices` computes the shares of the variance.
"""

from collections.abc import Mapping, Sequence
from itertools import product
from typing import Literal, TypeAlias

import numpy as np
from scipy.stats import qmc

from isopeel.common.arrays import FloatArray
from isopeel.study.factors import Factor, Value

Method: TypeAlias = Literal["grid", "latin-hypercube", "sobol", "saltelli"]
#: The values of the keys of one run.
Point: TypeAlias = Mapping[str, Value]


def groups_of(factors: Sequence[Factor]) -> list[list[Factor]]:
    """Return the factors that change together, in the order of their first ones."""
    groups: dict[str, list[Factor]] = {}
    for factor in factors:
        groups.setdefault(f"zip {factor.zip}" if factor.zip else f"key {factor.key}", []).append(factor)
    return list(groups.values())


def points_of(factors: Sequence[Factor], method: Method, count: int, seed: int) -> list[Point]:
    """Return the points of a design in the order of the runs; `count` and `seed` are those of samples.

    Saltelli's scheme has count (k + 2) points for k groups of factors: the samples A and B, and for each
    group A with the coordinate of this group from B.
    """
    groups = groups_of(factors)
    if method == "grid":
        rows = [
            [{factor.key: factor.values.values[place] for factor in group} for place in range(_length(group))]
            for group in groups
        ]
        return [_merged(choice) for choice in product(*rows)]
    return [
        _merged([{factor.key: factor.values.at(share) for factor in group} for group, share in pairs])
        for pairs in (
            zip(groups, shares, strict=True) for shares in _shares(len(groups), method, count, seed)
        )
    ]


def _shares(width: int, method: Method, count: int, seed: int) -> list[list[float]]:
    """Return the points (runs, width) of a sample of the unit cube."""
    if method == "latin-hypercube":
        shares: FloatArray = qmc.LatinHypercube(width, rng=seed).random(count)
    elif method == "sobol":
        shares = qmc.Sobol(width, rng=seed).random(count)
    else:
        both = qmc.Sobol(2 * width, rng=seed).random(count)
        one, other = both[:, :width], both[:, width:]
        mixed = []
        for place in range(width):
            changed = one.copy()
            changed[:, place] = other[:, place]
            mixed.append(changed)
        shares = np.concatenate([one, other, *mixed])
    return [[float(share) for share in row] for row in shares]


def _length(group: Sequence[Factor]) -> int:
    return len(group[0].values.values)


def _merged(parts: Sequence[Point]) -> Point:
    return {key: value for part in parts for key, value in part.items()}
