"""The registry of laws, materials, substrates, shapes and drives, which finds them by their files.

A frozen dataclass with a `name` in a module of a package is registered by that name; nothing else refers to a
new file. Plug-ins are in folders that the environment variable ISOPEEL_PLUGINS names, each in a subfolder
with the name of its package, such as `adhesion` or `shapes`.
"""

import os
from collections.abc import Mapping, Sequence
from dataclasses import is_dataclass
from functools import cache
from importlib import import_module
from inspect import getmembers, isclass
from pathlib import Path
from pkgutil import iter_modules
from traceback import extract_tb
from types import MappingProxyType, ModuleType
from typing import Any

from isopeel.common.errors import InputError

#: The environment variable with the folders of plug-ins. A case cannot name such folders: it is data, and
#: runs no code.
PLUG_INS = "ISOPEEL_PLUGINS"


@cache
def discover(package: str) -> Mapping[str, type[Any]]:
    """Return the dataclasses that the modules of a package define with a `name`, sorted by that name.

    Raises InputError if two have the same name, if a folder of plug-ins does not exist, or if Python cannot
    run a file in it.
    """
    home = import_module(package)
    folders = _plug_in_folders(package.rpartition(".")[2])
    # so that classes in these files can be imported by name, and pickled
    home.__path__ = [*home.__path__, *folders]
    found: dict[str, type[Any]] = {}
    for module in iter_modules(home.__path__, f"{package}."):
        for _, kind in getmembers(_imported(module.name, folders), isclass):
            name = getattr(kind, "name", None)
            if kind.__module__ != module.name or not is_dataclass(kind) or not isinstance(name, str):
                continue
            if name in found:
                allowed = f"{kind.__qualname__} and {found[name].__qualname__} are both named {name!r}"
                raise InputError("name", name, allowed)
            found[name] = kind
    return MappingProxyType(dict(sorted(found.items())))


def _imported(module: str, folders: Sequence[str]) -> ModuleType:
    """Import a module; a plug-in raises InputError with the line that Python cannot run."""
    try:
        return import_module(module)
    except Exception as error:
        files = [Path(folder) / f"{module.rpartition('.')[2]}.py" for folder in folders]
        file = next((file for file in files if file.exists()), None)
        if file is None:
            raise
        lines = [frame.lineno for frame in extract_tb(error.__traceback__) if frame.filename == str(file)]
        reason = str(error)
        if isinstance(error, SyntaxError):
            lines, reason = [error.lineno] if error.lineno else [], error.msg
        place = f" in line {lines[-1]}" if lines else ""
        raise InputError(PLUG_INS, str(file), f"{type(error).__name__}{place}: {reason}") from error


def _plug_in_folders(kind: str) -> list[str]:
    named = os.environ.get(PLUG_INS, "")
    folders = [Path(folder).absolute() for folder in named.split(os.pathsep) if folder]
    for folder in folders:
        if not folder.is_dir():
            allowed = "it must be the path of folders that have subfolders such as adhesion and shapes"
            raise InputError(PLUG_INS, named, allowed)
    return [str(folder / kind) for folder in folders]
