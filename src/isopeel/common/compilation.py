"""Compilation of functions, with a cache on the disk that is valid until a source of the package changes.

Numba's cache of a function is valid until the file of the function changes. But the functions that it calls,
which may be in other files, are compiled into it. So the cached functions of a file are removed when any
source file changes in the layers that contain compiled functions. Changes of docstrings and comments do not
count, but in the file itself.
"""

import ast
import os
from collections.abc import Callable, Iterator
from functools import cache
from hashlib import sha256
from pathlib import Path
from types import FunctionType
from typing import Any, TypeVar, cast

# Numba reads settings from the current folder, which anybody may have written: settings that name code to run
# are set to their defaults here
os.environ.setdefault("NUMBA_CACHE_DIR", "")
os.environ.setdefault("NUMBA_CACHE_LOCATOR_CLASSES", "")

from numba import cfunc, config, njit

if vars(config)["DISABLE_JIT"]:
    from isopeel.common.errors import InputError

    raise InputError("NUMBA_DISABLE_JIT", 1, "compiled functions call each other; unset it")

Function = TypeVar("Function", bound=Callable[..., Any])

#: The places of compiled functions and of the constants that they read; a test checks that there are no
#: others.
COMPILED = ("common/arrays.py", "common/compilation.py", "splines", "physics", "matrix", "assembly", "solve")

#: For formulas: a division by zero gives inf or nan, which the solver detects and reports.
EXACT: dict[str, Any] = {"error_model": "numpy"}
#: For long sums: reordered, they are compiled to SIMD instructions. nan must stay nan, because it marks
#: inverted elements.
REORDERED: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract", "reassoc", "nsz"}}


#: Without code by which compiled functions are called through their address.
_NO_ADDRESS: dict[str, Any] = {"no_cfunc_wrapper": True}
#: Without code by which they are called from Python, too: it takes up to half of their compilation.
_INNER: dict[str, Any] = {**_NO_ADDRESS, "no_cpython_wrapper": True}


def compiled(function: Function) -> Function:
    """Return a function that is compiled when it is first called, with sums in their order."""
    return cast("Function", njit(cache=can_cache(function), **EXACT, **_NO_ADDRESS)(function))


def compiled_reordered(function: Function) -> Function:
    """Return a function that is compiled when it is first called, with sums in any order."""
    return cast("Function", njit(cache=can_cache(function), **REORDERED, **_NO_ADDRESS)(function))


def inner(function: Function) -> Function:
    """Return a function for compiled functions to call, with sums in their order; Python must not call it."""
    return cast("Function", njit(cache=can_cache(function), **EXACT, **_INNER)(function))


def inner_reordered(function: Function) -> Function:
    """Return a function for compiled functions to call, with sums in any order; Python must not call it."""
    return cast("Function", njit(cache=can_cache(function), **REORDERED, **_INNER)(function))


def inner_of_text(function: Callable[..., Any]) -> Any:
    """Return a function of a source text for compiled functions to call; it is compiled in each process."""
    return njit(**_INNER)(function)


def inlined(function: Function) -> Function:
    """Return a function that becomes a part of the compiled functions that call it, with their options."""
    return cast("Function", njit(inline="always", **EXACT)(function))


def compiled_now(
    signature: Any, function: Callable[..., Any], options: dict[str, Any], *, keep: bool = True
) -> Any:
    """Return a compiled function with an `address`, by which other compiled code may call it."""
    return cfunc(signature, cache=keep and can_cache(function), **options)(function)


def specialized(function: Function, name: str, **constants: object) -> Function:
    """Return a function to compile that reads other values of some global constants of its module.

    Code that these values exclude is not compiled.
    """
    other = FunctionType(function.__code__, {**function.__globals__, **constants}, name)
    # the cache distinguishes functions by this name
    other.__qualname__, other.__doc__ = name, function.__doc__
    return cast("Function", other)


def is_cached(function: Callable[..., Any]) -> bool:
    """Return whether a compiled function is in the cache."""
    folder = _folder(function)
    return folder is not None and any(folder.glob(f"{_module(function)}.{function.__name__}-*.nbi"))


def can_cache(function: Callable[..., Any]) -> bool:
    """Return whether a function can be cached.

    Cached functions of its file that were compiled from other sources are removed. The cache is beside the
    file or in the user's cache folder. If neither is writable, each process compiles the function in memory.
    """
    return _folder(function) is not None


#: Folders of Numba's cache by source files, None where there is none.
_FOLDERS: dict[str, Path | None] = {}


def _folder(function: Callable[..., Any]) -> Path | None:
    """Return the folder of Numba's cache for a function, without cached functions from other sources."""
    file = function.__code__.co_filename
    if file not in _FOLDERS:
        try:
            folder = Path(str(njit(cache=True)(function).stats.cache_path))
            _leave_out(folder, _module(function))
            _FOLDERS[file] = folder
        except (OSError, RuntimeError):  # RuntimeError: Numba finds no folder
            _FOLDERS[file] = None
    return _FOLDERS[file]


def _leave_out(folder: Path, module: str) -> None:
    noted = folder / f"{module}.isopeel"
    versions = noted.read_text().split() if noted.exists() else []
    if versions[:1] == [sources()]:
        return
    if versions[1:] != [statements()]:
        for kept in folder.glob(f"{module}.*.nb[ic]"):
            # another process may have been faster
            kept.unlink(missing_ok=True)
    folder.mkdir(parents=True, exist_ok=True)
    noted.write_text(f"{sources()} {statements()}")


def _module(function: Callable[..., Any]) -> str:
    """Return the beginning of the names of its files."""
    return Path(function.__code__.co_filename).stem


@cache
def sources() -> str:
    """Return the digest of all sources that are part of compiled functions."""
    digest = sha256()
    for file in _files():
        digest.update(file.read_bytes())
    return digest.hexdigest()


@cache
def statements() -> str:
    """Return the digest of the same sources without docstrings and comments, which takes longer."""
    digest = sha256()
    for file in _files():
        tree = ast.parse(file.read_bytes())
        for node in ast.walk(tree):
            documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
            if isinstance(node, documented) and ast.get_docstring(node, clean=False) is not None:
                del node.body[0]
        digest.update(ast.dump(tree).encode())
    return digest.hexdigest()


def _files() -> Iterator[Path]:
    package = Path(__file__).parents[1]
    for layer in COMPILED:
        path = package / layer
        yield from [path] if path.suffix else sorted(path.rglob("*.py"))
