"""Compiled: the corrections of one step by a chord tangent and L-BFGS updates."""

import numpy as np

from isopeel.assembly.equations import Equations, Iterate, evaluate, place
from isopeel.assembly.loops import Energies
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import compiled_reordered, inner_reordered
from isopeel.matrix.cholesky import Floats
from isopeel.solve.lbfgs import Singles, correct, follow

#: A guess is well predicted where its first correction is below this share of its distance from the last
#: state. For other guesses the tolerance is multiplied by _SHARE: the last correction leaves a tenth of the
#: error, where Newton's method squares it, and the rest appears in reactions unless the slope of the path is
#: known well. At 1e-3 one step of L4 at 200 x 10 elements missed its moment by 1.4e-8 in one run of several;
#: at 3e-4 the moments of L1, L2 and L4 are met to 6e-9.
_WELL_PREDICTED = 3e-4
_SHARE = 1e-3
#: Share of the tolerance that the last correction may leave, estimated from the last two corrections. Where
#: corrections decrease slowly, most of the error is left: a step of L4 whose last two corrections had the
#: ratio 0.4 missed its moment by 1.1e-8.
_LEFT = 0.1
#: A correction is poor if more than this share of the energy residual remains. The second poor correction
#: ends the use of a tangent.
_POOR = 0.5

#: Outcomes of the corrections: converged; two were poor; the forces are not finite, or all were made.
CONVERGED, POOR, FAILED = range(3)


@compiled_reordered
def corrected(
    equations: Equations,
    history: FloatArray,
    moved: FloatArray,
    scalars: FloatArray,
    values: Floats,
    starts: IntArray,
    rows: Singles,
    products: FloatArray,
    first: int,
    end: int,
    at: Iterate,
    last: FloatArray,
    measures: FloatArray,
    made: int,
    threshold: float,
    skip_share: float,
) -> tuple[int, int, int, int, float, Energies]:
    """Correct unknowns until they converge, a second correction is poor, or all corrections have been made.

    The arguments are those of the equations at the parameter (see `evaluate`), the factor, the L-BFGS pairs,
    the unknowns of the last step, and the number `made` of corrections with an earlier tangent, whose energy
    residuals are the first of `measures`. Returns the outcome, the number of corrections, first and end of
    the pairs, the threshold, which the first correction may tighten, and the energies.

    Where the last correction is at most `skip_share` of the threshold, the forces are not evaluated after it:
    energies, forces and residual are those before it.
    """
    y, residual = at.unknown_values, at.residual
    count = len(y)
    correction, change = np.empty(count), np.empty(count)
    energies = (0.0, 0.0, 0.0, 0.0)
    if made == 0:
        energies = evaluate(equations, history, moved, scalars, at)
    poor, before = 0, made
    while made < len(measures):
        correct(values, starts, rows, products, first, end, residual, correction)
        measure = abs(_product(residual, correction)) / count
        if made == 0 and not _is_well_predicted(y, correction, last):
            threshold *= _SHARE
        if not np.isfinite(measure):
            break
        if made > before and not measure < max(_POOR * measures[made - 1], threshold):
            poor += 1
            if poor > 1:
                return POOR, made, first, end, threshold, energies
        measures[made] = measure
        made += 1
        for i in range(count):
            y[i] += correction[i]
            change[i] = -residual[i]
        # after a change of the tangent the first correction starts from forces at another state
        if measure <= skip_share * threshold and (before == 0 or made > before + 1):
            place(equations, y, moved, at.displacement)
            return CONVERGED, made, first, end, threshold, energies
        energies = evaluate(equations, history, moved, scalars, at)
        finite = True
        for i in range(count):
            change[i] += residual[i]
            finite &= np.isfinite(residual[i])
        first, end = follow(rows, products, first, end, correction, change)
        slow = made > before + 1 and measure * measure > _LEFT * threshold * measures[made - 2]
        if measure <= threshold and not slow:
            return (CONVERGED if finite else FAILED), made, first, end, threshold, energies
    return FAILED, made, first, end, threshold, energies


@inner_reordered
def _product(one: FloatArray, other: FloatArray) -> float:
    total = 0.0
    for i in range(len(one)):
        total += one[i] * other[i]
    return total


@inner_reordered
def _is_well_predicted(guess: FloatArray, correction: FloatArray, last: FloatArray) -> bool:
    """Return whether the first correction of a guess (count,) is small against its distance from `last`."""
    largest, distance = 0.0, 0.0
    for i in range(len(guess)):
        largest = max(largest, abs(correction[i]))
        distance = max(distance, abs(guess[i] - last[i]))
    return largest < _WELL_PREDICTED * distance
