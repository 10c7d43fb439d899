"""Laws, materials, substrates, shapes and drives, found where their files are.

A frozen dataclass with a `name` in a module of a package is known by that name: nothing else has to be told
of a new file. Files of one's own lie in folders that the environment variable ISOPEEL_PARTS names, each in
a subfolder that has the name of its package's last part, such as `adhesion` or `shapes`.
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

#: The environment variable. A case cannot name such folders: it is data, and runs no code of anyone's.
OWN_PARTS = "ISOPEEL_PARTS"


@cache
def discover(package: str) -> Mapping[str, type[Any]]:
    """Return the dataclasses that the modules of a package define with a `name`, sorted by that name.

    Raises InputError where two have the same name, where a folder of one's own parts does not exist, or where
    Python cannot run a file in it.
    """
    home = import_module(package)
    own = _own_folders(package.rpartition(".")[2])
    # so that what is in these files can be imported, and sent to another process, by its name
    home.__path__ = [*home.__path__, *own]
    found: dict[str, type[Any]] = {}
    for module in iter_modules(home.__path__, f"{package}."):
        for _, kind in getmembers(_imported(module.name, own), isclass):
            name = getattr(kind, "name", None)
            if kind.__module__ != module.name or not is_dataclass(kind) or not isinstance(name, str):
                continue
            if name in found:
                allowed = f"{kind.__qualname__} and {found[name].__qualname__} are both named {name!r}"
                raise InputError("name", name, allowed)
            found[name] = kind
    return MappingProxyType(dict(sorted(found.items())))


def _imported(module: str, own: Sequence[str]) -> ModuleType:
    """Import a module; one of the own folders raises InputError with the line that Python cannot run."""
    try:
        return import_module(module)
    except Exception as error:
        files = [Path(folder) / f"{module.rpartition('.')[2]}.py" for folder in own]
        file = next((file for file in files if file.exists()), None)
        if file is None:
            raise
        lines = [frame.lineno for frame in extract_tb(error.__traceback__) if frame.filename == str(file)]
        reason = str(error)
        if isinstance(error, SyntaxError):
            lines, reason = [error.lineno] if error.lineno else [], error.msg
        place = f" in line {lines[-1]}" if lines else ""
        raise InputError(OWN_PARTS, str(file), f"{type(error).__name__}{place}: {reason}") from error


def _own_folders(kind: str) -> list[str]:
    named = os.environ.get(OWN_PARTS, "")
    folders = [Path(folder).absolute() for folder in named.split(os.pathsep) if folder]
    for folder in folders:
        if not folder.is_dir():
            allowed = "it names folders, with subfolders such as adhesion and shapes in them"
            raise InputError(OWN_PARTS, named, allowed)
    return [str(folder / kind) for folder in folders]
