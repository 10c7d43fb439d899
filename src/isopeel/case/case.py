"""The case: a TOML file with units that says what is peeled, on which space, how far and in which steps.

A case has one of two forms: that of one body (`isopeel.case.one_body`), or that of several bodies, interfaces
and supports (`isopeel.case.several_bodies`).
"""

from abc import abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Self

import tomli_w
from pydantic import (
    BeforeValidator,
    Field,
    PrivateAttr,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_validator,
)

from isopeel.case.bodies import PlacedBody
from isopeel.case.changes import changed, value_of
from isopeel.case.drives import DriveSection, LoadTable, fields_every_of, window_of
from isopeel.case.errors import first_error, named_by
from isopeel.case.sections import (
    DiscretizationSection,
    OutputSection,
    ReadingSection,
    UnitsSection,
)
from isopeel.case.stages import Stage, check_number, check_work
from isopeel.case.text import LARGEST_TEXT, document_of, size_of
from isopeel.case.values import Needed, Section, means
from isopeel.common.errors import InputError
from isopeel.common.units import UnitSystem, measured_in
from isopeel.problem import Drive, Interface, Problem, RotatedSide, Support, Tie
from isopeel.splines.rows import RowSpace

#: What the system calls keys of the discretization.
_OF_THE_SPACE = ("mesh", "contact_points", "space", "across_degree")


class Case(Section):
    """A checked case. Make one with `load_case` or `Case.parse`, and variants with `with_values`."""

    name: Annotated[
        str,
        Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]{0,99}$"),
        Needed("a name of letters, digits, '.', '_' and '-' is needed"),
        means(
            "name of the case, of letters, digits, '.', '_' and '-'; that of the folder of its results",
            "my-tape",
        ),
    ]
    about: Annotated[
        str,
        Needed("a text is needed, in quotes"),
        means("what the case is, in a sentence", "My first tape.", usual="none"),
    ] = ""
    units: Annotated[UnitsSection, means("the units L0 and E0 of the run")] = UnitsSection()
    discretization: Annotated[DiscretizationSection, means("the spline space and the mesh")] = (
        DiscretizationSection()
    )
    drive: Annotated[
        tuple[DriveSection, ...],
        BeforeValidator(check_number),
        BeforeValidator(lambda written: [written] if isinstance(written, Mapping) else written),
        Field(
            default={},
            min_length=1,
            validate_default=True,
        ),
        Needed("a table [drive], or several [[drive]], is needed"),
        means(
            "what moves or pulls, how far and in which steps; several tables are stages",
            see="howto/units.md#stages",
        ),
    ]
    load: Annotated[
        tuple[LoadTable, ...],
        Field(min_length=1),
        Needed("a table [[load]] is needed for each load that is held, or none"),
        means("a dead load that is constant in all stages"),
    ] = ()
    reading: Annotated[ReadingSection | None, means("where the plateau is read")] = None
    output: Annotated[OutputSection, means("what is stored")] = Field(default={}, validate_default=True)
    _document: dict[str, Any] = PrivateAttr(default_factory=dict)

    @classmethod
    def parse(cls, text: str, source: str = "text", folder: Path = Path()) -> "Case":
        """Read a TOML text, whose files are seen from a folder.

        Raises InputError whose field is the path of the key, or CASE for broken TOML and for texts that are
        longer, or nested deeper, than any case.
        """
        return cls._checked(document_of(text, source), folder)

    @classmethod
    def _checked(cls, document: dict[str, Any], folder: Path = Path()) -> "Case":
        # the forms are cases themselves
        from isopeel.case.forms import form_of

        form = form_of(document)
        try:
            with measured_in(_units(document)):
                case = form.model_validate(document, context={"folder": folder})
        except ValidationError as error:
            raise first_error(error, document, form) from error
        # files as they are seen from anywhere
        case._document = case._with_files(document)
        if (size_of(case.text) or 0) > LARGEST_TEXT:
            raise InputError("CASE", case.name, f"a case has at most {LARGEST_TEXT} bytes where it is stored")
        return case

    def __reduce__(self) -> tuple[Callable[[str], "Case"], tuple[str]]:
        """Go from process to process as text: sections of laws and shapes are made while the code runs."""
        return Case.parse, (self.text,)

    @field_validator("drive", mode="after")
    @classmethod
    def _of_bounded_work(cls, stages: tuple[DriveSection, ...]) -> tuple[DriveSection, ...]:
        check_work([stage.steps().number for stage in stages])
        return stages

    @field_validator("reading", "output", mode="before")
    @classmethod
    def _in_the_drives_dimension(cls, written: object, info: ValidationInfo) -> object:
        """Read parameters as they are shown, which takes the drive of the last stage."""
        stages: tuple[DriveSection, ...] = info.data.get("drive", ())
        if not stages or not isinstance(written, Mapping):
            return written
        read = window_of if info.field_name == "reading" else fields_every_of
        return read(written, stages[-1])

    @model_validator(mode="after")
    def _parts_fit_together(self) -> Self:
        self.stages()
        self.spaces()
        return self

    def with_values(self, values: Mapping[str, Any]) -> "Case":
        """Return the case with other values of any keys, as a case file would have them.

        Keys are dotted names, such as `adhesion.work_of_adhesion`. A table of a list is named by its number,
        as in `drive.2.to` or `body.1.mesh`. None leaves a key out. Raises InputError, whose field is the
        key, as for a case file.
        """
        return self._checked(changed(self._document, values))

    def value(self, key: str) -> Any:
        """Return the value of a key as the case has it; the keys are those of `with_values`.

        Raises InputError, whose field is the key, where the case does not state it.
        """
        return value_of(self._document, key)

    def keys_of_tables(self, table: str, key: str) -> list[str]:
        """Return the names of a key of all tables of a list; none where there is no such list."""
        found = self._document.get(table)
        return (
            [f"{table}.{number}.{key}" for number in range(1, len(found) + 1)]
            if isinstance(found, list)
            else []
        )

    @property
    def text(self) -> str:
        """The case as TOML, with the units it was written in."""
        return tomli_w.dumps(self._document)

    def problem(self) -> Problem:
        """Build the problem of the first stage, in L0 and E0."""
        return self.stages()[0].problem

    def stages(self) -> tuple[Stage, ...]:
        """Build all stages: the bodies, their interfaces, supports and loads, and a drive each."""
        last, units = self.drive[-1], self.units.system()
        with measured_in(units):
            placed = self._placed()
            interfaces, supports = self._joined(placed)
            loads = tuple(
                table.load(f"load.{number}", placed, units) for number, table in enumerate(self.load, start=1)
            )
            whole = Problem(
                self.name,
                tuple(one.body for one in placed.values()),
                interfaces,
                supports,
                RotatedSide(),
                loads,
                self._ties(placed),
            )
            return tuple(
                Stage(
                    name=stage.label,
                    problem=replace(whole, drive=drive),
                    parameters=stage.parameters(),
                    path_control=stage.path_control,
                    fields_every=self._fields_every(stage),
                    window=self.reading.window if self.reading and stage is last else None,
                )
                for stage, drive in zip(self.drive, self._drives(placed), strict=True)
            )

    def _drives(self, placed: Mapping[str, PlacedBody]) -> list[Drive]:
        """Build the drives of the stages, on their boundaries."""
        units, drives = self.units.system(), []
        for number, stage in enumerate(self.drive, start=1):
            key = f"drive.{number}" if len(self.drive) > 1 else "drive"
            place = stage.place(key, placed, units, self._only)
            with named_by({"drive": key}):
                drives.append(stage.drive(place))
        return drives

    def _fields_every(self, stage: DriveSection) -> float:
        """Return the distance of stored fields, as written where it is one of the stage's parameter."""
        written = self.output.fields_every
        if written is None or stage.dimension != self.drive[-1].dimension:
            return stage.usual_fields_every
        return written

    def space(self) -> RowSpace:
        """Build the space of the displacement of the only body."""
        spaces = self.spaces()
        if len(spaces) != 1:
            raise InputError("body", list(spaces), "this is known for one body only")
        return next(iter(spaces.values()))

    def named(self, error: InputError) -> InputError:
        """Return an error of the system with the key of the case in place of its field."""
        field = f"discretization.{error.field}" if error.field in _OF_THE_SPACE else error.field
        return InputError(field, error.value, error.allowed)

    @abstractmethod
    def spaces(self) -> dict[str, RowSpace]:
        """Build the spaces of the displacement by the names of the bodies, in their order."""

    @property
    @abstractmethod
    def width(self) -> float | None:
        """Extent of the bodies across the plane, in L0, which only scales what is shown."""

    @property
    @abstractmethod
    def _only(self) -> str:
        """The name of the body where there is only one, so that a drive names a side of it."""

    @abstractmethod
    def _placed(self) -> dict[str, PlacedBody]:
        """Build the bodies by their names."""

    @abstractmethod
    def _joined(self, placed: Mapping[str, PlacedBody]) -> tuple[tuple[Interface, ...], tuple[Support, ...]]:
        """Build interfaces and supports."""

    def _ties(self, placed: Mapping[str, PlacedBody]) -> tuple[Tie, ...]:  # noqa: ARG002 (of several bodies)
        """Build the ties; none of one body."""
        return ()

    @abstractmethod
    def _with_files(self, document: dict[str, Any]) -> dict[str, Any]:
        """Return the document with absolute paths of files. Raises InputError for other names than UTF-8."""


def _units(document: Mapping[str, Any]) -> UnitSystem:
    """The units of a case; the default ones if they are not valid, which the check of the case reports."""
    try:
        return UnitsSection.model_validate(document.get("units", {})).system()
    except ValidationError:
        return UnitSystem()
