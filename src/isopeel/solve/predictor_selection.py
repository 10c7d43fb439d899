"""Compiled: the selection of the predictor with the smallest errors at the last states of a path.

The predictors are polynomials in either path measure, the parameter or the adhesive energy, and the
translation predictor (see `solve.extrapolation`).
"""

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.compilation import compiled, inner, inner_reordered
from isopeel.solve.extrapolation import MOST_STATES, set_weights
from isopeel.solve.period import translation_period

#: The number of last states at which each predictor is judged.
TRIES = 3
_FEWEST_OF_ENERGY = 3
#: States that the polynomial of the rest d passes through, at most.
_MOST_OF_REST = 5
#: A translation predictor is not used where it predicts a growth of the path measure per parameter above this
#: factor times the least one of the last steps. Then a limit point lies ahead, beyond which the path may have
#: jumped a period ago, while it still has an equilibrium here. Steps of L1 at 200 x 10 elements grow by up to
#: 1.8 times the least before a jump, and by 2.6 times at least with one.
_JUMP = 2.5

_BY_PARAMETER, _BY_ENERGY, _TRANSLATION = range(3)


@compiled
def select_predictor(
    parameters: FloatArray,
    ahead: FloatArray,
    energies: FloatArray,
    samples: FloatArray,
    target: float,
) -> tuple[FloatArray, bool]:
    """Return weights (2, n) of the states and of the translated states, whose sum predicts the target.

    The arguments are the parameters (n,) of the accepted states, the newest at the end; the parameters
    `ahead` (n,) of the translated states; the adhesive energies (n,); and samples (n, 2, m) of each state and
    of the translated one, by which states are compared: nan where nothing can be translated. Each polynomial,
    in either path measure and through 1 to MOST_STATES states, and each translation predictor is judged by
    the mean logarithm of its errors at the last states. The second value returned is whether the path measure
    of the selected predictor is the energy.
    """
    n, m = samples.shape[0], samples.shape[2]
    weights, trial, difference = np.zeros((2, n)), np.zeros((2, n)), np.empty(m)
    weights[0, n - 1] = 1.0
    best, best_count, best_kind = np.inf, 1, _BY_PARAMETER
    # the same number for all predictors
    tries = max(1, min(TRIES, n - MOST_STATES))
    for kind in (_BY_PARAMETER, _BY_ENERGY, _TRANSLATION):
        measure = parameters if kind == _BY_PARAMETER else energies
        period = translation_period(measure, samples) if kind == _TRANSLATION else 0.0
        if kind == _TRANSLATION and period == 0.0:
            break
        fewest = _FEWEST_OF_ENERGY if kind == _BY_ENERGY else 1
        most = _MOST_OF_REST if kind == _TRANSLATION else MOST_STATES
        for count in range(fewest, min(n - 1, most) + 1):
            score = 0.0
            for last in range(n - tries, n):
                there = parameters[last]
                if set_weights(measure, parameters, ahead, last, there, count, period, trial) == 0.0:
                    score = np.inf
                    break
                # the logarithm of an exact prediction must be finite
                score += np.log(_missed(samples, trial, last, difference) + 1e-300) / tries
                if score == np.inf:
                    break
            if not score < best:
                continue
            rise = set_weights(measure, parameters, ahead, n, target, count, period, trial)
            if rise == 0.0 or (kind == _TRANSLATION and _jumps(measure, parameters, target, rise)):
                continue
            best, best_count, best_kind = score, count, kind
            _copy(trial, weights)
    # where the polynomial through all earlier states was the best one, one more state may improve it
    if best_count == n - 1 < MOST_STATES and best_kind != _TRANSLATION:
        measure = parameters if best_kind == _BY_PARAMETER else energies
        if set_weights(measure, parameters, ahead, n, target, n, 0.0, trial) != 0.0:
            _copy(trial, weights)
    return weights, best_kind != _BY_PARAMETER


@inner
def _copy(values: FloatArray, to: FloatArray) -> None:
    """Copy weights (2, n). Numba takes seconds to compile the assignment of arrays."""
    for kind in range(2):
        for i in range(values.shape[1]):
            to[kind, i] = values[kind, i]


@inner_reordered
def _missed(samples: FloatArray, weights: FloatArray, n: int, difference: FloatArray) -> float:
    """Return the squared error at state n of the weights of the n states before; set difference (m,)."""
    for j in range(len(difference)):
        difference[j] = samples[n, 0, j]
    for kind in range(2):
        for i in range(n):
            if weights[kind, i] != 0.0:
                for j in range(len(difference)):
                    difference[j] -= weights[kind, i] * samples[i, kind, j]
    total = 0.0
    for j in range(len(difference)):
        total += difference[j] ** 2
    return total


@inner
def _jumps(measure: FloatArray, parameters: FloatArray, target: float, rise: float) -> bool:
    """Return whether the path measure grows much more per parameter to the target than in the last steps."""
    n = len(measure)
    least = np.inf
    for k in range(max(1, n - TRIES), n):
        least = min(least, abs((measure[k] - measure[k - 1]) / (parameters[k] - parameters[k - 1])))
    return not abs(rise / (target - parameters[n - 1])) < _JUMP * least
