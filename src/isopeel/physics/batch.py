"""Compilation of batch functions: the formulas of one law at many points at once.

A batch function is plain Python over arrays whose last axis counts the points. It is compiled on its own
and handed to the assembly by address, which is why the assembly needs no recompilation for a new law.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba import boolean, float64, int64, types, void
from numba.core import cgutils
from numba.extending import intrinsic

from isopeel.common.arrays import FloatArray
from isopeel.common.compilation import EXACT, compiled, compiled_now

_VECTOR = float64[::1]
_POINTS_2 = float64[:, ::1]
_POINTS_3 = float64[:, :, ::1]
_POINTS_5 = float64[:, :, :, :, ::1]

#: (deformation_gradient (2, 2, n), parameters, n, energy (n), stress (2, 2, n), tangent (2, 2, 2, 2, n), and
#: whether to compute the tangent, which a residual does not need)
MATERIAL_SIGNATURE = void(_POINTS_3, _VECTOR, int64, _VECTOR, _POINTS_3, _POINTS_5, boolean)
#: (gap (n), curvature (n), parameters, n, potential (n), traction (n), derivative (n))
ADHESION_SIGNATURE = void(_VECTOR, _VECTOR, _VECTOR, int64, _VECTOR, _VECTOR, _VECTOR)
#: (position (2, n), parameters, n, gap (n), normal (2, n), curvature (n))
SUBSTRATE_SIGNATURE = void(_POINTS_2, _VECTOR, int64, _VECTOR, _POINTS_2, _VECTOR)
#: (jump (2, n), history (k, n), parameters, n, stored and dissipated energy (2, n), slopes (2, n), stiffness
#: (3, n), the history after a step to the jump (k, n)), see `isopeel.physics.joints`
JOINT_SIGNATURE = void(_POINTS_2, _POINTS_2, _VECTOR, int64, _POINTS_2, _POINTS_2, _POINTS_2, _POINTS_2)

#: A compiled batch function, callable from compiled code through its address.
BatchFunction = Any


def compile_batch(signature: Any, function: Callable[..., None], cache: bool = True) -> BatchFunction:
    """Compile a batch function to machine code for one of the signatures above.

    A division by zero gives inf or nan: an exception could not cross the call by address.
    """
    return compiled_now(signature, function, EXACT, keep=cache)


def of_address(signature: Any) -> Any:
    """Return what makes a function of this signature from its address, in compiled code.

    Numba accepts the function itself, too, but then looks up its type and its address at each call, which
    takes as long as a few hundred points of a law.
    """
    function = types.FunctionType(signature)

    @intrinsic
    def taken(_context: Any, _address: Any) -> Any:
        def code(context: Any, builder: Any, _signature: Any, arguments: Any) -> Any:
            value: Any = cgutils.create_struct_proxy(function)(context, builder)  # type: ignore[no-untyped-call]
            null = cgutils.voidptr_t(None)
            value.c_addr = builder.inttoptr(arguments[0], cgutils.voidptr_t)
            value.py_addr, value.jit_addr = null, null
            return value._getvalue()

        return function(int64), code

    return taken


material_at = of_address(MATERIAL_SIGNATURE)
law_at = of_address(ADHESION_SIGNATURE)
substrate_at = of_address(SUBSTRATE_SIGNATURE)
joint_at = of_address(JOINT_SIGNATURE)


class JointValues(NamedTuple):
    """What a joint law returns at jumps: see `isopeel.physics.joints`."""

    energies: FloatArray  # stored and dissipated (2, n)
    slopes: FloatArray  # (2, n)
    stiffness: FloatArray  # E_nn, E_nt and E_tt (3, n)
    history: FloatArray  # after a step to the jump (k, n)


def evaluate_joint(
    kernel: BatchFunction, parameters: FloatArray, jump: FloatArray, history: FloatArray
) -> JointValues:
    """Evaluate a joint law at jumps (2, n), opening and sliding, after a history (k, n)."""
    count = jump.shape[1]
    found = JointValues(
        np.empty((2, count)), np.empty((2, count)), np.empty((3, count)), np.empty((len(history), count))
    )
    at, known = (np.array(one, dtype=np.float64, order="C") for one in (jump, history))
    _call_joint(kernel, at, known, parameters, found)
    return found


def evaluate_material(
    kernel: BatchFunction, parameters: FloatArray, deformation_gradient: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Energy density (...), stress P (..., 2, 2) and tangent (..., 2, 2, 2, 2) at F (..., 2, 2)."""
    shape = deformation_gradient.shape[:-2]
    F = _points_last(deformation_gradient, shape)
    count = F.shape[-1]
    energy, P, A = np.empty(count), np.empty((2, 2, count)), np.empty((2, 2, 2, 2, count))
    _call_material(kernel, F, parameters, energy, P, A)
    return energy.reshape(shape), _points_first(P, shape), _points_first(A, shape)


def evaluate_law(
    kernel: BatchFunction, parameters: FloatArray, gap: FloatArray, curvature: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Potential, traction and its derivative (...) at gaps (...) to a substrate of curvature (...)."""
    values = np.empty((3, gap.size))
    flat = np.array(gap, dtype=np.float64).ravel(), np.array(curvature, dtype=np.float64).ravel()
    _call_law(kernel, *flat, parameters, *values)
    potential, traction, derivative = (row.reshape(gap.shape) for row in values)
    return potential, traction, derivative


def evaluate_substrate(
    kernel: BatchFunction, parameters: FloatArray, position: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Gap (...), outward normal (..., 2) and curvature (...) as seen from positions (..., 2)."""
    shape = position.shape[:-1]
    points = _points_last(position, shape)
    count = points.shape[-1]
    gap, normal, curvature = np.empty(count), np.empty((2, count)), np.empty(count)
    _call_substrate(kernel, points, parameters, gap, normal, curvature)
    return gap.reshape(shape), _points_first(normal, shape), curvature.reshape(shape)


@compiled
def _call_material(
    kernel: BatchFunction,
    F: FloatArray,
    parameters: FloatArray,
    energy: FloatArray,
    P: FloatArray,
    A: FloatArray,
) -> None:
    kernel(F, parameters, energy.size, energy, P, A, True)


@compiled
def _call_law(
    kernel: BatchFunction,
    gap: FloatArray,
    curvature: FloatArray,
    parameters: FloatArray,
    potential: FloatArray,
    traction: FloatArray,
    derivative: FloatArray,
) -> None:
    kernel(gap, curvature, parameters, gap.size, potential, traction, derivative)


@compiled
def _call_substrate(
    kernel: BatchFunction,
    position: FloatArray,
    parameters: FloatArray,
    gap: FloatArray,
    normal: FloatArray,
    curvature: FloatArray,
) -> None:
    kernel(position, parameters, gap.size, gap, normal, curvature)


@compiled
def _call_joint(
    kernel: BatchFunction,
    jump: FloatArray,
    history: FloatArray,
    parameters: FloatArray,
    found: JointValues,
) -> None:
    count = jump.shape[1]
    kernel(jump, history, parameters, count, found.energies, found.slopes, found.stiffness, found.history)


def _points_last(values: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    """Copy values (..., i, j) to a new array (i, j, n), which compiled code may write to."""
    flat = values.reshape(-1, *values.shape[len(shape) :])
    return np.array(np.moveaxis(flat, 0, -1), dtype=np.float64, order="C")


def _points_first(values: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    """Return values (i, j, n) as (..., i, j)."""
    return np.moveaxis(values, -1, 0).reshape(*shape, *values.shape[:-1])
