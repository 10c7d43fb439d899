"""Where nothing can be kept from run to run, functions are compiled in memory."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from isopeel.common import compilation

#: A small package with the module that compiles, and a function of it.
RUN = """
import isopeel.common.compilation as compilation
from called import number
print(compilation.can_cache(number.py_func), compilation.is_cached(number.py_func), number(2.0))
"""
CALLED = """
from isopeel.common.compilation import compiled

@compiled
def number(x):
    return 3.0 * x
"""


def small_package(folder: Path) -> Path:
    package = folder / "package"
    common = package / "isopeel" / "common"
    common.mkdir(parents=True)
    for file in (common.parent / "__init__.py", common / "arrays.py"):
        file.touch()
    for name in ("compilation.py", "errors.py"):
        original = Path(compilation.__file__).with_name(name)
        (common / name).write_text(original.read_text())
    (package / "called.py").write_text(CALLED)
    return package


@pytest.mark.posix
@pytest.mark.parametrize(
    "unwritable",
    [
        {"NUMBA_CACHE_DIR": "/proc/nowhere"},
        {"NUMBA_CACHE_DIR": "/dev/null"},
        {"NUMBA_CACHE_DIR": "/dev/null/below"},
        {"NUMBA_CACHE_DIR": ""},
    ],
)
def test_functions_are_compiled_in_memory(unwritable: dict[str, str], tmp_path: Path) -> None:
    package = small_package(tmp_path)
    (package / "__pycache__").touch()  # a file in place of a folder, which root cannot write to either
    unwritable = unwritable | {"HOME": "/proc", "XDG_CACHE_HOME": "/proc"}
    environment = os.environ | {"PYTHONPATH": str(package), "PYTHONDONTWRITEBYTECODE": "1"} | unwritable
    done = subprocess.run([sys.executable, "-c", RUN], capture_output=True, text=True, env=environment)
    assert done.stdout.split() == ["False", "False", "6.0"], done.stderr


@pytest.mark.parametrize("value", ["1", "2"])
@pytest.mark.parametrize("command", [["run", "strip"], ["law", "exponential"]])
def test_compiling_nothing_is_refused(value: str, command: list[str], tmp_path: Path) -> None:
    script = "import sys; from isopeel.cli import main; sys.exit(main())"
    environment = os.environ | {"NUMBA_DISABLE_JIT": value}
    done = subprocess.run(
        [sys.executable, "-c", script, *command],
        capture_output=True,
        text=True,
        env=environment,
        cwd=tmp_path,
    )
    assert done.returncode == 2
    assert "NUMBA_DISABLE_JIT" in done.stderr
    assert done.stderr.count("\n") == 1
