"""Find the parameters of a fit, their uncertainty, and what may be wrong with them."""

from collections.abc import Sequence

import numpy as np
from scipy.stats import t

from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.identification.fit_file import Fit
from isopeel.identification.least_squares import Minimum, Weights, minimize, starts_of
from isopeel.identification.model import CurveModel, Evaluation
from isopeel.identification.notes import notes_of
from isopeel.identification.profile import Profile, profile_of
from isopeel.identification.result import FitResult, FittedCurve, FittedParameter
from isopeel.identification.statistics import (
    Uncertainty,
    chi_square_probability,
    runs_test,
    uncertainty,
)

#: A coordinate as close to a bound is at it.
_AT_BOUND = 1e-4


def solve(fit: Fit, model: CurveModel) -> FitResult:
    """Search the least squares from all starts, and return the best with its statistics.

    Raises InputError if no start has a curve.
    """
    weights = Weights.of(fit)
    starts = [minimize(model, weights, fit.parameters, start) for start in starts_of(fit)]
    reached = [one for one in starts if np.isfinite(one.chi_square)]
    if not reached:
        text = ", ".join(
            f"{one.key} = {one.text(value)}"
            for one, value in zip(fit.parameters, fit.start_values(), strict=True)
        )
        raise InputError("start", text, f"the run does not give the measured curve: {starts[0].cause}")
    best = min(reached, key=lambda one: one.chi_square)
    found = model(best.values)
    bounds = [_bound(fit, number, value) for number, value in enumerate(best.values)]
    free = [number for number, bound in enumerate(bounds) if not bound]
    points = len(weights.y)
    freedom = points - len(free)
    variance = 1.0 if weights.is_stated else best.chi_square / max(freedom, 1)
    jacobian = weights.jacobian(found)
    certain = uncertainty(jacobian[:, free], variance)
    profile = _profile(fit, model, weights, best, free, certain, variance)
    alone = uncertainty(jacobian, variance).alone
    parameters = _parameters(fit, best, found, bounds, free, certain, alone)
    chi_square = best.chi_square / variance if variance else 0.0
    curves = _curves(fit, found, weights, free, certain, variance, freedom)
    slopes = np.array([one.slope(value) for one, value in zip(fit.parameters, best.values, strict=True)])
    probability = chi_square_probability(chi_square, freedom) if weights.is_stated else 1.0
    return FitResult(
        fit,
        parameters,
        _whole(certain.covariance * np.outer(slopes[free], slopes[free]), free, len(slopes)),
        _whole(certain.correlation, free, len(slopes)),
        certain.condition,
        chi_square,
        freedom,
        weights.is_stated,
        probability,
        curves,
        tuple(starts),
        profile,
        tuple(notes_of(parameters, certain, free, probability, curves, starts, best, found, profile)),
        model.runs,
        fit.case.with_values(fit.written(best.values)),
    )


def _bound(fit: Fit, number: int, value: float) -> str:
    """Return the bound that a value is at; empty where it is free."""
    parameter = fit.parameters[number]
    here = parameter.coordinate(value)
    for name in ("lower", "upper"):
        if abs(here - parameter.coordinate(getattr(parameter, name))) < _AT_BOUND:
            return name
    return ""


def _profile(
    fit: Fit,
    model: CurveModel,
    weights: Weights,
    best: Minimum,
    free: Sequence[int],
    certain: Uncertainty,
    variance: float,
) -> Profile | None:
    if not fit.profile or not variance:
        return None
    number = [parameter.key for parameter in fit.parameters].index(fit.profile)
    # of a parameter at its bound linear theory knows nothing: the steps are the largest ones
    covariance = np.zeros((len(fit.parameters),) * 2)
    covariance[np.ix_(free, free)] = certain.covariance
    if number not in free:
        covariance[number, number] = 1.0
    return profile_of(number, model, weights, fit.parameters, best.values, covariance, variance)


def _parameters(
    fit: Fit,
    best: Minimum,
    found: Evaluation,
    bounds: Sequence[str],
    free: Sequence[int],
    certain: Uncertainty,
    alone: FloatArray,
) -> tuple[FittedParameter, ...]:
    sizes = np.concatenate([np.full(len(one.y), one.size) for one in fit.data])
    effects = np.abs(found.derivatives / sizes[:, np.newaxis]).max(axis=0)
    fitted = []
    for number, (parameter, value) in enumerate(zip(fit.parameters, best.values, strict=True)):
        slope = abs(parameter.slope(value))
        error = slope * float(certain.errors[free.index(number)]) if number in free else np.nan
        # in percent, of a change by 1 % of the value
        effect = float(effects[number]) * abs(value) / slope
        known = slope * float(alone[number])
        fitted.append(FittedParameter(parameter, value, error, known, effect, bounds[number]))
    return tuple(fitted)


def _curves(
    fit: Fit,
    found: Evaluation,
    weights: Weights,
    free: Sequence[int],
    certain: Uncertainty,
    variance: float,
    freedom: int,
) -> tuple[FittedCurve, ...]:
    spread = np.linalg.norm(found.derivatives[:, free] @ certain.root, axis=1)
    # the quantile of Student's distribution where the noise is estimated
    width = float(t.ppf(0.975, max(freedom, 1) if not weights.is_stated else np.inf))
    ends = np.cumsum([len(one.y) for one in fit.data])[:-1]
    deviations = weights.deviations * np.sqrt(variance)
    parts = (np.split(array, ends) for array in (found.values, width * spread, deviations))
    return tuple(
        FittedCurve(one, one.shown(values), one.shown(band), one.shown(noise), runs_test(one.y - values))
        for one, values, band, noise in zip(fit.data, *parts, strict=True)
    )


def _whole(matrix: FloatArray, free: Sequence[int], count: int) -> FloatArray:
    """Return a matrix of free parameters as one of all, with nan in the others."""
    whole = np.full((count, count), np.nan)
    whole[np.ix_(free, free)] = matrix
    return whole
