"""The JSON schema of a case, made from the reference of its keys, for editors and other programs.

It is weaker than the check of a case: it does not know the dimension of a quantity, the range of most
numbers, and what excludes what.
"""

from collections.abc import Iterable
from typing import Any

from isopeel.case.boundaries import BoundaryTable
from isopeel.case.kinds import KindSection
from isopeel.case.reference import FAMILIES, PARTS, KeyEntry, Value, keys_of, tables
from isopeel.case.values import Section

DRAFT = "http://json-schema.org/draft-07/schema#"
#: A number and a unit, in any of the forms of `isopeel.common.units`; the unit has a letter.
QUANTITY = r"^\s*[-+]?([0-9]+\.?[0-9]*|\.[0-9]+).*[A-Za-zµμ°].*$"


def case_schema() -> dict[str, Any]:
    """Return the schema: one of the forms of one body and of several, with the keys of all cases."""
    return {
        "$schema": DRAFT,
        "title": "A case of isopeel",
        "anyOf": [_form("one body"), _form("several bodies")],
    }


def _form(part: str) -> dict[str, Any]:
    """Return the schema of one form of a case."""
    own, *general = tables("general")
    properties = {key.name: _key(key) for key in own.keys}
    required = [key.name for key in own.keys if key.is_required]
    for (name, header, section), table in zip(
        (*PARTS["general"], *PARTS[part]), (*general, *tables(part)), strict=True
    ):
        if "." in name:
            continue  # a table in another one, which has it as a key
        each = _section(section)
        if header.startswith("[["):
            each = {"type": "array", "minItems": 1, "items": each}
        elif name == "drive":
            each = {"anyOf": [each, {"type": "array", "minItems": 1, "items": each}]}
        properties[table.name] = each
    required += ["body", "material", "adhesion"] if part == "one body" else ["body"]
    return {
        "title": f"A case of {part}",
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": False,
    }


def _section(section: type[Section]) -> dict[str, Any]:
    """Return the schema of a table; of a family that of one of its kinds."""
    if not issubclass(section, KindSection):
        return _object(keys_of(section))
    families = [one for one in FAMILIES if issubclass(section, one.section)]
    _, *common = keys_of(section)
    choices = []
    for family in families:
        for kind in family.kinds:
            name = {"const": kind.name, "description": kind.meaning}
            keys = (*common, *kind.keys)
            required = [] if kind.name == section.usual else [section.chooser]
            choices.append(_object(keys, {section.chooser: name}, required))
    return {"anyOf": choices}


def _object(
    keys: Iterable[KeyEntry], more: dict[str, Any] | None = None, required: Iterable[str] = ()
) -> dict[str, Any]:
    keys = list(keys)
    return {
        "type": "object",
        "properties": (more or {}) | {key.name: _key(key) for key in keys},
        "required": [*required, *(key.name for key in keys if key.is_required)],
        "additionalProperties": False,
    }


def _key(key: KeyEntry) -> dict[str, Any]:
    text = f"{key.meaning}. Default: {key.default}" if not key.is_required else key.meaning
    found = {"description": text.replace("`", "")} | _value(key.value)
    return found if key.example is None else found | {"examples": [key.example]}


def _value(value: Value) -> dict[str, Any]:
    match value.kind:
        case "quantity":
            text = {"type": "string", "pattern": QUANTITY}
            number = {"type": "number", "minimum": 0, "maximum": 1}
            return {"anyOf": [text, number]} if any(one.is_number for one in value.dimensions) else text
        case "number":
            return {"type": "number"}
        case "whole":
            return {"type": "integer"} | {
                name: limit
                for name, limit in (("minimum", value.least), ("maximum", value.most))
                if limit is not None
            }
        case "flag":
            return {"type": "boolean"}
        case "choice":
            return {"enum": list(value.choices)}
        case "list":
            items = [_value(item) for item in value.items]
            return {"type": "array", "items": items, "minItems": len(items), "maxItems": len(items)}
        case "table":
            return _table(value.section)
        case "tables":
            return {"type": "array", "minItems": 1, "items": _table(value.section)}
        case "constants":
            return {"type": "object", "additionalProperties": {"type": ["number", "string"]}}
    return {"type": "string"} | ({"pattern": value.pattern} if value.pattern else {})


def _table(section: type[Section] | None) -> dict[str, Any]:
    """Return the schema of a table in a table; the side of an interface may be a text, too."""
    assert section is not None
    found = _section(section)
    return {"anyOf": [{"type": "string"}, found]} if section is BoundaryTable else found
