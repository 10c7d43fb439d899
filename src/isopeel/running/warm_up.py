"""Warm-up compilation: a path with springs in place of the body compiles all kernels but the body's.

The body's kernel takes as long to compile as all others. Where they are not cached yet, as in the first run
after an installation, a second process compiles the others at the same time.
"""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from math import radians
from time import perf_counter

import numpy as np

from isopeel.assembly.body_kernel import BodyData, add_body, add_rectangles, read_body
from isopeel.assembly.loops import Energies, Loops
from isopeel.assembly.system import System
from isopeel.assembly.tables import BodyTable
from isopeel.common.arrays import FloatArray, IntArray
from isopeel.common.compilation import can_cache, is_cached
from isopeel.common.interrupts import cleared_up
from isopeel.common.processes import cores
from isopeel.matrix.band import entry_place
from isopeel.problem import strip
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.path import Path as SolverPath
from isopeel.solve.predictor_selection import select_predictor
from isopeel.solve.step import Found
from isopeel.splines.rows import row_space

#: Stiffness of the springs: ten times Young's modulus.
_STIFFNESS = 10.0


@contextmanager
def warmed_up_beside() -> Iterator[None]:
    """Compile the other kernels in a second process, as long as the body's kernel is not cached."""
    cached = is_cached(add_body) or is_cached(add_rectangles)
    if cached or not can_cache(add_body) or cores() == 1:
        yield
        return
    # a process of a pool would run the calling script again
    nowhere = subprocess.DEVNULL
    process = subprocess.Popen(
        # -P: nothing is imported from the current folder
        [sys.executable, "-P", "-m", __name__],
        stdin=nowhere,
        stdout=nowhere,
        stderr=nowhere,
    )
    try:
        with cleared_up(process.terminate):
            yield
    finally:
        process.wait()


def warm_up() -> None:
    """Take a few steps, on a mesh on which a front could be translated from element to element."""
    # the first process needs this one last: it would compile it itself, without waiting
    one = np.ones(1)
    select_predictor(one, one, one, np.ones((1, 2, 1)), 2.0)
    path = SolverPath(_OnSprings(strip(), row_space("L1", (40, 1))), NewtonSettings(), ())
    for degrees in (0.0, 0.1, 0.2):
        path.accept(Found(path.solver.equilibrium(radians(degrees))), perf_counter())


def _springs(
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
    """Add energy, forces and tangent as `add_body`, of a spring at each function of each element."""
    body: BodyData = read_body(integers, floats)
    first, unknowns = body.first, body.unknowns
    flat, stride = band.ravel(), band.shape[1] - 1
    energy = 0.0
    for j in range(len(first)):
        for a in range(body.sizes[body.kinds[j]]):
            for e in range(first.shape[1]):
                f = first[j, e] + a
                for i in range(2):
                    energy += _STIFFNESS / 2.0 * u[f, i] ** 2
                    forces[f, i] += _STIFFNESS * u[f, i]
                    n = unknowns[j, i, a, e]
                    if with_tangent and n >= 0:
                        flat[entry_place(stride, diagonal, n, n)] += _STIFFNESS
    return energy, 0.0, 0.0, 1.0


class _OnSprings(System):
    """A system whose elements are held by springs, far stiffer than the adhesion."""

    @staticmethod
    def body_loops(table: BodyTable) -> Loops:  # noqa: ARG004
        """Return the loops of springs."""
        return _springs


if __name__ == "__main__":
    warm_up()
