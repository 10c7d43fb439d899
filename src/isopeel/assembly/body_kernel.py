"""Compiled loops over the body (total Lagrangian): forces, stored energy and tangent, by sum factorization.

The functions are products: of one along xi, of the row j, and of one across, M_j(eta). So fields are
evaluated along each row first, and then across; forces and tangents in the opposite order. The last axis of
every array is the element of a batch along xi. The innermost loops run over it, so that they use SIMD
instructions fully, for any degree.

The gradient at a point is a combination of channels: d/dxi, d/deta and, for a rational space, the value
itself. Each channel is a derivative along xi of some order, times a derivative across (`BodyTable`). On equal
rectangles, d/dX_J is a multiple of channel J, with the same factor on all of them. Index names: a, b
functions along xi; c the rows of an element; i, k components; J, L reference directions; p quadrature points
along xi, r across.
"""

from typing import Any, NamedTuple

import numpy as np

from isopeel.assembly.body_tangent import (
    add_rectangles_to_pairs,
    add_to_pairs,
    pull_back,
    spread,
)
from isopeel.assembly.element_batch import (
    add_product,
    add_products,
    add_scaled,
    add_scaled_to_both,
    gather,
    scatter,
    set_products,
    set_scaled,
    set_start_scaled,
    set_weighted_products,
    sum_of_products,
)
from isopeel.assembly.loops import Energies, Loops
from isopeel.assembly.packing import (
    Flags2,
    Floats1,
    Floats3,
    Floats4,
    Floats5,
    Integers1,
    Integers2,
    Integers4,
    reader,
)
from isopeel.assembly.tables import BodyTable
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import inlined, specialized
from isopeel.physics.batch import material_at

#: Most elements of a batch: so many that the test for overlapping arrays before each innermost loop costs
#: little, and so few that their data fit into the first-level cache.
_BATCH = 256
#: Whether all elements are equal rectangles; see `add_rectangles`.
_ONLY_RECTANGLES = False
# Numba takes seconds to compile an assignment to a part of an array, but not its fill.


class BodyData(NamedTuple):
    """The data of the loops over a body."""

    material: int  # address
    parameters: Floats1
    kinds: Integers1  # this and the following as in `BodyTable`
    sizes: Integers1
    along: Floats5
    first: Integers2
    across: Floats4
    first_rows: Integers1
    map_kinds: Integers2
    maps: Floats5
    weight_kinds: Integers2
    weights: Floats3
    rectangles: Flags2
    unknowns: Integers4  # (rows, 2, largest size, X)


read_body = reader(BodyData)


def add_body(
    integers: IntArray,
    floats: FloatArray,
    _history: FloatArray,
    _scalars: FloatArray,
    u: FloatArray,
    forces: FloatArray,
    band: FloatArray,
    diagonal: int,
    with_tangent: bool,
) -> Energies:
    """Add internal forces int P_iJ dN_a/dX_J dV and their tangent; the stored energy and least det F.

    The integers and floats are those of a `BodyData`. u and forces are (size, 2). The band is (unknowns + 1,
    width): its last row gets the entries of no unknown. It is not used without `with_tangent`.
    """
    body: BodyData = read_body(integers, floats)
    material, parameters = material_at(body.material), body.parameters
    kinds, sizes, along, first = body.kinds, body.sizes, body.along, body.first
    across, first_rows, rectangles, unknowns = body.across, body.first_rows, body.rectangles, body.unknowns
    map_kinds, maps, weight_kinds, weights = body.map_kinds, body.maps, body.weight_kinds, body.weights
    rows, X = first.shape
    Y, _, R, C = across.shape
    P, largest = along.shape[2], along.shape[3]
    channels = maps.shape[2]
    # blocks of about the same size
    block = -(-X // -(-X // _BATCH))
    points = P * block
    local = np.empty((largest, 2, block))
    # of the rows of one row of elements
    lines = np.empty((C, 2, 2, P, block))
    loads = np.empty((C, 2, 2, P, block))
    channel = np.empty((channels, block))
    F = np.empty((2, 2, block))
    density = np.empty(block)
    stress = np.empty((2, 2, block))
    A = np.empty((P, 2, 2, 2, 2, block))
    half = np.empty((2, 2, block))
    moduli = np.empty((2 * channels, 2 * channels, points))
    pairs = np.zeros((C, C, 2, 2, 2, 2, P, block) if with_tangent else (1, 1, 2, 2, 2, 2, 1, 1))
    flux = np.empty((2, P, block))
    value = np.empty((2, block))
    place = np.empty(block, np.int64)
    flat = band.ravel()
    energy = 0.0
    least = np.empty(block)
    least.fill(np.inf)
    for start in range(0, X, block):
        n = min(block, X - start)
        batch = slice(start, start + n)
        ready = 0
        for y in range(Y):
            row = first_rows[y]
            for j in range(ready, row + C):
                kind = kinds[j]
                loads[j % C].fill(0.0)
                for a in range(sizes[kind]):
                    gather(u, first[j, batch], a, local[a, 0], local[a, 1], n)
                for order in range(2):
                    for i in range(2):
                        for p in range(P):
                            line = lines[j % C, order, i, p, :n]
                            set_products(
                                line,
                                0.0,
                                local[0, i],
                                along[kind, order, p, 0, batch],
                                local[1, i],
                                along[kind, order, p, 1, batch],
                                n,
                            )
                            for a in range(2, sizes[kind] - 1, 2):
                                add_products(
                                    line,
                                    local[a, i],
                                    along[kind, order, p, a, batch],
                                    local[a + 1, i],
                                    along[kind, order, p, a + 1, batch],
                                    n,
                                )
                            if sizes[kind] > 2 and sizes[kind] % 2 == 1:
                                last = sizes[kind] - 1
                                add_product(line, local[last, i], along[kind, order, p, last, batch], n)
            ready = row + C
            for r in range(R):
                to_X, areas = maps[map_kinds[y, r]], weights[weight_kinds[y, r]]
                for p in range(P):
                    if _ONLY_RECTANGLES or rectangles[y, r]:
                        _deform_rectangles(F, lines, across[y], to_X, p, r, row, n)
                    else:
                        _deform(F, lines, across[y], to_X, p, r, row, batch, channel, n)
                    # one for each place in the arrays: with a single one there are no SIMD instructions
                    for e in range(n):
                        determinant = F[0, 0, e] * F[1, 1, e] - F[0, 1, e] * F[1, 0, e]
                        least[e] = determinant if determinant < least[e] else least[e]
                    material(F, parameters, n, density, stress, A[p], with_tangent)
                    area = areas[p, batch]
                    energy += sum_of_products(area, density, n)
                    if _ONLY_RECTANGLES or rectangles[y, r]:
                        _load_rectangles(loads, stress, area[0], across[y], to_X, p, r, row, n)
                    else:
                        _load(loads, stress, area, across[y], to_X, p, r, row, batch, channel[0], n)
                if not with_tangent:
                    continue
                if _ONLY_RECTANGLES or rectangles[y, r]:
                    add_rectangles_to_pairs(pairs, A, to_X, areas, across[y], r, row, n)
                else:
                    pull_back(A, to_X, areas, start, n, half, moduli)
                    add_to_pairs(pairs, moduli, across[y], r, row, channels, n)
            # rows that no other row of elements adds to
            for j in range(row, first_rows[y + 1] if y + 1 < Y else rows):
                kind = kinds[j]
                for a in range(sizes[kind]):
                    for i in range(2):
                        total = value[i]
                        total.fill(0.0)
                        for p in range(P):
                            add_products(
                                total,
                                along[kind, 0, p, a, batch],
                                loads[j % C, 0, i, p],
                                along[kind, 1, p, a, batch],
                                loads[j % C, 1, i, p],
                                n,
                            )
                    scatter(forces, first[j, batch], a, value[0], value[1], n)
                if with_tangent:
                    for d in range(min(C, rows - j)):
                        spread(
                            pairs[j % C, d],
                            along[kinds[j]],
                            along[kinds[j + d]],
                            sizes[kinds[j]],
                            sizes[kinds[j + d]],
                            unknowns[j],
                            unknowns[j + d],
                            start,
                            n,
                            d == 0,
                            flux,
                            value[0],
                            place,
                            flat,
                            diagonal,
                            band.shape[1] - 1,
                        )
                    pairs[j % C].fill(0.0)
    lowest = np.inf
    for e in range(block):
        lowest = min(lowest, least[e])
    return energy, 0.0, 0.0, lowest


@inlined
def _deform(
    F: Any,
    lines: Any,
    across: Any,
    maps: Any,
    p: int,
    r: int,
    row: int,
    batch: Any,
    channel: Any,
    n: int,
) -> None:
    """Set F to the deformation gradient at a point of each element of a batch."""
    C, channels = across.shape[2], maps.shape[1]
    for i in range(2):
        for h in range(channels):
            factors, order = across[1 if h == 1 else 0, r], 1 if h == 0 else 0
            one, two = lines[row % C, order, i, p], lines[(row + 1) % C, order, i, p]
            set_scaled(channel[h], factors[0], one, factors[1], two, n)
            for c in range(2, C):
                add_scaled(channel[h], factors[c], lines[(row + c) % C, order, i, p], n)
        for J in range(2):
            start = 1.0 if i == J else 0.0
            set_products(
                F[i, J], start, maps[p, 0, J, batch], channel[0], maps[p, 1, J, batch], channel[1], n
            )
            if channels == 3:
                add_product(F[i, J], maps[p, 2, J, batch], channel[2], n)


@inlined
def _deform_rectangles(F: Any, lines: Any, across: Any, maps: Any, p: int, r: int, row: int, n: int) -> None:
    """Do the same for equal rectangles."""
    C = across.shape[2]
    for i in range(2):
        for J in range(2):
            factors, order, scale = across[J, r], 1 - J, maps[p, J, J, 0]
            one, two = lines[row % C, order, i, p], lines[(row + 1) % C, order, i, p]
            start = 1.0 if i == J else 0.0
            set_start_scaled(F[i, J], start, scale * factors[0], one, scale * factors[1], two, n)
            for c in range(2, C):
                add_scaled(F[i, J], scale * factors[c], lines[(row + c) % C, order, i, p], n)


@inlined
def _load(
    loads: Any,
    stress: Any,
    area: Any,
    across: Any,
    maps: Any,
    p: int,
    r: int,
    row: int,
    batch: Any,
    flow: Any,
    n: int,
) -> None:
    """Add the contributions of the stresses at a point of each element of a batch to the rows."""
    C, channels = across.shape[2], maps.shape[1]
    for i in range(2):
        for h in range(channels):
            set_weighted_products(
                flow, area, maps[p, h, 0, batch], stress[i, 0], maps[p, h, 1, batch], stress[i, 1], n
            )
            factors, order = across[1 if h == 1 else 0, r], 1 if h == 0 else 0
            one, two = loads[row % C, order, i, p], loads[(row + 1) % C, order, i, p]
            add_scaled_to_both(one, factors[0], two, factors[1], flow, n)
            for c in range(2, C):
                add_scaled(loads[(row + c) % C, order, i, p], factors[c], flow, n)


@inlined
def _load_rectangles(
    loads: Any, stress: Any, area: float, across: Any, maps: Any, p: int, r: int, row: int, n: int
) -> None:
    """Do the same for equal rectangles, which have one area."""
    C = across.shape[2]
    for i in range(2):
        for J in range(2):
            factors, order, scale = across[J, r], 1 - J, area * maps[p, J, J, 0]
            one, two = loads[row % C, order, i, p], loads[(row + 1) % C, order, i, p]
            add_scaled_to_both(one, scale * factors[0], two, scale * factors[1], stress[i, J], n)
            for c in range(2, C):
                add_scaled(loads[(row + c) % C, order, i, p], scale * factors[c], stress[i, J], n)


#: The same for a body of equal rectangles, compiled without the code for others.
add_rectangles = specialized(add_body, "add_rectangles", _ONLY_RECTANGLES=True)


def loops_of(table: BodyTable) -> Loops:
    """Return the loops over a body."""
    return add_rectangles if table.rectangles.all() else add_body
