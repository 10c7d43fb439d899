"""Compiled: the tangent of the body, from the moduli at its points to the entries of the band.

Names are those of `isopeel.assembly.body_kernel`. There are two steps. First the moduli of all points of a
row of elements are summed across, for each pair of rows of functions. Then each pair of rows is integrated
along.
"""

from typing import Any

from isopeel.assembly.element_batch import (
    add_products,
    add_scaled,
    set_products,
    set_weighted_products,
)
from isopeel.common.compilation import inlined, inner_reordered
from isopeel.matrix.band import entry_place


@inner_reordered
def pull_back(A: Any, maps: Any, weights: Any, start: int, n: int, half: Any, moduli: Any) -> None:
    """Set moduli of channels, their lower half: w sum_JL maps_hJ A_iJkL maps_gL at [2 h + i, 2 g + k]."""
    P, channels = maps.shape[0], maps.shape[1]
    batch = slice(start, start + n)
    for p in range(P):
        here = slice(p * n, (p + 1) * n)
        for g in range(channels):
            for k in range(2):
                for i in range(2):
                    for J in range(2):
                        set_weighted_products(
                            half[i, J],
                            weights[p, batch],
                            A[p, i, J, k, 0],
                            maps[p, g, 0, batch],
                            A[p, i, J, k, 1],
                            maps[p, g, 1, batch],
                            n,
                        )
                for h in range(channels):
                    for i in range(2):
                        # the other half follows from the symmetry
                        if 2 * h + i >= 2 * g + k:
                            set_products(
                                moduli[2 * h + i, 2 * g + k, here],
                                0.0,
                                half[i, 0],
                                maps[p, h, 0, batch],
                                half[i, 1],
                                maps[p, h, 1, batch],
                                n,
                            )


@inner_reordered
def add_to_pairs(pairs: Any, moduli: Any, across: Any, r: int, row: int, channels: int, n: int) -> None:
    """Add a row of points to the pairs of rows row + c and row + c + d, pairs[., d, orders, i, k]."""
    C = across.shape[2]
    P = pairs.shape[6]
    for c in range(C):
        for d in range(C - c):
            for h in range(channels):
                for g in range(channels):
                    factor = across[1 if h == 1 else 0, r, c] * across[1 if g == 1 else 0, r, c + d]
                    for i in range(2):
                        for k in range(2):
                            if d == 0 and i > k:
                                continue
                            one, other = max(2 * h + i, 2 * g + k), min(2 * h + i, 2 * g + k)
                            pair = pairs[(row + c) % C, d, 1 if h == 0 else 0, 1 if g == 0 else 0, i, k]
                            for p in range(P):
                                add_scaled(pair[p], factor, moduli[one, other, p * n : (p + 1) * n], n)


@inner_reordered
def add_rectangles_to_pairs(
    pairs: Any, A: Any, maps: Any, weights: Any, across: Any, r: int, row: int, n: int
) -> None:
    """Do the same for equal rectangles, directly from the moduli A."""
    C, P = across.shape[2], maps.shape[0]
    for c in range(C):
        for d in range(C - c):
            for h in range(2):
                for g in range(2):
                    factor = across[h, r, c] * across[g, r, c + d]
                    for i in range(2):
                        for k in range(2):
                            if d == 0 and i > k:
                                continue
                            pair = pairs[(row + c) % C, d, 1 - h, 1 - g, i, k]
                            for p in range(P):
                                scale = factor * weights[p, 0] * maps[p, h, h, 0] * maps[p, g, g, 0]
                                add_scaled(pair[p], scale, A[p, i, h, k, g], n)


@inner_reordered
def spread(
    pair: Any,
    one: Any,
    other: Any,
    size: int,
    other_size: int,
    rows: Any,
    columns: Any,
    start: int,
    n: int,
    same_row: bool,
    flux: Any,
    value: Any,
    place: Any,
    flat: Any,
    diagonal: int,
    stride: int,
) -> None:
    """Add the tangent between two rows: sum_p D^o N_a pair[o, q, i, k, p] D^q N_b, of orders o and q.

    `one` and `other` (2, P, size, X) are the functions of the rows, `rows` and `columns` (2, size, X) their
    unknowns. For a row with itself, half of the entries follow from the symmetry.
    """
    P = one.shape[1]
    batch = slice(start, start + n)
    for i in range(2):
        for k in range(2):
            if same_row and i > k:
                continue
            for b in range(other_size):
                for p in range(P):
                    for order in range(2):
                        set_products(
                            flux[order, p],
                            0.0,
                            pair[order, 0, i, k, p],
                            other[0, p, b, batch],
                            pair[order, 1, i, k, p],
                            other[1, p, b, batch],
                            n,
                        )
                for a in range(b if same_row and i == k else 0, size):
                    value.fill(0.0)
                    for p in range(P):
                        add_products(
                            value, one[0, p, a, batch], flux[0, p], one[1, p, a, batch], flux[1, p], n
                        )
                    _scatter(
                        flat,
                        diagonal,
                        stride,
                        rows[i, a, batch],
                        columns[k, b, batch],
                        value,
                        place,
                        n,
                        same_row and i == k and a == b,
                    )


@inlined
def _scatter(
    flat: Any,
    diagonal: int,
    stride: int,
    row: Any,
    column: Any,
    value: Any,
    place: Any,
    n: int,
    same: bool,
) -> None:
    """Add symmetric entries (n,), and their mirror images if the whole band is stored, `diagonal` > 0.

    The entry of two tied coefficients is on the diagonal, like its mirror image: both are added, unless the
    coefficients are the `same`.
    """
    nowhere = flat.size - 1
    for e in range(n):
        least = min(row[e], column[e])
        greatest = max(row[e], column[e])
        place[e] = entry_place(stride, diagonal, greatest, least) if least >= 0 else nowhere
    if not same:
        for e in range(n):
            value[e] *= 2.0 if row[e] == column[e] else 1.0
    for e in range(n):
        flat[place[e]] += value[e]
    if diagonal > 0:
        for e in range(n):
            if row[e] >= 0 and column[e] >= 0 and row[e] != column[e]:
                least, greatest = min(row[e], column[e]), max(row[e], column[e])
                flat[entry_place(stride, diagonal, least, greatest)] += value[e]
