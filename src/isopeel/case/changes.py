"""Other values for keys of a case, by their dotted names, such as `drive.2.to` for the second stage."""

import re
import tomllib
from collections.abc import Mapping
from typing import Any

import numpy as np

from isopeel.case.text import MOST_PARTS
from isopeel.common.errors import InputError

_PART = re.compile(r"[A-Za-z0-9_-]{1,100}")
#: What an assignment on the command line looks like.
ASSIGNMENT = "it is KEY=VALUE, such as adhesion.work_of_adhesion='0.05 J/m^2'"


def changed(document: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """Return a copy of the tables of a case with other values of keys; None leaves a key out.

    Raises InputError, whose field is the key, where there is no such place in the document.
    """
    tables: Any = dict(document)
    for key, value in values.items():
        parts = key.split(".")
        if len(parts) > MOST_PARTS or not all(_PART.fullmatch(part) for part in parts):
            raise InputError(key or "key", value, "a key is a dotted name, such as body.length")
        tables = _with(tables, parts, _plain(key, value), key)
    return dict(tables)


def value_of(document: Mapping[str, Any], key: str) -> Any:
    """Return the value of a key of a case. Raises InputError, whose field is the key, where there is none."""
    found: Any = document
    for name in key.split("."):
        if isinstance(found, list) and re.fullmatch("[1-9][0-9]{0,5}", name) and int(name) <= len(found):
            found = found[int(name) - 1]
        elif isinstance(found, Mapping) and name in found:
            found = found[name]
        else:
            raise InputError(key or "key", None, f"the case states no {name!r} there; state it in the case")
    return found


def _with(table: Any, parts: list[str], value: Any, key: str) -> Any:
    """Return a copy of a table, or of a list of tables, with another value at the end of a way of names."""
    name, *rest = parts
    if isinstance(table, list):
        number = int(name) if re.fullmatch("[0-9]{1,6}", name) else 0
        if not 0 < number <= len(table):
            allowed = (
                f"the case has {len(table)} tables there; give the number of one, from 1 to {len(table)}"
            )
            raise InputError(key, value, allowed)
        item = _with(table[number - 1], rest, value, key) if rest else value
        return [*table[: number - 1], item, *table[number:]]
    if not isinstance(table, Mapping):
        raise InputError(key, value, f"there is no key {name!r} in {table!r}, which is no table")
    if value is None and name not in table:
        return dict(table)
    if rest:
        return {**table, name: _with(table.get(name, {}), rest, value, key)}
    if value is None:
        return {known: of_known for known, of_known in table.items() if known != name}
    return {**table, name: value}


def _plain(key: str, value: Any) -> Any:
    """Return a value of kinds that TOML has; numbers of NumPy are those of Python."""
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, list | tuple):
        return [_plain(key, one) for one in value]
    if isinstance(value, Mapping):
        return {str(name): _plain(key, one) for name, one in value.items()}
    if value is not None and not isinstance(value, str | int | float):
        raise InputError(key, value, "a text, a number, true or false, a list or a table is needed")
    return value


def assignment(text: str) -> tuple[str, Any]:
    """Read KEY=VALUE of a command line: the value as TOML has it, else a text; None where it is empty.

    Raises InputError whose field is --set.
    """
    key, equals, written = text.partition("=")
    if not equals or not key.strip():
        raise InputError("--set", text, ASSIGNMENT)
    written = written.strip()
    try:
        found = tomllib.loads(f"value = {written}")
    except (ValueError, RecursionError):
        found = {}
    # a text with a line of its own could bring more keys
    value = found["value"] if set(found) == {"value"} else written
    return key.strip(), None if written == "" else value
