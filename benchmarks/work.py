"""The work of the parts of a load step, from the sizes of its arrays: operations, and bytes.

Additions, multiplications and divisions of sum factorization count one each. Bytes are those of all tables
and results, each moved once, without intermediate values. Names of sizes are those of
`isopeel.assembly.body_kernel`.
"""

from typing import NamedTuple

import numpy as np

from isopeel.assembly.system import System
from isopeel.assembly.tables import BodyTable, SideTable
from isopeel.common.arrays import FloatArray, IntArray

# neo-Hooke at a point: det F, its logarithm, energy and P; F^-1, and the ten moduli that differ by symmetry
_STRESS, _MODULI = 3 + 32 + 17 + 13, 5 + 10 * 6
# van der Waals at a point above a flat substrate, including the powers of its gap
_LAW = 60


class Work(NamedTuple):
    """The least number of operations and of moved bytes."""

    flops: float
    moved: float  # bytes

    def __add__(self, other: "Work") -> "Work":  # type: ignore[override]
        return Work(self.flops + other.flops, self.moved + other.moved)


def forces(system: System) -> Work:
    """Return the work of `System.equilibrium`."""
    return Work(
        body_forces(system.body) + side_forces(system.adhesive),
        _tables(system) + 2 * 8 * 2 * system.space.size,  # u and forces
    )


def tangent(system: System) -> Work:
    """Return the work of `System.linearize`, which includes the forces; the band is written once."""
    body, side, b = system.body, system.adhesive, system.half_bandwidth
    unknowns = 8 * 2 * (body.first.size * body.along.shape[3] + side.functions.size)
    more = Work(body_tangent(body) + side_tangent(side), unknowns + 8 * system.constraints.count * (b + 1))
    return forces(system) + more


def below(columns: FloatArray) -> IntArray:
    """Return the number of entries of the factor below the diagonal, by column, for a lower band (n, b + 1).

    A column reaches at least as far as the columns before it, because they are subtracted from it.
    """
    n, width = columns.shape
    places = np.where(columns != 0, np.arange(width), 0).max(axis=1)
    reach: IntArray = np.maximum.accumulate(np.arange(n) + places) - np.arange(n)
    return reach


def factorization(below: IntArray) -> Work:
    """Return the work to factor a band: per column j, a division and m (m + 1)/2 subtracted products.

    It is read in double precision and stored in single precision, as far as its columns reach.
    """
    entries = float((below + 1).sum())
    return Work(float(((below + 1) ** 2).sum()), (8 + 4) * entries)


def solution(below: IntArray) -> Work:
    """Return the work of a solution: the factor, in single precision, is read forwards and backwards."""
    return Work(float((4 * below + 2).sum()), 2 * 4 * float((below + 1).sum()))


def update(n: int, pairs: int) -> Work:
    """Return the work of the L-BFGS update of a solution, in single precision.

    Both loops have a product and a sum of vectors for each pair.
    """
    return Work(2 * 2 * 2 * n * pairs, 2 * 2 * 4 * n * pairs)


def body_forces(table: BodyTable) -> int:
    """Return the number of operations of the body's forces and energy."""
    P, X, C, channels, points = _sizes(table)
    # u -> values and derivatives on lines, and back: 2 orders, 2 components
    lines = 2 * 2 * 2 * P * X * int(table.sizes[table.kinds].sum())
    # lines -> channels, and back; and the energy times the area
    channel, energy = 2 * channels * C * 2, 2
    # channels -> F, and back with the area: for rectangles they are equal but for a factor, applied to the
    # lines
    gradient = 2 * 2 * (2 * channels * 2) + 4
    others = points - _points_of_rectangles(table)
    return 2 * lines + points * (2 * channel + _STRESS + energy) + others * gradient


def body_tangent(table: BodyTable) -> int:
    """Return the number of operations of the body's tangent, without those of its forces."""
    P, X, C, channels, points = _sizes(table)
    h = 2 * channels
    # moduli -> half with the weights -> pairs of channels, of which symmetric ones count once; for rectangles
    # they are the moduli but for a factor
    pulled = h * 4 * (4 + 1) + h * (h + 1) // 2 * 4
    # -> pairs of rows; for a row with itself, three of the four pairs of components
    paired = channels**2 * (4 * C * (C - 1) // 2 + 3 * C) * 2
    others = points - _points_of_rectangles(table)
    return points * (_MODULI + paired) + others * pulled + X * _spread(table, P, C)


def side_forces(side: SideTable) -> int:
    """Return the number of operations of the adhesive force on the reference area."""
    m = int(side.functions.shape[1])
    return side.weights.size * (2 * 2 * m + _LAW + 2 * (2 * m + 2))


def side_tangent(side: SideTable) -> int:
    """Return the number of operations of its tangent: n n dT at a point, for each pair of functions."""
    m = int(side.functions.shape[1])
    return side.weights.size * (6 + m + 4 * m * m * 2)


def _spread(table: BodyTable, P: int, C: int) -> int:
    """Return the number of operations, per element along xi, from pairs of rows to entries of the tangent."""
    sizes = table.sizes[table.kinds]
    total = 0
    for j, size in enumerate(sizes):
        for d in range(min(C, len(sizes) - j)):
            other = sizes[j + d]
            flux, entry = P * 2 * 4, P * 4 + 1  # each entry is added to the band
            if d:
                total += 4 * (other * flux + other * size * entry)
            else:
                # for equal components, the entries below the diagonal follow from the symmetry
                total += 3 * size * flux + (2 * (size * (size + 1) // 2) + size * size) * entry
    return int(total)


def _sizes(table: BodyTable) -> tuple[int, int, int, int, int]:
    P, X = table.along.shape[2], table.along.shape[4]
    C, channels = table.across.shape[3], table.maps.shape[2]
    return P, X, C, channels, table.weight_kinds.size * P * X


def _points_of_rectangles(table: BodyTable) -> int:
    P, X, _, _, _ = _sizes(table)
    return int(table.rectangles.sum()) * P * X


def _tables(system: System) -> int:
    body, side = system.body, system.adhesive
    of_body = (body.along, body.first, body.across, body.maps, body.weights)
    of_side = (side.functions, side.values, side.weights, side.positions)
    return sum(array.nbytes for array in (*of_body, *of_side))
