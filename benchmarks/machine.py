"""The machine: its processor, its load, and its best speed."""

import os
import platform
import resource
import sys
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

import numpy as np
from numba import njit
from threadpoolctl import threadpool_limits

from isopeel.common.arrays import FloatArray

_PACKAGES = ("isopeel", "numpy", "scipy", "numba")


class Ceiling(NamedTuple):
    """The best speed of one core."""

    matrix_product: float  # GFlop/s of numpy's dgemm, 512 x 512
    vector_sum: float  # GFlop/s of a compiled y += a x whose arrays stay in the first cache
    copy: float  # GB/s read and written by the copy of an array beyond all caches


def ceiling(megabytes: int = 512) -> Ceiling:
    """Return the measured speeds; the array of the copy has the given size."""
    A, x, y = np.random.default_rng(0).random((512, 512)), np.ones(1024), np.ones(1024)
    rounds = 20_000
    _add_scaled(1e-9, x, y, 1)
    with threadpool_limits(1):
        products = 2 * 512**3 / least_seconds(lambda: A @ A)
    sums = 2 * x.size * rounds / least_seconds(lambda: _add_scaled(1e-9, x, y, rounds))
    return Ceiling(products / 1e9, sums / 1e9, copy_rate(2 * megabytes * 2**20))


def copy_rate(moved: float) -> float:
    """Return the GB/s of a copy that reads half of these bytes and writes the other half, in any cache."""
    one = np.ones(max(1, round(moved / 16)))
    other = np.ones_like(one)
    # a short copy is repeated, so that the time of the clock is negligible
    rounds = max(1, int(1e6 / (2 * one.nbytes)))

    def copy() -> None:
        for _ in range(rounds):
            np.copyto(other, one)

    return 2 * one.nbytes * rounds / least_seconds(copy, budget=0.1) / 1e9


@njit(cache=True, fastmath={"contract"})
def _add_scaled(factor: float, x: FloatArray, y: FloatArray, rounds: int) -> None:
    for _ in range(rounds):
        for n in range(x.size):
            y[n] += factor * x[n]


def least_seconds(
    call: Callable[[], object],
    *,
    budget: float = 0.3,
    fewest: int = 3,
) -> float:
    """Return the least time of a call, repeated for `budget` seconds: disturbances only make calls longer."""
    times: list[float] = []
    end = perf_counter() + budget
    while len(times) < fewest or perf_counter() < end:
        began = perf_counter()
        call()
        times.append(perf_counter() - began)
    return min(times)


def peak_megabytes() -> float:
    """Return the peak memory of this process so far."""
    status = Path("/proc/self/status")
    if status.exists():
        # on Linux, getrusage includes the peak of the parent process
        lines = dict(line.split(":", 1) for line in status.read_text().splitlines())
        return float(lines["VmHWM"].split()[0]) / 1024
    unit = 2**20 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit


def description() -> str:
    """Return the processor, its cores and load, and the versions of the software."""
    information = Path("/proc/cpuinfo")
    lines = information.read_text().splitlines() if information.exists() else []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    model = models[0] if models else platform.processor()
    versions = ", ".join(f"{name} {version(name)}" for name in _PACKAGES)
    load = ", ".join(f"{number:.2f}" for number in os.getloadavg())
    return f"{model}, {os.cpu_count()} cores, load {load}; Python {platform.python_version()}, {versions}"
