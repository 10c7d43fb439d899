"""Compile what most tests call, in two processes, before the processes of pytest-xdist start.

Each of these would compile all of it otherwise, at the same time.
"""

import subprocess
import sys
from collections.abc import Callable

from isopeel import MooneyRivlin
from isopeel.assembly.body_kernel import add_body, add_rectangles
from isopeel.assembly.facing_kernel import add_facing
from isopeel.assembly.load_kernel import add_load
from isopeel.assembly.loops import compile_loops
from isopeel.assembly.pair_kernel import add_pairs
from isopeel.common.compilation import is_cached
from isopeel.running.warm_up import warm_up


def _bodies_and_facing_sides() -> None:
    for loops in (add_body, add_rectangles, add_load, add_facing):
        compile_loops(loops)


def _solver_and_other_sides() -> None:
    # what a path calls besides the loops over its body, among it the loops over a side on a substrate
    warm_up()
    compile_loops(add_pairs)
    assert MooneyRivlin(0.3, 0.1, 10.0).kernel.address


#: Two parts that take about as long as each other.
PARTS: dict[str, Callable[[], None]] = {
    "bodies and facing sides": _bodies_and_facing_sides,
    "solver and other sides": _solver_and_other_sides,
}


def compile_kernels() -> None:
    """Compile both parts at the same time, unless they are in the cache."""
    if is_cached(add_body) and is_cached(add_pairs):
        return
    processes = [subprocess.Popen([sys.executable, __file__, part]) for part in PARTS]
    for process in processes:
        if process.wait() != 0:
            raise RuntimeError(f"{process.args!r} ended with {process.returncode}")


if __name__ == "__main__":
    PARTS[sys.argv[1]]()
