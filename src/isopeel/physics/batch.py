"""Compilation of batch functions: the formulas of one law at many points at once.

A batch function is plain Python over arrays whose last axis counts the points. It is compiled on its own
and handed to the assembly by address, which is why the assembly needs no recompilation for a new law.
"""

from collections.abc import Callable
from typing import Any

from numba import cfunc, float64, int64, void

_VECTOR = float64[::1]
_POINTS_2 = float64[:, ::1]
_POINTS_3 = float64[:, :, ::1]
_POINTS_5 = float64[:, :, :, :, ::1]

#: (deformation_gradient (2, 2, n), parameters, n, energy (n), stress (2, 2, n), tangent (2, 2, 2, 2, n))
MATERIAL_SIGNATURE = void(_POINTS_3, _VECTOR, int64, _VECTOR, _POINTS_3, _POINTS_5)
#: (gap (n), curvature (n), parameters, n, potential (n), traction (n), derivative (n))
ADHESION_SIGNATURE = void(_VECTOR, _VECTOR, _VECTOR, int64, _VECTOR, _VECTOR, _VECTOR)
#: (position (2, n), parameters, n, gap (n), normal (2, n), curvature (n))
SUBSTRATE_SIGNATURE = void(_POINTS_2, _VECTOR, int64, _VECTOR, _POINTS_2, _VECTOR)

#: A compiled batch function, callable from compiled code through its address.
BatchFunction = Any


def compile_batch(signature: Any, function: Callable[..., None], cache: bool = True) -> BatchFunction:
    """Compile a batch function to machine code for one of the signatures above.

    `error_model="numpy"` makes a division by zero give inf or nan, which the solver detects and reports;
    an exception could not cross the call by address.
    """
    return cfunc(signature, cache=cache, error_model="numpy")(function)
