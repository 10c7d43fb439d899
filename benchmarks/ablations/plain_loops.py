"""The products of `isopeel.matrix.simd_kernels` as plain loops, which the compiler may make vectors of."""

from typing import Any

from numba import njit

COLUMNS = 8
_inlined = njit(fastmath={"contract", "reassoc", "nsz"}, error_model="numpy")


@_inlined
def forward(values: Any, block: int, rows: int, x: Any, start: int) -> None:
    """Solve with a block of a triangular factor, in place."""
    for i in range(COLUMNS - 1, -1, -1):
        total = values.dtype.type(0)
        for c in range(i + 1):
            total += values[block + c * COLUMNS + i] * x[start + c]
        x[start + i] = total
    first = block + COLUMNS * COLUMNS
    for c in range(COLUMNS):
        part = x[start + c]
        for i in range(rows):
            x[start + COLUMNS + i] -= values[first + c * rows + i] * part


@_inlined
def backward(values: Any, block: int, rows: int, x: Any, start: int) -> None:
    """The same with the transposed factor."""
    first = block + COLUMNS * COLUMNS
    for c in range(COLUMNS):
        total = values.dtype.type(0)
        for i in range(rows):
            total += values[first + c * rows + i] * x[start + COLUMNS + i]
        x[start + c] -= total
    for c in range(COLUMNS):
        total = values.dtype.type(0)
        for i in range(c, COLUMNS):
            total += values[block + c * COLUMNS + i] * x[start + i]
        x[start + c] = total


@_inlined
def set_product(
    left: Any,
    left_first: int,
    left_stride: int,
    right: Any,
    right_first: int,
    right_stride: int,
    result: Any,
    result_first: int,
    result_stride: int,
    rows: int,
) -> None:
    """Set columns to a product."""
    ones, others, to = left.ravel(), right.ravel(), result.ravel()
    for c in range(COLUMNS):
        for i in range(rows):
            to[result_first + c * result_stride + i] = 0.0
        for k in range(COLUMNS):
            factor = others[right_first + k * right_stride + c]
            for i in range(rows):
                to[result_first + c * result_stride + i] += factor * ones[left_first + k * left_stride + i]


@_inlined
def take_off_product(
    left: Any,
    left_first: int,
    left_stride: int,
    right: Any,
    right_first: int,
    right_stride: int,
    result: Any,
    result_first: int,
    result_stride: int,
    rows: int,
) -> None:
    """The same, taken off."""
    ones, others, to = left.ravel(), right.ravel(), result.ravel()
    for c in range(COLUMNS):
        for k in range(COLUMNS):
            factor = others[right_first + k * right_stride + c]
            for i in range(rows):
                to[result_first + c * result_stride + i] -= factor * ones[left_first + k * left_stride + i]
