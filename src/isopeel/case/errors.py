"""What pydantic finds wrong with a case, as a user meets it."""

from collections.abc import Mapping
from inspect import isclass
from typing import Any, get_args

from pydantic import ValidationError

from isopeel.case.kinds import KindSection
from isopeel.case.values import Section
from isopeel.common.errors import InputError


def first_error(error: ValidationError, document: Mapping[str, Any], case: type[Section]) -> InputError:
    """Translate the first error; unknown keys go first, since they explain the missing ones."""
    details = min(error.errors(), key=lambda details: details["type"] != "extra_forbidden")
    place, value = details["loc"], details["input"]
    cause = details.get("ctx", {}).get("error")
    if isinstance(cause, InputError):
        field = _numbered(cause.field, place, document)
        return InputError(field, written(document, field, cause.value), cause.allowed)
    path = [str(part) for part in place if isinstance(part, str)]
    field = _numbered(".".join(path), place, document)
    section = _section_at(place[:2], document, case) if len(path) > 1 else case
    match details["type"]:
        case "extra_forbidden":
            return InputError(
                field, value, f"there is no such key; here the keys are {', '.join(section.model_fields)}"
            )
        case "value_error":
            return InputError(field, value, str(cause))
    key = section.model_fields.get(path[min(1, len(path) - 1)])
    needed = (key.description if key else None) or f"a table [{field}] is needed"
    if details["type"] == "missing":
        return InputError(field, None, f"the key is missing; {needed}")
    return InputError(field, value, needed)


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


def _numbered(field: str, place: tuple[int | str, ...], document: Mapping[str, Any]) -> str:
    """Return the field, with the number of the stage from 1 on where there may be several."""
    if place[:1] == ("drive",) and len(place) > 1 and isinstance(document.get("drive"), list):
        return field.replace("drive", f"drive.{int(place[1]) + 1}", 1)
    return field


def _section_at(
    place: tuple[int | str, ...], document: Mapping[str, Any], case: type[Section]
) -> type[Section]:
    """Return the section of a table: where there are several kinds, the one that the table chose."""
    key, number = str(place[0]), place[1]
    annotation = case.model_fields[key].annotation
    candidates = [kind for kind in (annotation, *get_args(annotation)) if isclass(kind)]
    section: type[Section] = next(kind for kind in candidates if issubclass(kind, Section))
    if not issubclass(section, KindSection):
        return section
    table = document.get(key, {})
    return section.chosen(table[int(number)] if isinstance(table, list) else table)
