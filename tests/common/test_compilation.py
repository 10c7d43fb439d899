"""What is compiled is kept, as long as no source of the package changes."""

import ast
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from numba import njit
from numba.core.errors import TypingError

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
        r"^from isopeel.common.compilation import .*(compiled|inlined|inner)|^(from|import) numba", re.M
    )
    files = [path for path in package.rglob("*.py") if compiles.search(path.read_text())]
    users = {path.relative_to(package).as_posix() for path in files}
    layers = {name if name.startswith("common/") else name.partition("/")[0] for name in users}
    assert layers == {"common/compilation.py", "physics", "matrix", "assembly", "solve"}
    assert layers < set(compilation.COMPILED)


def test_only_compiled_functions_call_inner_functions() -> None:
    # Python would jump to code that does not exist
    package = Path(compilation.__file__).parents[1]
    trees = {path: ast.parse(path.read_text()) for path in package.rglob("*.py")}
    functions = [
        (path, node)
        for path, tree in trees.items()
        for node in tree.body
        if isinstance(node, ast.FunctionDef)
    ]

    def marks(function: ast.FunctionDef) -> set[str]:
        return {ast.unparse(mark) for mark in function.decorator_list}

    inner = {(path, node.name) for path, node in functions if marks(node) & {"inner", "inner_reordered"}}
    assert len(inner) > 20
    compiles = {"compiled", "compiled_reordered", "inlined", "inner", "inner_reordered"}
    for path, tree in trees.items():
        imported = {
            (package.parent / f"{str(node.module).replace('.', '/')}.py", alias.name)
            for node in ast.walk(tree)
            if isinstance(node, ast.ImportFrom)
            for alias in node.names
        }
        known = {name for file, name in inner if file == path or (file, name) in imported}
        # the loops of terms are compiled without a mark
        calling = [
            node.name
            for node in ast.walk(tree)
            if isinstance(node, ast.FunctionDef) and not marks(node) & compiles and "add_" not in node.name
            for call in ast.walk(node)
            if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id in known
        ]
        assert not calling, path


SIZE = 3.0


def times(x: float) -> float:
    if SIZE > 1:
        return SIZE * x
    return unknown(x)  # type: ignore[name-defined, no-any-return]  # noqa: F821


def test_code_that_constants_exclude_is_not_compiled() -> None:
    other = compilation.specialized(times, "five_times", SIZE=5.0)
    run: Any = njit
    assert run(other)(2.0) == 10.0
    assert other.__name__ == other.__qualname__ == "five_times"
    with pytest.raises(TypingError, match="unknown"):
        run(compilation.specialized(times, "less", SIZE=1.0))(2.0)
