"""The reference of all keys of a case, read from its sections: meaning, value, default, range and example."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from inspect import isclass
from math import degrees
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Literal, TypeAlias, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from isopeel.case.bodies import BodyTable
from isopeel.case.boundaries import BoundaryTable, SupportTable
from isopeel.case.case import Case
from isopeel.case.drives import DrivenTable, DriveSection, LoadTable
from isopeel.case.interfaces import InterfaceTable
from isopeel.case.kinds import KindSection
from isopeel.case.sections import (
    AdhesionSection,
    BodySection,
    DiscretizationSection,
    HeldSection,
    MaterialSection,
    OutputSection,
    ReadingSection,
    SubstrateSection,
    UnitsSection,
)
from isopeel.case.ties import TieTable
from isopeel.case.values import Section
from isopeel.common.quantities import Dimension, Limit
from isopeel.common.registry import discover

ValueKind: TypeAlias = Literal[
    "quantity", "number", "whole", "flag", "text", "choice", "file", "list", "table", "tables", "constants"
]
_PLAIN: dict[Any, ValueKind] = {bool: "flag", int: "whole", float: "number", str: "text", Path: "file"}


@dataclass(frozen=True)
class Value:
    """What a key may be: a quantity of one of some dimensions, a choice, a list of values, a table, ..."""

    kind: ValueKind
    dimensions: tuple[Dimension, ...] = ()
    choices: tuple[str, ...] = ()
    items: tuple["Value", ...] = ()
    section: type[Section] | None = None
    pattern: str = ""
    least: int | None = None
    most: int | None = None

    @property
    def words(self) -> str:
        """The value in words."""
        match self.kind:
            case "quantity" | "number" if self.dimensions:
                return " or ".join(one.needed.split(" is needed")[0] for one in self.dimensions)
            case "choice":
                return ", ".join(f'`"{choice}"`' for choice in self.choices)
            case "table" if self.section is BoundaryTable:
                return "BODY.SIDE or a table"
            case "list":
                return f"a list of {len(self.items)}, each {self.items[0].words}"
        words = {
            "number": "a number",
            "whole": "a whole number",
            "flag": "`true` or `false`",
            "text": "a text",
            "file": "a path",
            "table": "a table",
            "tables": "tables",
            "constants": "a table of numbers and quantities",
        }
        return words[self.kind]


@dataclass(frozen=True)
class KeyEntry:
    """A key: its name, its value, what it means, its default and range in words, and an example."""

    name: str
    value: Value
    meaning: str
    default: str
    allowed: str = ""
    see: str = ""
    example: Any = None

    @property
    def is_required(self) -> bool:
        """Whether a case must have it wherever it has the table."""
        return self.default == "required"


@dataclass(frozen=True)
class TableEntry:
    """A table of a case, such as `[units]`, or each of a list, such as `[[body]]`: its keys."""

    name: str
    header: str
    keys: tuple[KeyEntry, ...]


@dataclass(frozen=True)
class KindEntry:
    """One kind of a table that chooses one, such as the law `bilinear`: its keys."""

    name: str
    meaning: str
    keys: tuple[KeyEntry, ...]


@dataclass(frozen=True)
class FamilyEntry:
    """The kinds of a table: the key that chooses one, and the kinds."""

    title: str
    chooser: str
    section: type[KindSection]
    packages: tuple[str, ...]

    @property
    def tables(self) -> tuple[str, ...]:
        """The tables that have one of the kinds."""
        table = self.chooser.partition(".")[0]
        return (table, "interface") if table == "adhesion" else (table,)

    @property
    def kinds(self) -> tuple[KindEntry, ...]:
        """The kinds of the packages, sorted by their names."""
        found = {name: kind for package in self.packages for name, kind in discover(package).items()}
        return tuple(_kind(self.section, name, maker) for name, maker in sorted(found.items()))


#: Tables of all cases, of one body, and of several.
GENERAL: tuple[tuple[str, str, type[Section]], ...] = (
    ("units", "[units]", UnitsSection),
    ("discretization", "[discretization]", DiscretizationSection),
    ("drive", "[drive]", DriveSection),
    ("drive.on", "[[drive.on]]", DrivenTable),
    ("load", "[[load]]", LoadTable),
    ("reading", "[reading]", ReadingSection),
    ("output", "[output]", OutputSection),
)
ONE_BODY: tuple[tuple[str, str, type[Section]], ...] = (
    ("body", "[body]", BodySection),
    ("material", "[material]", MaterialSection),
    ("adhesion", "[adhesion]", AdhesionSection),
    ("substrate", "[substrate]", SubstrateSection),
    ("held", "[held]", HeldSection),
)
SEVERAL_BODIES: tuple[tuple[str, str, type[Section]], ...] = (
    ("body", "[[body]]", BodyTable),
    ("interface", "[[interface]]", InterfaceTable),
    ("tie", "[[tie]]", TieTable),
    ("support", "[[support]]", SupportTable),
)
FAMILIES = (
    FamilyEntry("Shapes", "body.shape", BodySection, BodySection.packages),
    FamilyEntry("Materials", "material.law", MaterialSection, MaterialSection.packages),
    FamilyEntry("Adhesion laws", "adhesion.law", AdhesionSection, AdhesionSection.packages),
    FamilyEntry("Joint laws", "interface.law", InterfaceTable, ("isopeel.physics.joints",)),
    FamilyEntry("Substrates", "substrate.kind", SubstrateSection, SubstrateSection.packages),
    FamilyEntry("Drives", "drive.kind", DriveSection, DriveSection.packages),
)


#: The parts of the reference: all cases, those of one body, and those of several.
PARTS = {"general": GENERAL, "one body": ONE_BODY, "several bodies": SEVERAL_BODIES}


@cache
def tables(part: str) -> tuple[TableEntry, ...]:
    """Return the tables of one of the PARTS, each with the keys that do not depend on its kind."""
    found = [TableEntry(name, header, keys_of(section)) for name, header, section in PARTS[part]]
    if part == "general":
        own = tuple(_entry(name, Case.model_fields[name]) for name in ("name", "about"))
        found.insert(0, TableEntry("", "", own))
    return tuple(found)


@cache
def keys_of(section: type[Section]) -> tuple[KeyEntry, ...]:
    """Return the keys of a section; of a family the one that chooses, and those of all of its kinds."""
    keys = [_entry(name, field) for name, field in section.model_fields.items()]
    if issubclass(section, KindSection) and section.maker is None:
        kinds = sorted({name for package in section.packages for name in discover(package)})
        default = "required" if section.usual is None else f'`"{section.usual}"`'
        value = Value("choice", choices=tuple(kinds))
        meaning = f"the {section.chooser}, with keys of its own"
        keys.insert(
            0,
            KeyEntry(section.chooser, value, meaning, default, example=section.usual or section.example_kind),
        )
    return tuple(keys)


def kind_section(family: type[KindSection], name: str) -> type[KindSection]:
    """Return the section of a kind of a family."""
    return family.chosen({family.chooser: name})


def _kind(family: type[KindSection], name: str, maker: type[Any]) -> KindEntry:
    section = kind_section(family, name)
    others = {family.chooser, *family.model_fields}
    own = [_entry(key, field) for key, field in section.model_fields.items() if key not in others]
    return KindEntry(name, _first_sentence(maker), tuple(own))


def _first_sentence(maker: type[Any]) -> str:
    """Return the first sentence of the module of a kind, which is short and has no formula."""
    text = sys.modules[maker.__module__].__doc__ or maker.__doc__ or ""
    return " ".join(text.split()).split(". ")[0].rstrip(".")


def _entry(name: str, field: FieldInfo) -> KeyEntry:
    extra: Any = field.json_schema_extra or {}
    value = value_of(field.annotation, field.metadata)
    return KeyEntry(
        name,
        value,
        field.description or "",
        str(extra.get("usual") or ("required" if field.is_required() else _shown(field, value))),
        _allowed(value, field.metadata),
        str(extra.get("see", "")),
        (field.examples or [None])[0],
    )


def value_of(annotation: Any, notes: Sequence[Any] = ()) -> Value:
    """Return the value of a type of a key, with the notes that it is annotated with."""
    if get_origin(annotation) is Annotated:
        plain, *own = get_args(annotation)
        return value_of(plain, [*own, *notes])
    dimensions = tuple(note for note in notes if isinstance(note, Dimension))
    if any(not one.is_number for one in dimensions) and get_origin(annotation) is not tuple:
        return Value("quantity", dimensions)
    if get_origin(annotation) in (Union, UnionType):
        (only,) = [kind for kind in get_args(annotation) if kind is not type(None)]
        return value_of(only, notes)
    if get_origin(annotation) is Literal:
        return Value("choice", choices=get_args(annotation))
    if get_origin(annotation) is tuple:
        items = get_args(annotation)
        if items[-1] is Ellipsis:
            return Value("tables", section=items[0])
        return Value("list", items=tuple(map(value_of, items)))
    if get_origin(annotation) is dict:
        return Value("constants")
    if isclass(annotation) and issubclass(annotation, Section):
        return Value("table", section=annotation)
    pattern = next((one.pattern for one in notes if getattr(one, "pattern", None)), "")
    least, most = (
        next((int(getattr(one, name)) for one in notes if getattr(one, name, None) is not None), None)
        for name in ("ge", "le")
    )
    return Value(_PLAIN[annotation], dimensions, pattern=pattern, least=least, most=most)


def _shown(field: FieldInfo, value: Value) -> str:
    """Return a default as a case file has it."""
    default = field.default
    if default is None or default == ():
        return "none"
    if isinstance(default, bool):
        return str(default).lower()
    if isinstance(default, str):
        return f'`"{default}"`'
    if isinstance(default, float) and value.kind == "quantity" and value.dimensions[0].angle:
        return f"{degrees(default):g} deg"
    return f"{default:g}" if isinstance(default, int | float) else "none"


def _allowed(value: Value, notes: Sequence[Any]) -> str:
    """Return the range of a value in words; an empty text where each value is allowed."""
    if value.least is not None:
        return f"{value.least} to {value.most}" if value.most is not None else f"at least {value.least}"
    limits = [
        note.allowed.removeprefix("it must ").removeprefix("be ") for note in notes if isinstance(note, Limit)
    ]
    return ", ".join(limit for limit in limits if limit != "finite")
