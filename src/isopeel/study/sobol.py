"""The shares of the variance of an output that its factors cause: Sobol's indices by Saltelli's scheme."""

from typing import NamedTuple

import numpy as np
from scipy.stats import sobol_indices

from isopeel.study.design import groups_of
from isopeel.study.table import Output, StudyResults


class Share(NamedTuple):
    """The indices of a factor, or of factors that change together: alone, and with all interactions."""

    name: str
    first_order: float
    total_order: float


def variance_shares(results: StudyResults, output: Output) -> list[Share]:
    """Return the indices of all factors; none if the design has no such points, or a run has no value.

    The estimators are those of Saltelli et al. (Comput. Phys. Commun. 181, 2010), by SciPy. Their errors are
    of the order of count^-1/2, so that small ones may be negative.
    """
    study = results.study
    if study.method != "saltelli" or not np.isfinite(output.values).all() or np.ptp(output.values) == 0:
        return []
    groups = groups_of(study.factors)
    one, other, *mixed = np.split(output.values, len(groups) + 2)
    given = {"f_A": one[None], "f_B": other[None], "f_AB": np.stack(mixed)[:, None]}
    found = sobol_indices(func=given, n=study.count)
    return [
        Share(", ".join(factor.key for factor in group), float(first), float(total))
        for group, first, total in zip(
            groups, np.ravel(found.first_order), np.ravel(found.total_order), strict=True
        )
    ]
