"""Loops over lanes, the elements of a row that are treated together, written into what calls them.

All arrays have at least n lanes. A loop over few of them runs in vector registers: the compiler tests whether
they overlap before it begins. Each should be the last axis, or a part of it, of an array in C order, taken by
single indices: of others the compiler does not know that their numbers lie one after another.
"""

from typing import Any

from numba import njit

inlined = njit(inline="always")


@inlined
def take(u: Any, first: Any, a: int, x: Any, y: Any, n: int) -> None:
    """Set x, y (n,) to the displacements (functions, 2) of the functions `a` beyond the first of elements."""
    # the first ones grow from element to element
    if first[n - 1] - first[0] == n - 1:
        # by one, as where elements are joined as smoothly as can be
        f = first[0] + a
        for lane in range(n):
            x[lane] = u[f + lane, 0]
            y[lane] = u[f + lane, 1]
    else:
        for lane in range(n):
            x[lane] = u[first[lane] + a, 0]
            y[lane] = u[first[lane] + a, 1]


@inlined
def give(forces: Any, first: Any, a: int, x: Any, y: Any, n: int) -> None:
    """The way back: add x, y (n,)."""
    if first[n - 1] - first[0] == n - 1:
        f = first[0] + a
        for lane in range(n):
            forces[f + lane, 0] += x[lane]
            forces[f + lane, 1] += y[lane]
    else:
        for lane in range(n):
            forces[first[lane] + a, 0] += x[lane]
            forces[first[lane] + a, 1] += y[lane]


@inlined
def set_scaled(total: Any, factor0: float, x0: Any, factor1: float, x1: Any, n: int) -> None:
    """Set total = factor0 x0 + factor1 x1."""
    for lane in range(n):
        total[lane] = factor0 * x0[lane] + factor1 * x1[lane]


@inlined
def set_start_scaled(
    total: Any, start: float, factor0: float, x0: Any, factor1: float, x1: Any, n: int
) -> None:
    """Set total = start + factor0 x0 + factor1 x1."""
    for lane in range(n):
        total[lane] = start + factor0 * x0[lane] + factor1 * x1[lane]


@inlined
def set_products(total: Any, start: float, x0: Any, y0: Any, x1: Any, y1: Any, n: int) -> None:
    """Set total = start + x0 y0 + x1 y1."""
    for lane in range(n):
        total[lane] = start + x0[lane] * y0[lane] + x1[lane] * y1[lane]


@inlined
def set_weighted_products(total: Any, weight: Any, x0: Any, y0: Any, x1: Any, y1: Any, n: int) -> None:
    """Set total = weight (x0 y0 + x1 y1)."""
    for lane in range(n):
        total[lane] = weight[lane] * (x0[lane] * y0[lane] + x1[lane] * y1[lane])


@inlined
def add_scaled_to_both(one: Any, factor0: float, other: Any, factor1: float, x: Any, n: int) -> None:
    """Add: one += factor0 x, other += factor1 x."""
    for lane in range(n):
        one[lane] += factor0 * x[lane]
        other[lane] += factor1 * x[lane]


@inlined
def sum_of_products(x: Any, y: Any, n: int) -> float:
    """Return the sum of x y."""
    total = 0.0
    for lane in range(n):
        total += x[lane] * y[lane]
    return total


@inlined
def add_product(total: Any, x: Any, y: Any, n: int) -> None:
    """Add to total: x y."""
    for lane in range(n):
        total[lane] += x[lane] * y[lane]


@inlined
def add_products(total: Any, x0: Any, y0: Any, x1: Any, y1: Any, n: int) -> None:
    """Add to total: x0 y0 + x1 y1."""
    for lane in range(n):
        total[lane] += x0[lane] * y0[lane] + x1[lane] * y1[lane]


@inlined
def add_scaled(total: Any, factor: float, x: Any, n: int) -> None:
    """Add to total: factor x."""
    for lane in range(n):
        total[lane] += factor * x[lane]
