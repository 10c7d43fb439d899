"""A finer row-wise space, and a field in it. They serve to estimate a discretization error."""

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.splines.refinement import insert_knots
from isopeel.splines.rows import RowSpace
from isopeel.splines.space import SplineSpace

#: Most elements along eta for which the degree along eta is raised. More elements resolve the height already;
#: without the raised degree the start is exact, which saves most corrections.
_FEW = 4
#: Number of lowest elements along eta that are quartered where they are tall, as stresses decay away from the
#: contact. Pull-off forces with errors of 3.5 and 4 % then change by 3.9 and 4.6 % (cases 188 and 124 of
#: `benchmarks/trial.py`).
_LOWEST = 3


def finer(space: RowSpace, *, tall: bool = False) -> RowSpace:
    """Return the space with each element halved along xi; with few elements, the degree along eta is raised.

    Where the elements are `tall`, higher than they are long, the lowest elements are quartered along eta
    instead. Lines of reduced continuity keep their continuity; new knots have the highest continuity of their
    row. The first rows, those of the contact, keep their functions. The space has no weights: `weighted` adds
    them.
    """
    across = space.across
    halved = {row: _halved(row) for row in dict.fromkeys(space.rows)}
    if tall:
        lowest = across.breakpoints[: _LOWEST + 1]
        quarters = lowest[:-1, None] + np.diff(lowest)[:, None] * np.arange(1, 4) / 4
        higher = insert_knots(across, np.zeros(across.size), quarters.ravel())[0]
        below = np.searchsorted(across.greville, higher.greville, side="right") - 1
        return RowSpace(space.name, higher, tuple(halved[space.rows[j]] for j in below))
    if across.elements > _FEW:
        return RowSpace(space.name, across, tuple(halved[row] for row in space.rows))
    # knots of the highest continuity stay simple, the others keep their continuity
    repeats = np.where(across.multiplicities == 1, 1, across.multiplicities + 1)
    higher = SplineSpace(across.degree + 1, np.repeat(across.breakpoints, repeats))
    # each new row has the space of the nearest row at or below it, towards the contact
    below = np.searchsorted(across.greville, higher.greville, side="right") - 1
    rows = tuple(halved[space.rows[j]] for j in below)
    return RowSpace(space.name, higher, rows)


def transferred(space: RowSpace, coefficients: FloatArray, other: RowSpace) -> FloatArray:
    """Return the coefficients (other size, c) of the field that equals the given one at Greville points.

    The given field has coefficients (size, c) in `space`.
    """
    parts = np.split(coefficients, space.offsets[1:-1])
    weights = space.weights or tuple(np.ones(row.size) for row in space.rows)

    def field(xi: FloatArray, eta: FloatArray) -> FloatArray:
        # the points are a grid: each coordinate occurs many times
        (x, along), (y, upwards) = (np.unique(places, return_inverse=True) for places in (xi, eta))
        curves = [
            row.collocation(x) @ np.column_stack([w[:, None] * part, w])
            for row, part, w in zip(space.rows, parts, weights, strict=True)
        ]
        total = np.einsum("yj,jxc->xyc", space.across.collocation(y).toarray(), np.stack(curves))
        values: FloatArray = (total[..., :-1] / total[..., -1:])[along, upwards]
        return values

    return other.interpolate(field)


def _halved(row: SplineSpace) -> SplineSpace:
    middles = (row.breakpoints[1:] + row.breakpoints[:-1]) / 2
    usual = 1 if row.elements == 1 else int(row.multiplicities[1:-1].min())
    return insert_knots(row, np.zeros(row.size), np.repeat(middles, usual))[0]
