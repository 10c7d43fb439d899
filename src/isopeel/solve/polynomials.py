"""Compiled: polynomials through the states of a path: values, slopes, and the slope of the path."""

import numpy as np

from isopeel.common.arrays import FloatArray
from isopeel.common.compilation import compiled, inner

#: States around a place that are interpolated there; 8 to 12 are no better.
NODES = 6


@compiled
def lagrange(nodes: FloatArray, start: int, count: int, at: float, basis: FloatArray) -> None:
    """Set basis (2, count) to values and slopes, at a place, of Lagrange's polynomials of `count` nodes."""
    for i in range(count):
        value, slope = 1.0, 0.0
        for k in range(count):
            if k != i:
                scale = 1.0 / (nodes[start + i] - nodes[start + k])
                slope = (slope * (at - nodes[start + k]) + value) * scale
                value *= (at - nodes[start + k]) * scale
        basis[0, i], basis[1, i] = value, slope


@inner
def evaluate_newton_form(form: FloatArray, nodes: FloatArray, start: int, at: float) -> tuple[float, float]:
    """Return value and slope of a polynomial in Newton's form (n,), whose nodes begin at a start."""
    last = len(form) - 1
    value, slope = form[last], 0.0
    for i in range(last - 1, -1, -1):
        slope = slope * (at - nodes[start + i]) + value
        value = value * (at - nodes[start + i]) + form[i]
    return value, slope


@inner
def nearest_nodes(nodes: FloatArray, first: int, n: int, at: float) -> int:
    """Return the first of the NODES rising nodes, from `first` to n, nearest to a place; -1 beyond all."""
    if n - first < NODES or not nodes[first] <= at <= nodes[n - 1]:
        return -1
    while first < n - NODES and nodes[first + NODES] - at < at - nodes[first]:
        first += 1
    return first


@inner
def interpolate(
    nodes: FloatArray, values: FloatArray, start: int, at: float, basis: FloatArray
) -> tuple[float, float]:
    """Return value and slope of the polynomial through NODES values from a start on."""
    lagrange(nodes, start, NODES, at, basis)
    value, slope = 0.0, 0.0
    for i in range(NODES):
        value += basis[0, i] * values[start + i]
        slope += basis[1, i] * values[start + i]
    return value, slope


@inner
def first_monotonic(measure: FloatArray, n: int) -> int:
    """Return the first of n states from which on the path measure is monotonic up to the last one."""
    first = n - 1
    if first > 0:
        last = measure[first] - measure[first - 1]
        while first > 0 and (measure[first] - measure[first - 1]) * last > 0.0:
            first -= 1
    return first


@compiled
def slope(measure: FloatArray, parameters: FloatArray, values: FloatArray) -> float:
    """Return the derivative by the parameter, at the last state, of values (n,) at the states of a path.

    It is that of the polynomial in the path measure through the last states along which this is monotonic.
    Returns zero where there is no state before the last, and at a limit point of the parameter, where there
    is no such derivative.
    """
    last = len(measure) - 1
    first = first_monotonic(measure, last + 1)
    basis = np.empty((2, len(measure)))
    lagrange(measure, first, last - first, measure[last], basis)
    # of the polynomial (s - last) q(s) + f(last), with q through the difference quotients
    along, parameter = 0.0, 0.0
    for k in range(first, last):
        weight = basis[0, k - first] / (measure[k] - measure[last])
        along += weight * (values[k] - values[last])
        parameter += weight * (parameters[k] - parameters[last])
    # the last step gives the sign of the derivative
    onwards = parameter * (measure[last] - measure[last - 1]) * (parameters[last] - parameters[last - 1])
    return along / parameter if last > 0 and onwards > 0.0 else 0.0
