"""A second process compiles what the first one needs besides the body's kernel."""

import subprocess
import sys

import pytest

from isopeel.running import warm_up
from isopeel.running.warm_up import warmed_up_beside

#: Prints how many loops over body and side a warm-up has compiled, and a path after it, and the compiled
#: functions that the path calls with other types, one per line.
NOT_WARMED_UP = """
import sys
import numpy as np
from numba.core.dispatcher import Dispatcher
import isopeel
from isopeel.assembly.loops import compile_loops
from isopeel.running.warm_up import warm_up

def signatures():
    return {
        (value.py_func.__module__, value.py_func.__name__): set(value.signatures)
        for name, module in list(sys.modules.items()) if name.startswith("isopeel.")
        for value in vars(module).values() if isinstance(value, Dispatcher)
    }

warm_up()
before = signatures()
print("loops", compile_loops.cache_info().currsize)
angles = np.radians(np.arange(0, 3, 0.1))
for step in isopeel.trace(isopeel.strip(), isopeel.row_space("N2.1", (40, 2)), angles):
    pass
print("loops", compile_loops.cache_info().currsize)
for key, found in signatures().items():
    if found - before.get(key, set()):
        print(*key)
"""


def test_a_path_needs_nothing_but_the_bodys_kernel_afterwards() -> None:
    found = subprocess.run(
        [sys.executable, "-c", NOT_WARMED_UP], check=True, capture_output=True, text=True
    ).stdout.splitlines()
    kernel = "isopeel.assembly.body_kernel"
    assert [line for line in found if not line.startswith(kernel)] == ["loops 2", "loops 3"]


@pytest.mark.parametrize(("cold", "cores", "processes"), [(True, 2, 1), (True, 1, 0), (False, 2, 0)])
def test_a_second_process_is_there_where_it_helps_and_while_it_does(
    monkeypatch: pytest.MonkeyPatch, cold: bool, cores: int, processes: int
) -> None:
    started: list[subprocess.Popen[bytes]] = []

    class Noted(subprocess.Popen[bytes]):
        def __init__(self, *arguments: object, **options: object) -> None:
            super().__init__(*arguments, **options)  # type: ignore[call-overload]
            started.append(self)

    monkeypatch.setattr(warm_up, "is_cached", lambda _: not cold)
    monkeypatch.setattr(warm_up, "cores", lambda: cores)
    monkeypatch.setattr(subprocess, "Popen", Noted)
    with warmed_up_beside():
        assert len(started) == processes
        assert all(process.poll() is None for process in started)
    assert all(process.returncode is not None for process in started)
