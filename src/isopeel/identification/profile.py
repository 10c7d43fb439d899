"""The profile likelihood of one parameter: the least squares of all others at each of its values.

Unlike the standard error it holds for a model that is not linear (Venzon and Moolgavkar, Appl. Statist. 37,
1988): a value is inside the 95 % confidence interval if chi square rises by less than 3.84.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, nan, sqrt

import numpy as np
from scipy.stats import chi2

from isopeel.common.arrays import FloatArray
from isopeel.identification.least_squares import Model, Weights, minimize
from isopeel.identification.parameters import Parameter

#: The rise of chi square of one parameter at the ends of its 95 % interval.
RISE = float(chi2.ppf(0.95, 1))
#: Steps are this part of a standard error, but change a value by half of it at most.
_STEP, _LARGEST_STEP = 0.7, 0.4
#: Most steps in each direction.
_MOST_STEPS = 8


@dataclass(frozen=True, eq=False)
class Profile:
    """The rise of chi square (points,) over the values (points,) of a parameter, in its unit.

    `interval` are the ends of its 95 % interval; -inf or inf if no end was found.
    """

    parameter: Parameter
    values: FloatArray
    rises: FloatArray
    interval: tuple[float, float]


def profile_of(
    number: int,
    model: Model,
    weights: Weights,
    parameters: Sequence[Parameter],
    best: Sequence[float],
    covariance: FloatArray,
    variance: float,
) -> Profile:
    """Walk from the best values in both directions, until chi square has risen enough.

    `covariance` (k, k) is that of the coordinates, and `variance`, that of a residual, scales chi square. The
    other parameters begin each search where linear theory expects them.
    """
    parameter = parameters[number]
    error = sqrt(covariance[number, number])
    step = min(_STEP * error, _LARGEST_STEP) if isfinite(error) else _LARGEST_STEP
    others = [other for other in range(len(parameters)) if other != number]
    slopes = covariance[:, number] / covariance[number, number]
    least = _chi_square(model, weights, best) / variance
    points = {float(best[number]): 0.0}
    for sign in (-1.0, 1.0):
        now, rise = list(best), 0.0
        for _ in range(_MOST_STEPS):
            begin = [
                float(np.clip(one.value(one.coordinate(value) + sign * step * slope), one.lower, one.upper))
                for one, value, slope in zip(parameters, now, slopes, strict=True)
            ]
            if begin[number] == now[number]:
                break  # at its bound
            found = minimize(model, weights, parameters, begin, others)
            if found.cause and not isfinite(found.chi_square):
                break
            now, rise = list(found.values), found.chi_square / variance - least
            points[now[number]] = rise
            if rise > RISE:
                break
    values = np.array(sorted(points))
    rises = np.array([points[value] for value in values])
    return Profile(parameter, values, rises, _interval(parameter, values, rises, float(best[number])))


def _chi_square(model: Model, weights: Weights, values: Sequence[float]) -> float:
    return float(np.sum(weights.residuals(model(values)) ** 2))


def _interval(
    parameter: Parameter, values: FloatArray, rises: FloatArray, best: float
) -> tuple[float, float]:
    """Return where the rise crosses its limit; its root is interpolated, which is linear for a linear"
    " model."""
    coordinates = np.array([parameter.coordinate(value) for value in values])
    signed = np.sign(values - best) * np.sqrt(np.maximum(rises, 0.0))
    limit = sqrt(RISE)
    ends = []
    for sign in (-1.0, 1.0):
        end = nan
        side = sign * signed >= 0
        x, y = coordinates[side], sign * signed[side]
        if y.max() > limit:
            order = np.argsort(y)
            end = parameter.value(float(np.interp(limit, y[order], x[order])))
        ends.append(sign * np.inf if np.isnan(end) else end)
    return ends[0], ends[1]
