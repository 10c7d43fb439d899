"""Compilation of functions, which is kept from run to run as long as the package stays the same.

Numba keeps a compiled function until the file changes that it stands in. But what it calls, which may stand
in another one, is part of it. So what is kept of a file is removed once any source changes of the layers in
which compiled functions stand.
"""

import os
from collections.abc import Callable
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar, cast

# Numba reads settings in the folder that a process runs in, whoever has put them there: those of them that
# name code to run are set here, to what they are without
os.environ.setdefault("NUMBA_CACHE_DIR", "")
os.environ.setdefault("NUMBA_CACHE_LOCATOR_CLASSES", "")

from numba import cfunc, config, njit

if vars(config)["DISABLE_JIT"]:
    from isopeel.common.errors import InputError

    raise InputError("NUMBA_DISABLE_JIT", 1, "compiled functions call each other; unset it")

Function = TypeVar("Function", bound=Callable[..., Any])

#: Where compiled functions stand, and what these read; a test holds that they stand nowhere else.
COMPILED = ("common/arrays.py", "common/compilation.py", "splines", "physics", "matrix", "assembly", "solve")

#: For formulas: a division by zero gives inf or nan, which the solver detects and reports.
EXACT: dict[str, Any] = {"error_model": "numpy"}
#: For long sums: reordered, they run in vector registers; nan must stay nan, because it is how an inverted
#: element is noticed.
REORDERED: dict[str, Any] = {"error_model": "numpy", "fastmath": {"contract", "reassoc", "nsz"}}


def compiled(function: Function) -> Function:
    """Compile a function when it is first called, with sums in their order."""
    return cast("Function", njit(cache=keeps(function), **EXACT)(function))


def compiled_reordered(function: Function) -> Function:
    """Compile a function when it is first called, with sums in any order."""
    return cast("Function", njit(cache=keeps(function), **REORDERED)(function))


def compiled_now(
    signature: Any, function: Callable[..., Any], options: dict[str, Any], *, keep: bool = True
) -> Any:
    """Compile a function to code with an `address`, by which other compiled code may call it."""
    return cfunc(signature, cache=keep and keeps(function), **options)(function)


def is_kept(function: Callable[..., Any]) -> bool:
    """Return whether a function is there in compiled form."""
    return keeps(function) and any(_folder(function).glob(f"{_module(function)}.{function.__name__}-*.nbi"))


def keeps(function: Callable[..., Any]) -> bool:
    """Return whether a function is kept once it is compiled.

    What was kept of its file with other sources is removed. The place is beside the file or in the user's
    cache folder. Where neither can be written to, it is compiled in memory, anew in each process.
    """
    try:
        _leave_out(_folder(function), _module(function), sources())
    except (OSError, RuntimeError):  # RuntimeError: Numba finds no folder
        return False
    return True


@cache
def _leave_out(folder: Path, module: str, version: str) -> None:
    noted = folder / f"{module}.isopeel"
    if noted.exists() and noted.read_text() == version:
        return
    for kept in folder.glob(f"{module}.*.nb[ic]"):
        # another process may have been faster
        kept.unlink(missing_ok=True)
    folder.mkdir(parents=True, exist_ok=True)
    noted.write_text(version)


def _folder(function: Callable[..., Any]) -> Path:
    """Where Numba keeps a function."""
    return Path(str(njit(cache=True)(function).stats.cache_path))


def _module(function: Callable[..., Any]) -> str:
    """What the names of its files begin with."""
    return Path(function.__code__.co_filename).stem


@cache
def sources() -> str:
    """Return the digest of all sources that are part of compiled functions."""
    package, digest = Path(__file__).parents[1], sha256()
    for layer in COMPILED:
        path = package / layer
        for file in [path] if path.suffix else sorted(path.rglob("*.py")):
            digest.update(file.read_bytes())
    return digest.hexdigest()
