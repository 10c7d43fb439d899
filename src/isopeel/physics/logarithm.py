"""A logarithm that compiled loops can compute by SIMD instructions, several points at once.

That of the C library is a call, which prevents SIMD instructions in the whole loop. The error is at most two
units in the last place.
"""

from typing import Any

import numpy as np
from llvmlite import ir
from numba import float64, int64, njit
from numba.extending import intrinsic

_MANTISSA = 0x000F_FFFF_FFFF_FFFF
_ONE = 0x3FF0_0000_0000_0000  # 1.0
# their sum is log 2; the first ends in zeros, so that its products with small numbers are exact
_LOG_2_HIGH, _LOG_2_LOW = 0.6931471803691238, 1.9082149292705877e-10


@intrinsic
def _bits(_context: Any, _x: Any) -> Any:
    """The bits of a double precision number."""

    def code(_context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        return builder.bitcast(arguments[0], ir.IntType(64))

    return int64(float64), code


@intrinsic
def _number(_context: Any, _bits: Any) -> Any:
    """The double precision number of some bits."""

    def code(_context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
        return builder.bitcast(arguments[0], ir.DoubleType())

    return float64(int64), code


# products and sums of the series may be one operation
@njit(error_model="numpy", fastmath={"contract"})
def log(x: float) -> float:
    """Natural logarithm of x; nan unless 0 < x < inf: the solver detects an inverted point by it.

    x = 2^k m with m in [1/sqrt 2, sqrt 2), and log m = 2 artanh z of z = (m - 1)/(m + 1), |z| < 0.172, by its
    series up to z^21: the first term left out is below 1e-18 of the sum.
    """
    bits: int = _bits(x)  # type: ignore[call-arg]
    k = float((bits >> 52) - 1023)
    m: float = _number((bits & _MANTISSA) | _ONE)
    large = m > 1.4142135623730951
    m = 0.5 * m if large else m
    k = k + 1.0 if large else k
    z = (m - 1.0) / (m + 1.0)
    w = z * z
    series = 1 / 11 + w * (1 / 13 + w * (1 / 15 + w * (1 / 17 + w * (1 / 19 + w / 21))))
    series = 1 / 3 + w * (1 / 5 + w * (1 / 7 + w * (1 / 9 + w * series)))
    value = k * _LOG_2_HIGH + (2.0 * z + (2.0 * z * w * series + k * _LOG_2_LOW))
    return value if 0.0 < x < np.inf else np.nan
