"""What is compiled is kept, as long as no source of the package changes."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from isopeel.common import compilation

#: A function in one file, and one in another that it calls.
CALLER = """
from isopeel.common.compilation import compiled
from called import number

@compiled
def twice(x):
    return 2 * number(x)
"""
CALLED = """
from isopeel.common.compilation import compiled

@compiled
def number(x):
    return {} * x
"""
#: A source of the package.
NUMBER = '''
"""A module with {0} comment."""

class Number:
    """A class with {0} comment."""

    def value(self):
        """Return a number."""
        return {1}  # with {0} comment
'''
#: Prints whether the first is kept, what it returns, and whether it is kept then.
RUN = """
import isopeel.common.compilation as compilation
from caller import twice
kept = compilation.is_cached(twice.py_func)
print(kept, twice(1.0), compilation.is_cached(twice.py_func))
"""


@pytest.mark.parametrize("elsewhere", [False, True])
def test_a_compiled_function_is_used_until_a_source_file_changes(tmp_path: Path, elsewhere: bool) -> None:
    package, kept = tmp_path / "package" / "isopeel", tmp_path / "kept"
    for layer in ("common", "physics"):
        (package / layer).mkdir(parents=True)
    original = Path(__file__).parents[2] / "src" / "isopeel" / "common" / "compilation.py"
    (package / "__init__.py").touch()
    (package / "common" / "compilation.py").write_text(original.read_text())
    (package / "common" / "arrays.py").touch()
    (package.parent / "caller.py").write_text(CALLER)
    environment = os.environ | {"PYTHONPATH": str(package.parent)}
    if elsewhere:
        environment |= {"NUMBA_CACHE_DIR": str(kept)}

    def run(factor: int, comment: str = "the first") -> list[str]:
        # as a part of the package that the other one calls
        (package.parent / "called.py").write_text(CALLED.format(factor))
        (package / "physics" / "number.py").write_text(NUMBER.format(comment, factor))
        found = subprocess.run(
            [sys.executable, "-c", RUN], check=True, capture_output=True, text=True, env=environment
        )
        return found.stdout.split()

    assert run(3) == ["False", "6.0", "True"]
    assert run(3) == ["True", "6.0", "True"]
    assert run(3, "another") == ["True", "6.0", "True"]
    # Numba alone would go on with what it kept of the caller, which has not changed
    assert run(5) == ["False", "10.0", "True"]
    assert kept.exists() == elsewhere


def test_compiled_functions_stand_in_the_layers_whose_sources_are_watched() -> None:
    package = Path(compilation.__file__).parents[1]
    compiles = re.compile(
        r"^from isopeel.common.compilation import .*(compiled|inlined)|^(from|import) numba", re.M
    )
    files = [path for path in package.rglob("*.py") if compiles.search(path.read_text())]
    users = {path.relative_to(package).as_posix() for path in files}
    layers = {name if name.startswith("common/") else name.partition("/")[0] for name in users}
    assert layers == {"common/compilation.py", "physics", "matrix", "assembly", "solve"}
    assert layers < set(compilation.COMPILED)
