"""What may be wrong with a fit, in words."""

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np

from isopeel.identification.least_squares import Minimum
from isopeel.identification.model import Evaluation
from isopeel.identification.profile import Profile
from isopeel.identification.result import FittedCurve, FittedParameter
from isopeel.identification.statistics import Uncertainty
from isopeel.report.wording import listed

#: A parameter with a larger standard error, as a part of its value, is not identified: zero and twice the
#: value are inside its 95 % interval.
_NOT_IDENTIFIED = 0.5
#: Nor is one with a smaller effect: then an error of 1 % of the sensor or of the mesh, which is no noise, is
#: enough to change it by half of its value.
_LEAST_EFFECT = 0.02
#: Parameters whose correlation is closer to one are badly separated.
_TOGETHER = 0.99
#: Parameters with a larger correlation are named beside one that is not identified.
_RELATED = 0.9
#: Probability below which noise is no explanation.
_IMPROBABLE = 0.01
#: Minima of other starts whose chi square is larger by this part of it are others.
_SAME_MINIMUM = 1e-3
#: Largest error of the interpolation, as a part of the noise, that does not matter.
_INTERPOLATION = 0.3


def notes_of(
    parameters: Sequence[FittedParameter],
    certain: Uncertainty,
    free: Sequence[int],
    probability: float,
    curves: Sequence[FittedCurve],
    starts: Sequence[Minimum],
    best: Minimum,
    found: Evaluation,
    profile: Profile | None,
) -> Iterator[str]:
    """Yield a sentence on each doubt."""
    yield from _search_notes(parameters, starts, best)
    yield from _identification_notes(parameters, certain, free)
    if probability < _IMPROBABLE:
        yield (
            "The residuals are larger than the stated noise: the model does not describe the curve, or the"
            " noise is larger. The standard errors are too small."
        )
    elif probability > 1 - _IMPROBABLE / 10 and probability < 1.0:
        yield "The residuals are smaller than the stated noise, which seems to be too large."
    for curve in curves:
        if curve.runs is not None and curve.runs.probability < _IMPROBABLE:
            yield (
                f"The residuals of {curve.data.name} do not look like noise: they have {curve.runs.runs} runs"
                f" of one sign, and noise has about {curve.runs.expected:.0f}. The model does not"
                " describe the"
                " curve in all details, and the standard errors are too small."
            )
    noise = np.concatenate([curve.deviations / curve.data.shown(np.ones(1)) for curve in curves])
    worst = float(np.max(found.interpolation / np.maximum(noise, np.finfo(float).tiny)))
    if noise.any() and worst > _INTERPOLATION:
        yield (
            "Between its steps the computed curve is interpolated linearly; the error of this is up to"
            f" {worst:.1g} of the noise. Shorter steps (drive.step) reduce it."
        )
    if profile is not None and not np.isfinite(profile.interval).all():
        lower, upper = np.isfinite(profile.interval)
        which = "neither end" if not (lower or upper) else "no upper end" if lower else "no lower end"
        yield (
            f"The profile of `{profile.parameter.key}` has {which} of a 95 % interval between"
            f" {profile.parameter.text(float(profile.values[0]), 4)} and"
            f" {profile.parameter.text(float(profile.values[-1]), 4)}."
        )


def _search_notes(
    parameters: Sequence[FittedParameter], starts: Sequence[Minimum], best: Minimum
) -> Iterator[str]:
    if best.cause:
        yield f"The search did not converge: {best.cause}."
    failed = [one for one in starts if not np.isfinite(one.chi_square)]
    if failed:
        yield f"{len(failed)} of {len(starts)} starts have no curve: {failed[0].cause}."
    others = [
        one
        for one in starts
        if np.isfinite(one.chi_square) and one.chi_square > (1 + _SAME_MINIMUM) * best.chi_square
    ]
    if others:
        yield f"{len(others)} of {len(starts)} starts ended at a larger sum of squares; the best is reported."
    for one in parameters:
        if one.bound:
            limit = one.parameter.text(getattr(one.parameter, one.bound))
            yield (
                f"`{one.key}` is at its {one.bound} bound, {limit}. It has no standard error, and the"
                " errors of"
                " the other parameters are those at this value."
            ) + (_weak(one) if _alone(one) > _NOT_IDENTIFIED else "")


def _identification_notes(
    parameters: Sequence[FittedParameter], certain: Uncertainty, free: Sequence[int]
) -> Iterator[str]:
    correlation = certain.correlation
    for place, number in enumerate(free):
        one = parameters[number]
        if one.effect < _LEAST_EFFECT and one.relative_error <= _NOT_IDENTIFIED:
            yield (
                f"`{one.key}` cannot be identified from these curves: an error of 1 % of the sensor or of the"
                f" model changes it by {1 / max(one.effect, 1e-3):.0f} % or more.{_weak(one)}"
            )
        if not one.relative_error > _NOT_IDENTIFIED:
            continue
        size = 100 * one.relative_error
        error = f"{size:.0f} % of its value" if size < 1e4 else "far larger than its value"
        start = f"`{one.key}` cannot be identified from these curves: its standard error is {error}"
        alone = _alone(one)
        if alone > _NOT_IDENTIFIED:
            yield f"{start}.{_weak(one)}"
            continue
        partners = [
            f"`{parameters[free[other]].key}` ({correlation[place, other]:+.4f})"
            for other in np.argsort(-np.abs(correlation[place]))
            if other != place and abs(correlation[place, other]) > _RELATED
        ]
        beside = f" Its correlation is large with {listed(partners)}." if partners else ""
        yield (
            f"{start}, and {100 * alone:.2g} % if all other parameters were known. The curves determine"
            " only a"
            f" combination of parameters.{beside}"
        )
    for first, second in combinations(range(len(free)), 2):
        one, other = parameters[free[first]], parameters[free[second]]
        identified = max(one.relative_error, other.relative_error) <= _NOT_IDENTIFIED
        if identified and abs(correlation[first, second]) > _TOGETHER:
            yield (
                f"`{one.key}` and `{other.key}` have a correlation of {correlation[first, second]:+.4f}: the"
                " curves separate them badly, so that the errors of both are large."
            )


def _alone(one: FittedParameter) -> float:
    """Return the relative standard error if all other parameters were known."""
    return one.alone / abs(one.value or 1.0)


def _weak(one: FittedParameter) -> str:
    return (
        " The curves hardly depend on it: if it changes by 1 %, they change by at most"
        f" {one.effect:.1g} % of their largest value."
    )
