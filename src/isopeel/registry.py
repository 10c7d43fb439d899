"""Laws, materials, substrates, shapes and drives, found where their files are.

A frozen dataclass with a `name` in a module of a package is known by that name: nothing else has to be told
of a new file.
"""

from collections.abc import Mapping
from dataclasses import is_dataclass
from functools import cache
from importlib import import_module
from inspect import getmembers, isclass
from pkgutil import iter_modules
from types import MappingProxyType
from typing import Any


@cache
def discover(package: str) -> Mapping[str, type[Any]]:
    """Return the dataclasses that the modules of a package define with a `name`, sorted by that name.

    Raises ValueError where two have the same name.
    """
    found: dict[str, type[Any]] = {}
    for module in iter_modules(import_module(package).__path__, f"{package}."):
        for _, kind in getmembers(import_module(module.name), isclass):
            name = getattr(kind, "name", None)
            if kind.__module__ != module.name or not is_dataclass(kind) or not isinstance(name, str):
                continue
            if name in found:
                raise ValueError(
                    f"{kind.__qualname__} and {found[name].__qualname__} are both named {name!r}"
                )
            found[name] = kind
    return MappingProxyType(dict(sorted(found.items())))
