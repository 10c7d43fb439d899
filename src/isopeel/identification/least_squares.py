"""Nonlinear least squares with bounds, from one start or several."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.optimize
from scipy.stats import qmc

from isopeel.common.arrays import FloatArray
from isopeel.identification.fit_file import Fit
from isopeel.identification.model import Evaluation
from isopeel.identification.parameters import Parameter

#: The search ends when chi square falls by less than this part of itself: of some hundred points that is far
#: less than one, the change at one standard error.
_COST = 1e-5
#: Or when a step is smaller than this part of the coordinates, which are near one.
_STEP = 1e-8
_MOST_EVALUATIONS = 60

Model = Callable[[Sequence[float]], Evaluation]


@dataclass(frozen=True, eq=False)
class Weights:
    """What makes residuals of one size: the measured values y and their deviations (points,), in SI units.

    If no noise is stated, the deviations are the largest value of each curve: the same share of noise in all.
    """

    y: FloatArray
    deviations: FloatArray
    is_stated: bool

    @classmethod
    def of(cls, fit: Fit) -> "Weights":
        """Return the weights of the points of all data sets, one after the other."""
        stated = fit.data[0].deviations is not None
        deviations = [
            np.full(len(one.y), one.size) if one.deviations is None else one.deviations for one in fit.data
        ]
        return cls(np.concatenate([one.y for one in fit.data]), np.concatenate(deviations), stated)

    def residuals(self, found: Evaluation) -> FloatArray:
        """Return (model - measured) / deviation (points,); infinite if there is no curve."""
        if found.cause:
            return np.full(len(self.y), np.inf)
        return (found.values - self.y) / self.deviations

    def jacobian(self, found: Evaluation) -> FloatArray:
        """Return the derivatives of the residuals (points, parameters) by the coordinates."""
        return found.derivatives / self.deviations[:, np.newaxis]


@dataclass(frozen=True, eq=False)
class Minimum:
    """Where a search ended: `values` of the parameters, in their units, and the sum of squared residuals.

    `cause` says why a search could not begin, or did not converge.
    """

    start: tuple[float, ...]
    values: tuple[float, ...]
    chi_square: float
    evaluations: int
    cause: str = ""


def minimize(
    model: Model,
    weights: Weights,
    parameters: Sequence[Parameter],
    start: Sequence[float],
    free: Sequence[int] | None = None,
) -> Minimum:
    """Search the least squares from a start; only the parameters with the numbers `free` change.

    A trial without a curve has infinite residuals, and the trust region shrinks (scipy's method "trf"). The
    `cause` of the result is that of the run if the start itself has no curve.
    """
    start = tuple(float(value) for value in start)
    free = list(range(len(parameters)) if free is None else free)
    first = model(start)
    if first.cause or not free:
        chi_square = float(np.sum(weights.residuals(first) ** 2))
        return Minimum(start, start, chi_square, 1, first.cause)

    def values(coordinates: FloatArray) -> tuple[float, ...]:
        found = list(start)
        for number, coordinate in zip(free, coordinates, strict=True):
            parameter = parameters[number]
            # the round-off of the coordinate must not cross a bound
            found[number] = float(np.clip(parameter.value(coordinate), parameter.lower, parameter.upper))
        return tuple(found)

    chosen = [parameters[number] for number in free]
    lower = np.array([one.coordinate(one.lower) for one in chosen])
    upper = np.array([one.coordinate(one.upper) for one in chosen])
    result = scipy.optimize.least_squares(
        lambda z: weights.residuals(model(values(z))),
        np.array([one.coordinate(start[number]) for number, one in zip(free, chosen, strict=True)]),
        jac=lambda z: weights.jacobian(model(values(z)))[:, free],
        bounds=(lower, upper),
        # not by the derivatives: a parameter with a small effect would first change by orders of magnitude
        x_scale=1.0,
        ftol=_COST,
        xtol=_STEP,
        gtol=1e-12,
        max_nfev=_MOST_EVALUATIONS,
    )
    cause = "" if result.status > 0 else f"no minimum was found in {_MOST_EVALUATIONS} evaluations"
    return Minimum(start, values(result.x), 2 * float(result.cost), int(result.nfev), cause)


def starts_of(fit: Fit) -> list[tuple[float, ...]]:
    """Return the starts of a fit: the given one, and points of a Latin hypercube between the bounds."""
    starts = [fit.start_values()]
    if fit.starts > 1:
        shares = qmc.LatinHypercube(len(fit.parameters), rng=fit.seed).random(fit.starts - 1)
        starts += [
            tuple(_between(parameter, share) for parameter, share in zip(fit.parameters, row, strict=True))
            for row in shares.tolist()
        ]
    return starts


def _between(parameter: Parameter, share: float) -> float:
    lower, upper = parameter.coordinate(parameter.lower), parameter.coordinate(parameter.upper)
    return parameter.value(lower + (upper - lower) * share)
