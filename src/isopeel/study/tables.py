"""TOML files that name a case: their text, and what is wrong with their tables."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, ValidationError

from isopeel.case import Case, load_case, shipped_cases
from isopeel.case.values import Section
from isopeel.common.errors import InputError

_LARGEST_FILE = 50_000  # bytes
_NAME = r"^[A-Za-z0-9][A-Za-z0-9._-]{0,99}$"


class OfCase(Section):
    """The keys of each file that names a case: a name of its own, the case, and other values of its keys."""

    name: Annotated[
        str, Field(pattern=_NAME, description="a name of letters, digits, '.', '_' and '-' is needed")
    ]
    case: Annotated[str, Field(description="a shipped case, or the path of a TOML file, is needed")]
    set: Annotated[
        dict[str, Any],
        Field(default_factory=dict, description="a table of keys of the case and their values is needed"),
    ]


def text_of(path: Path, field: str, what: str) -> str:
    """Return the text of the TOML file of `what`, such as a study. Raises InputError for a field."""
    try:
        if not path.is_file():
            kind = "is no file" if path.exists() else "does not exist"
            raise InputError(field, str(path), f"it {kind}; the TOML file of a {what} is needed")
        with path.open("rb") as file:
            content = file.read(_LARGEST_FILE + 1)
        if len(content) > _LARGEST_FILE:
            raise InputError(field, str(path), f"a {what} has at most {_LARGEST_FILE} bytes")
        return content.decode().replace("\r\n", "\n")
    except OSError as error:
        raise InputError(field, str(path), f"it cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise InputError(field, str(path), "a TOML file is UTF-8 text") from error


def case_of(name: str, values: Mapping[str, Any], folder: Path) -> Case:
    """Return the case of a key `case` with the values of a table `set`.

    The case is a shipped one, or a file as it is seen from a folder. Raises InputError for these keys.
    """
    try:
        base = load_case(name if name in shipped_cases() else folder / name)
    except InputError as error:
        field = "case" if error.field == "CASE" else f"case {name}, {error.field}"
        raise InputError(field, error.value, error.allowed) from error
    return with_set_values(base, values)


def with_set_values(base: Case, values: Mapping[str, Any]) -> Case:
    """Return a case with the values of a table `set`. Raises InputError for its keys."""
    try:
        return base.with_values(values)
    except InputError as error:
        raise InputError(f"set.{error.field}", error.value, error.allowed) from error


def first_error(
    error: ValidationError, whole: type[Section], parts: Mapping[str, type[Section]]
) -> InputError:
    """Translate the first error in a file whose tables are `parts`; the places of their lists count from one.

    Unknown keys go first, since they explain the missing ones.
    """
    details = min(error.errors(), key=lambda details: details["type"] != "extra_forbidden")
    place = [part + 1 if isinstance(part, int) else part for part in details["loc"]]
    field = ".".join(map(str, place))
    is_whole_part = len(place) == 1 or (len(place) == 2 and isinstance(place[1], int))
    table: Any = whole if is_whole_part else parts.get(str(place[0]), whole)
    keys = {info.alias or name: info for name, info in table.model_fields.items()}
    if details["type"] == "extra_forbidden":
        return InputError(
            field, details["input"], f"there is no such key; here the keys are {', '.join(keys)}"
        )
    known = next((keys[str(part)] for part in reversed(place) if str(part) in keys), None)
    needed = (known.description if known else None) or "a table is needed"
    if details["type"] == "missing":
        return InputError(field, None, f"the key is missing; {needed}")
    return InputError(field, details["input"], needed)
