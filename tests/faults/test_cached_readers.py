"""Cached loops that different processes have compiled, in one process."""

import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

import pytest

import isopeel.assembly

MODULE = """
import sys
from typing import NamedTuple

import numpy as np
from numba import njit

from isopeel.assembly.packing import Floats1, Floats2, packed, reader


class One(NamedTuple):
    chosen: Floats2
    other: Floats1


class Two(NamedTuple):
    chosen: Floats1
    other: Floats2


read_one, read_two = reader(One), reader(Two)


@njit(cache=True)
def sum_of_one(integers, floats):
    return read_one(integers, floats).chosen.sum()


@njit(cache=True)
def sum_of_two(integers, floats):
    return read_two(integers, floats).chosen.sum()


sums = {
    "one": lambda: sum_of_one(*packed(One(np.ones((3, 4)), np.zeros(2)))),
    "two": lambda: sum_of_two(*packed(Two(np.ones(5), np.zeros((2, 2))))),
}
print(*(sums[name]() for name in sys.argv[1:]))
"""


def test_each_kind_of_data_has_a_reader_with_a_name_of_its_own() -> None:
    names = []
    for module in iter_modules(isopeel.assembly.__path__):
        for name, one in vars(import_module(f"isopeel.assembly.{module.name}")).items():
            if name.startswith("read_") and one.py_func.__module__ == f"isopeel.assembly.{module.name}":
                names.append(one.py_func.__qualname__)
    assert sorted(names) == sorted(set(names))
    assert {"read_BodyData", "read_FacingData", "read_LoadData"} <= set(names)


@pytest.mark.long
def test_readers_of_two_processes_are_not_exchanged_in_a_third_one(tmp_path: Path) -> None:
    """The first function of each process had the same symbol: two bodies with loads had inverted elements."""
    script = tmp_path / "kinds.py"
    script.write_text(MODULE)

    def printed(*names: str) -> str:
        command = [sys.executable, str(script), *names]
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
        return subprocess.run(command, check=True, env=environment, capture_output=True, text=True).stdout

    assert printed("one") == "12.0\n"
    assert printed("two") == "5.0\n"
    assert printed("one", "two") == "12.0 5.0\n"
