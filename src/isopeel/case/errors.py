"""What pydantic finds wrong with a case, as a user meets it."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from difflib import get_close_matches
from inspect import isclass
from typing import Any, get_args

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from isopeel.case import absent
from isopeel.case.kinds import KindSection
from isopeel.case.values import Needed, Section
from isopeel.common.errors import InputError


def first_error(error: ValidationError, document: Mapping[str, Any], case: type[Section]) -> InputError:
    """Translate the first error; unknown keys go first, since they explain the missing ones."""
    details = min(error.errors(), key=lambda details: details["type"] != "extra_forbidden")
    place, value = details["loc"], details["input"]
    cause = details.get("ctx", {}).get("error")
    if isinstance(cause, InputError):
        field = _in_list(cause.field, place, document)
        return InputError(field, written(document, field, cause.value), cause.allowed)
    field = _field(place, document)
    section, key = _key_at(place, document, case)
    match details["type"]:
        case "extra_forbidden":
            shown = f"[{field}]" if isinstance(value, Mapping) else value  # a table may be long
            return InputError(field, shown, _no_such_key(str(place[-1]), section))
        case "value_error":
            return InputError(field, value, str(cause))
        case "tuple_type" if isinstance(value, Mapping):
            table = ".".join(part for part in place if isinstance(part, str))
            return InputError(field, f"[{table}]", f"write [[{table}]], as a case may have several of them")
    needed = (_needed(key) if key else "") or f"a table [{field}] is needed"
    if details["type"] == "missing":
        return InputError(field, None, f"the key is missing; {needed}")
    return InputError(field, value, needed)


@contextmanager
def named_by(keys: Mapping[str, str]) -> Iterator[None]:
    """Name what is wrong by the keys of the case: with {"body": "body.2"}, body.length by body.2.length."""
    try:
        yield
    except InputError as error:
        raise renamed(error, keys) from error


def renamed(error: InputError, keys: Mapping[str, str]) -> InputError:
    """Return an error whose field is named by other keys, for the whole field or its table."""
    table, point, rest = error.field.partition(".")
    field = keys.get(error.field) or keys.get(table, table) + point + rest
    return InputError(field, error.value, error.allowed)


def written(document: Mapping[str, Any], field: str, value: object) -> object:
    """Return what the document holds at a field, where that is the text of the value."""
    found: Any = document
    for key in field.split("."):
        if isinstance(found, list):
            found = found[int(key) - 1] if key.isdigit() else None
        else:
            found = found.get(key) if isinstance(found, Mapping) else None
    tables = isinstance(found, list) and any(isinstance(one, Mapping) for one in found)
    return value if found is None or tables or isinstance(found, Mapping) else found


def _field(place: tuple[int | str, ...], document: Mapping[str, Any]) -> str:
    """Return the key at a place, with the number of the table from 1 on where there is a list of them."""
    several = place and isinstance(document.get(str(place[0])), list)
    return ".".join(
        str(part + 1) if isinstance(part, int) else part
        for number, part in enumerate(place)
        if isinstance(part, str) or (several and number == 1) or 1 < number < len(place) - 1
    )


def _in_list(field: str, place: tuple[int | str, ...], document: Mapping[str, Any]) -> str:
    """Return the key of a field of some table, as the class of its kind names it, where that is in a list."""
    table, _, key = field.partition(".")
    if not isinstance(document.get(str(place[0]) if place else table), list):
        return field
    if len(place) < 2:
        # without a number it is the only table of the list
        return field if not key or key[0].isdigit() else f"{table}.1.{key}"
    path = _field(place, document)
    return path if not key or path.endswith(f".{key}") else f"{path}.{key}"


def _key_at(
    place: tuple[int | str, ...], document: Mapping[str, Any], section: type[Section]
) -> tuple[type[Section], FieldInfo | None]:
    """Return the section of a place, of several kinds the one that its table chose, and the key there."""
    table: Any = document
    key: FieldInfo | None = None
    for number, part in enumerate(place, start=1):
        if isinstance(part, int):
            table = table[part] if isinstance(table, list) and part < len(table) else table
        elif part in section.model_fields:
            key = section.model_fields[part]
            table = table.get(part) if isinstance(table, Mapping) else None
            inner = _section_in(key.annotation)
            if inner is None:
                break
            section = inner
        else:
            break
        family = issubclass(section, KindSection) and section.maker is None
        if family and isinstance(table, Mapping) and number < len(place):
            section = section.chosen(table)  # type: ignore[attr-defined]
    return section, key


def _no_such_key(name: str, section: type[Section]) -> str:
    """Return what there is in place of an unknown key: other physics, the nearest key, and all keys."""
    if instead := absent.KEYS.get(name.lower().replace("-", "_")):
        return instead
    keys = list(section.model_fields)
    nearest = get_close_matches(name, keys, 1)
    hint = f"did you mean {nearest[0]}? " if nearest else ""
    return f"there is no such key; {hint}here the keys are {', '.join(keys)}"


def _needed(key: FieldInfo) -> str:
    """Return what is needed for a key, in words; an empty text where nothing says it."""
    return next((note.text for note in key.metadata if isinstance(note, Needed)), "")


def _section_in(annotation: Any) -> type[Section] | None:
    """Return the section in a type, such as a tuple of them or one or none; None where there is none."""
    if isclass(annotation) and issubclass(annotation, Section):
        return annotation
    return next(filter(None, map(_section_in, get_args(annotation))), None)
