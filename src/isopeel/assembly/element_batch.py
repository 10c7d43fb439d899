"""SIMD loops over an element batch, which is n elements of a row; they are inlined into their callers.

The last axis of all arrays has at least n entries. A loop over few arrays is compiled to SIMD instructions:
the compiler tests before the loop whether the arrays overlap. Each array should be the last axis, or a part
of it, of an array in C order, selected by single indices: only then does the compiler treat its numbers as
contiguous.
"""

from typing import Any

from isopeel.common.compilation import inlined


@inlined
def gather(u: Any, first: Any, a: int, x: Any, y: Any, n: int) -> None:
    """Set x, y (n,) to displacements u (functions, 2): of function `a` after the first of each element."""
    # the first functions increase from element to element
    if first[n - 1] - first[0] == n - 1:
        # by one, as in splines of the highest continuity
        f = first[0] + a
        for e in range(n):
            x[e] = u[f + e, 0]
            y[e] = u[f + e, 1]
    else:
        for e in range(n):
            x[e] = u[first[e] + a, 0]
            y[e] = u[first[e] + a, 1]


@inlined
def scatter(forces: Any, first: Any, a: int, x: Any, y: Any, n: int) -> None:
    """Add x, y (n,) to the forces (functions, 2) of the same functions: the transpose of `gather`."""
    if first[n - 1] - first[0] == n - 1:
        f = first[0] + a
        for e in range(n):
            forces[f + e, 0] += x[e]
            forces[f + e, 1] += y[e]
    else:
        for e in range(n):
            forces[first[e] + a, 0] += x[e]
            forces[first[e] + a, 1] += y[e]


@inlined
def set_scaled(total: Any, factor0: float, x0: Any, factor1: float, x1: Any, n: int) -> None:
    """Set total = factor0 x0 + factor1 x1."""
    for e in range(n):
        total[e] = factor0 * x0[e] + factor1 * x1[e]


@inlined
def set_start_scaled(
    total: Any, start: float, factor0: float, x0: Any, factor1: float, x1: Any, n: int
) -> None:
    """Set total = start + factor0 x0 + factor1 x1."""
    for e in range(n):
        total[e] = start + factor0 * x0[e] + factor1 * x1[e]


@inlined
def set_products(total: Any, start: float, x0: Any, y0: Any, x1: Any, y1: Any, n: int) -> None:
    """Set total = start + x0 y0 + x1 y1."""
    for e in range(n):
        total[e] = start + x0[e] * y0[e] + x1[e] * y1[e]


@inlined
def set_weighted_products(total: Any, weight: Any, x0: Any, y0: Any, x1: Any, y1: Any, n: int) -> None:
    """Set total = weight (x0 y0 + x1 y1)."""
    for e in range(n):
        total[e] = weight[e] * (x0[e] * y0[e] + x1[e] * y1[e])


@inlined
def add_scaled_to_both(one: Any, factor0: float, other: Any, factor1: float, x: Any, n: int) -> None:
    """Add: one += factor0 x, other += factor1 x."""
    for e in range(n):
        one[e] += factor0 * x[e]
        other[e] += factor1 * x[e]


@inlined
def sum_of_products(x: Any, y: Any, n: int) -> float:
    """Return the sum of x y."""
    total = 0.0
    for e in range(n):
        total += x[e] * y[e]
    return total


@inlined
def add_product(total: Any, x: Any, y: Any, n: int) -> None:
    """Add to total: x y."""
    for e in range(n):
        total[e] += x[e] * y[e]


@inlined
def add_products(total: Any, x0: Any, y0: Any, x1: Any, y1: Any, n: int) -> None:
    """Add to total: x0 y0 + x1 y1."""
    for e in range(n):
        total[e] += x0[e] * y0[e] + x1[e] * y1[e]


@inlined
def add_scaled(total: Any, factor: float, x: Any, n: int) -> None:
    """Add to total: factor x."""
    for e in range(n):
        total[e] += factor * x[e]
