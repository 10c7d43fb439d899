"""The shares of the variance of an output that its factors cause: Sobol's indices by Saltelli's scheme."""

from typing import NamedTuple

import numpy as np
from scipy.stats import bootstrap

from isopeel.common.arrays import FloatArray, IntArray
from isopeel.study.design import groups_of
from isopeel.study.table import Output, StudyResults, output_of

#: The confidence level of the intervals, and the resamples from which they are taken.
CONFIDENCE, _RESAMPLES = 0.95, 999
#: Least number of complete points for intervals.
_FEWEST = 4


class Index(NamedTuple):
    """An index, and the ends of its confidence interval."""

    value: float
    low: float
    high: float


class Share(NamedTuple):
    """The indices of a factor, or of factors that change together: alone, and with all interactions."""

    name: str
    first_order: Index
    total_order: Index


class Shares(NamedTuple):
    """The shares of all factors, and how many points of the sample they are computed from."""

    shares: tuple[Share, ...]
    used_points: int
    all_points: int


def variance_shares(results: StudyResults, output: Output | str) -> Shares | None:
    """Return the indices of all factors; None if the design has no such points, or too few have a value.

    The output is that of a reading, or its name.

    The estimators are those of Saltelli et al. (Comput. Phys. Commun. 181, 2010, table 2, b and f). Their
    errors are of the order of count^-1/2, so that small ones may be negative; the intervals are those of
    percentiles of resampled points. A point is left out if one of its runs has no value.
    """
    study = results.study
    groups = groups_of(study.factors)
    output = output_of(output, results.outcomes) if isinstance(output, str) else output
    if study.method != "saltelli":
        return None
    values = output.values.reshape(len(groups) + 2, study.count)
    values = values[:, np.isfinite(values).all(axis=0)]
    used = values.shape[1]
    if used < _FEWEST or np.ptp(values) == 0:
        return None

    def resampled(points: IntArray, axis: int) -> FloatArray:  # noqa: ARG001 (the last one)
        return _indices(values[:, points])

    found = _indices(values)
    interval = bootstrap(
        (np.arange(used),),
        resampled,
        n_resamples=_RESAMPLES,
        batch=_RESAMPLES,
        vectorized=True,
        axis=-1,
        confidence_level=CONFIDENCE,
        method="percentile",
        rng=np.random.default_rng(study.seed),
    ).confidence_interval
    shares = []
    for number, group in enumerate(groups):
        first, total = (
            Index(*(float(one[order, number]) for one in (found, interval.low, interval.high)))
            for order in (0, 1)
        )
        shares.append(Share(", ".join(factor.key for factor in group), first, total))
    return Shares(tuple(shares), used, study.count)


def _indices(values: FloatArray) -> FloatArray:
    """Return the indices of first and total order (2, groups, ...) of outputs (groups + 2, ..., points)."""
    one, other, mixed = values[0], values[1], values[2:]
    both = np.concatenate([one, other], axis=-1)
    variance = both.var(axis=-1)
    # a constant does not change the indices, but their errors, which are least around the mean
    centred = other - both.mean(axis=-1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):  # a resample may have one value only
        first = (centred * (mixed - one)).mean(axis=-1) / variance
        total = 0.5 * ((one - mixed) ** 2).mean(axis=-1) / variance
    return np.stack([first, total])
