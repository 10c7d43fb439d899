"""The case: a TOML file with units that says what is peeled, on which space, how far and in which steps."""

import json
import re
import tomllib
from collections.abc import Mapping
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Self, get_args

import numpy as np
from pydantic import Field, PrivateAttr, ValidationError, model_validator

from isopeel.arrays import FloatArray
from isopeel.case_laws import AdhesionSection, MaterialSection
from isopeel.case_sections import (
    BodySection,
    DiscretizationSection,
    DriveSection,
    OutputSection,
    ReadingSection,
)
from isopeel.case_values import Section
from isopeel.errors import InputError
from isopeel.problem import Problem, strip
from isopeel.splines.rows import RowSpace, row_space

#: More steps than this are a slip of the pen: a thousandth of a degree up to 100 degrees.
MOST_STEPS = 100_000
#: More, and the stiffnesses along and across an element, its square apart, leave double precision.
LARGEST_ASPECT = 1e4


class Case(Section):
    """A checked case. Make one with `load_case` or `Case.parse`, and variants with `overridden`."""

    name: Annotated[
        str,
        Field(
            pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]{0,99}$",
            description="a name of letters, digits, '.', '_' and '-' is needed",
        ),
    ]
    body: BodySection
    material: MaterialSection
    adhesion: AdhesionSection
    discretization: DiscretizationSection = DiscretizationSection()
    drive: DriveSection = DriveSection()
    reading: ReadingSection | None = None
    output: OutputSection = OutputSection()
    _document: dict[str, Any] = PrivateAttr(default_factory=dict)

    @classmethod
    def parse(cls, text: str, source: str = "text") -> Self:
        """Read a TOML text. Raises InputError whose field is the path of the key, or CASE for broken TOML."""
        try:
            document = tomllib.loads(text)
        except (ValueError, RecursionError) as error:
            raise InputError("CASE", source, f"it is not TOML: {error}") from error
        return cls._checked(document)

    @classmethod
    def _checked(cls, document: dict[str, Any]) -> Self:
        try:
            case = cls.model_validate(document)
        except ValidationError as error:
            raise _first_error(error, document) from error
        case._document = document
        return case

    @model_validator(mode="after")
    def _parts_fit_together(self) -> Self:
        if self.adhesion.length > self.body.length > 0:
            raise InputError("adhesion.length", self.adhesion.length, "at most body.length can adhere")
        self.problem()
        self.space()
        self.angles()
        return self

    def overridden(
        self,
        *,
        space: str | None = None,
        mesh: str | None = None,
        to: float | None = None,
        step: float | None = None,
        traction: str | None = None,
        contact_points: int | None = None,
    ) -> Self:
        """Return the case with other values, angles in degrees.

        Raises InputError whose field is the option of the command line, such as --mesh.
        """
        given = {
            ("discretization", "space"): space,
            ("discretization", "mesh"): mesh,
            ("drive", "to"): to,
            ("drive", "step"): step,
            ("adhesion", "traction"): traction,
            ("discretization", "contact_points"): contact_points,
        }
        changes = {path: value for path, value in given.items() if value is not None}
        document = dict(self._document)
        for (section, key), value in changes.items():
            written = f"{float(value)!r} deg" if section == "drive" else value
            document[section] = document.get(section, {}) | {key: written}
        try:
            return self._checked(document)
        except InputError as error:
            for (section, key), value in changes.items():
                if error.field == f"{section}.{key}":
                    raise InputError(f"--{key.replace('_', '-')}", value, error.allowed) from error
            raise

    @property
    def text(self) -> str:
        """The case as TOML, with the units it was written in."""
        return _toml(self._document)

    def problem(self) -> Problem:
        """Build the problem, in L0 and E0."""
        made = strip(
            length=self.body.length,
            height=self.body.height,
            adhering_length=self.adhesion.length,
            material=self.material.material(),
            law=self.adhesion.adhesion_law(),
            traction=self.adhesion.traction,
            irreversible=self.adhesion.irreversible,
        )
        return replace(made, name=self.name)

    def space(self) -> RowSpace:
        """Build the space of the displacement."""
        mesh = parse_mesh("discretization.mesh", self.discretization.mesh)
        try:
            space = row_space(self.discretization.space, mesh)
        except InputError as error:
            raise InputError(f"discretization.{error.field}", error.value, error.allowed) from error
        along, across = self.body.length / mesh[0], self.body.height / mesh[1]
        if max(along, across) > LARGEST_ASPECT * min(along, across):
            sizes = f"{along:g} nm x {across:g} nm"
            allowed = f"its elements are {sizes}; one side may be {LARGEST_ASPECT:g} times the other at most"
            raise InputError("discretization.mesh", self.discretization.mesh, allowed)
        return space

    def angles(self) -> FloatArray:
        """Angles of the steps in radians: 0, the multiples of the step, and the last angle."""
        to, step = self.drive.to, self.drive.step
        if not 0 < to <= 180:
            raise InputError("drive.to", to, "it must be above 0 and at most 180 degrees")
        if not step > 0:
            raise InputError("drive.step", step, "it must be positive")
        if to / step > MOST_STEPS:
            allowed = f"at most {MOST_STEPS} steps are made, so at least {to / MOST_STEPS:g} deg is needed"
            raise InputError("drive.step", step, allowed)
        # a last step of round-off size would be none at all
        full_steps = int(np.ceil(to / step * (1 - 1e-12)))
        degrees = np.append(np.round(np.arange(full_steps) * step, 12), to)
        angles: FloatArray = np.radians(degrees)
        return angles


def shipped_cases() -> tuple[str, ...]:
    """Names of the cases that come with the package."""
    files = resources.files("isopeel").joinpath("cases").iterdir()
    return tuple(sorted(file.name.removesuffix(".toml") for file in files if file.name.endswith(".toml")))


def load_case(case: str | Path) -> Case:
    """Load a shipped case by its name, or a TOML file by its path.

    Raises InputError; its field is the key's path, or CASE where the file itself cannot be used.
    """
    if case in shipped_cases():
        return Case.parse(resources.files("isopeel").joinpath("cases", f"{case}.toml").read_text("utf-8"))
    path = Path(case)
    try:
        if not path.is_file():
            kind = "is no file" if path.exists() else "does not exist"
            allowed = f"it {kind}; give a TOML file or a shipped case: {', '.join(shipped_cases())}"
            raise InputError("CASE", str(case), allowed)
        text = path.read_text("utf-8")
    except OSError as error:
        raise InputError("CASE", str(case), f"it cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        allowed = f"a TOML file is UTF-8 text; byte {error.start} is not"
        raise InputError("CASE", str(case), allowed) from error
    return Case.parse(text, str(case))


def parse_mesh(field: str, text: str) -> tuple[int, int]:
    """Read a number of elements along the length x the height, such as 200x10; InputError names the field."""
    parts = re.fullmatch(r"(\d{1,15})x(\d{1,15})", text)
    if not parts:
        raise InputError(field, text, "elements along length x height are needed, such as 200x10")
    return int(parts[1]), int(parts[2])


def _first_error(error: ValidationError, document: dict[str, Any]) -> InputError:
    """Translate pydantic's first error; unknown keys go first, since they explain the missing ones."""
    details = min(error.errors(), key=lambda details: details["type"] != "extra_forbidden")
    cause = details.get("ctx", {}).get("error")
    if isinstance(cause, InputError):
        return InputError(cause.field, _written(document, cause.field, cause.value), cause.allowed)
    location, value = details["loc"], details["input"]
    section = _SECTIONS.get(location[:-1], Case)
    tagged = location[:2] in _SECTIONS
    path = [str(part) for part in (location[:1] + location[2:] if tagged else location)]
    field = ".".join(path)
    match details["type"]:
        case "extra_forbidden":
            keys = ", ".join(section.model_fields)
            return InputError(field, value, f"there is no such key; here the keys are {keys}")
        case "union_tag_not_found" | "union_tag_invalid":
            laws = ", ".join(str(key[1]) for key in _SECTIONS if key[0] == field and len(key) == 2)
            return InputError(f"{field}.law", value.get("law"), f"one of these laws is needed: {laws}")
        case "value_error":
            return InputError(field, value, str(cause))
    needed = section.model_fields[path[-1]].description or f"a table [{field}] is needed"
    if details["type"] == "missing":
        return InputError(field, None, f"the key is missing; {needed}")
    return InputError(field, value, needed)


def _by_law(key: str, union: object) -> dict[tuple[int | str, ...], type[Section]]:
    """Sections of a key, each with its law, as the places of pydantic's errors have them."""
    sections: tuple[type[Section], ...] = get_args(get_args(union)[0])
    return {(key, get_args(section.model_fields["law"].annotation)[0]): section for section in sections}


_SECTIONS: dict[tuple[int | str, ...], type[Section]] = {
    ("body",): BodySection,
    **_by_law("material", MaterialSection),
    **_by_law("adhesion", AdhesionSection),
    ("discretization",): DiscretizationSection,
    ("drive",): DriveSection,
    ("reading",): ReadingSection,
    ("output",): OutputSection,
}


def _written(document: Mapping[str, Any], field: str, value: object) -> object:
    """Return what the document holds at a field, where that is the text of the value."""
    found: Any = document
    for key in field.split("."):
        found = found.get(key) if isinstance(found, Mapping) else None
    return value if found is None or isinstance(found, Mapping) else found


def _toml(table: Mapping[str, Any], path: tuple[str, ...] = ()) -> str:
    """Write a table of texts, numbers, lists and tables; its keys are plain words."""
    # JSON's texts, numbers and lists are TOML's
    lines = [
        f"{key} = {json.dumps(value, ensure_ascii=False)}"
        for key, value in table.items()
        if not isinstance(value, dict)
    ]
    for key, value in table.items():
        if isinstance(value, dict):
            lines += ["", f"[{'.'.join((*path, key))}]", _toml(value, (*path, key)).rstrip()]
    return "\n".join(lines) + "\n"
