"""A path with springs in place of the body: to compile all kernels but that of the body.

That one takes as long to compile as all others. So where they are not cached yet, as in the first run after
an installation, a second process compiles the others meanwhile.
"""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from math import radians
from pathlib import Path
from typing import Any

import numpy as np

from isopeel.arrays import FloatArray
from isopeel.assembly.body_kernel import body
from isopeel.assembly.system import Sums, System
from isopeel.problem import strip
from isopeel.processes import cores
from isopeel.solve.leading import best_weights
from isopeel.solve.newton import NewtonSettings
from isopeel.solve.path import Path as SolverPath
from isopeel.splines.rows import row_space


@contextmanager
def rehearsed_beside() -> Iterator[None]:
    """Compile in a second process meanwhile, as long as the body's kernel is not cached."""
    if _is_cached(body) or cores() == 1:
        yield
        return
    # not one of a pool, which would run the script again that has called this
    nowhere = subprocess.DEVNULL
    process = subprocess.Popen(
        [sys.executable, "-m", __name__], stdin=nowhere, stdout=nowhere, stderr=nowhere
    )
    try:
        yield
    finally:
        process.terminate()
        process.wait()


def _is_cached(kernel: Any) -> bool:
    """Whether Numba has a file of a compiled function, be it of an older source."""
    module = kernel.py_func.__module__.rpartition(".")[2]
    return any(Path(kernel.stats.cache_path).glob(f"{module}.{kernel.py_func.__name__}-*.nbi"))


def rehearse() -> None:
    """Take a few steps, on a mesh on which a front could be carried on from element to element."""
    # the first process asks for this one last, and could not wait for it
    one = np.ones(1)
    best_weights(one, one, one, np.ones((1, 2, 1)), 2.0)
    path = SolverPath(_OnSprings(strip(), row_space("L1", (40, 1))), NewtonSettings(), ())
    for degrees in (0.0, 0.1, 0.2):
        path.step(path.equilibrium(radians(degrees)), 0.0)


class _OnSprings(System):
    """A system whose coefficients are held by springs, far stiffer than the adhesion."""

    def _add_body(self, displacement: FloatArray, sums: Sums) -> tuple[float, float]:
        stiffness = 10 * self.energy_scale
        sums.forces[:] += stiffness * displacement
        if sums.with_tangent:
            unknowns = self.constraints.unknowns
            sums.band[:-1, sums.diagonal] += stiffness * np.bincount(unknowns[unknowns >= 0])
        return stiffness / 2 * float(np.sum(displacement**2)), 1.0


if __name__ == "__main__":
    rehearse()
