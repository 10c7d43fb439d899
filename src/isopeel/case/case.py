"""The case: a TOML file with units that says what is peeled, on which space, how far and in which steps."""

import re
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Self

import numpy as np
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

from isopeel.case.changes import changed
from isopeel.case.errors import first_error
from isopeel.case.sections import (
    HIGHEST_ACROSS,
    AdhesionSection,
    BodySection,
    DiscretizationSection,
    DriveSection,
    HeldSection,
    MaterialSection,
    OutputSection,
    ReadingSection,
    SubstrateSection,
    UnitsSection,
    fields_every_of,
    window_of,
)
from isopeel.case.stages import Stage, check_number, check_work
from isopeel.case.text import LARGEST_TEXT, document_of, size_of
from isopeel.case.values import Section, as_written
from isopeel.common.errors import InputError
from isopeel.common.units import UnitSystem, measured_in, shown
from isopeel.physics.substrates import Flat
from isopeel.problem import Body, Interface, Problem, Support
from isopeel.problem.shapes.base import Shape
from isopeel.problem.shapes.quarter_cylinder import QuarterCylinder
from isopeel.splines.nurbs import NurbsSurface, Side
from isopeel.splines.rows import RowSpace, row_space

#: More, and the stiffnesses along and across an element, its square apart, leave double precision.
LARGEST_ASPECT = 1e4
#: Elements along where a case names none, and the fewest and the most across.
USUAL_ELEMENTS = 200, 2, 10
#: Those of a quarter cylinder, and the ratio of the last one to the first.
CYLINDER_ELEMENTS, CYLINDER_GRADING = (120, 16), 20.0
#: Bytes; the shipped cases have a thousand.
LARGEST_FILE = 20_000


class Case(Section):
    """A checked case. Make one with `load_case` or `Case.parse`, and variants with `with_values`."""

    name: Annotated[
        str,
        Field(
            pattern=r"^[A-Za-z0-9][A-Za-z0-9._-]{0,99}$",
            description="a name of letters, digits, '.', '_' and '-' is needed",
        ),
    ]
    about: Annotated[str, Field(description="a text is needed, in quotes")] = ""
    units: UnitsSection = UnitsSection()
    body: BodySection
    material: MaterialSection
    adhesion: AdhesionSection
    substrate: SubstrateSection = Field(default={}, validate_default=True)
    held: HeldSection | None = None
    discretization: DiscretizationSection = DiscretizationSection()
    drive: Annotated[
        tuple[DriveSection, ...],
        BeforeValidator(check_number),
        BeforeValidator(lambda written: [written] if isinstance(written, Mapping) else written),
        Field(
            default={},
            min_length=1,
            validate_default=True,
            description="a table [drive], or several [[drive]], is needed",
        ),
    ]
    reading: ReadingSection | None = None
    output: OutputSection = Field(default={}, validate_default=True)
    _document: dict[str, Any] = PrivateAttr(default_factory=dict)

    @classmethod
    def parse(cls, text: str, source: str = "text", folder: Path = Path()) -> Self:
        """Read a TOML text, whose files are seen from a folder.

        Raises InputError whose field is the path of the key, or CASE for broken TOML and for texts that are
        longer, or nested deeper, than any case.
        """
        return cls._checked(document_of(text, source), folder)

    @classmethod
    def _checked(cls, document: dict[str, Any], folder: Path = Path()) -> Self:
        try:
            with measured_in(_units(document)):
                case = cls.model_validate(document, context={"folder": folder})
        except ValidationError as error:
            raise first_error(error, document, cls) from error
        # files as they are seen from anywhere
        files = {key: str(value) for key, value in case.body if isinstance(value, Path)}
        for key, path in files.items():
            if size_of(path) is None:
                # as Python reads names of other encodings
                raise InputError(
                    f"body.{key}", path, "the path of a file, and of its folders, must be UTF-8 text"
                )
        case._document = document | {"body": document["body"] | files}
        if (size_of(case.text) or 0) > LARGEST_TEXT:
            raise InputError("CASE", case.name, f"a case has at most {LARGEST_TEXT} bytes where it is stored")
        return case

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
        self.space()
        return self

    def overridden(
        self,
        *,
        space: str | None = None,
        mesh: str | None = None,
        to: str | float | None = None,
        step: str | float | None = None,
        traction: str | None = None,
        contact_points: int | None = None,
        path_control: str | None = None,
        fields_every: str | float | None = None,
    ) -> Self:
        """Return the case with other values, `to`, `step` and `fields_every` those of the last stage.

        `path_control` is that of all stages.

        They are texts with units; plain numbers are degrees of an angle, and refused elsewhere. Raises
        InputError whose field is the option of the command line, such as --mesh.
        """
        given = {
            ("discretization", "space"): space,
            ("discretization", "mesh"): mesh,
            ("drive", "to"): to,
            ("drive", "step"): step,
            ("adhesion", "traction"): traction,
            ("discretization", "contact_points"): contact_points,
            ("drive", "path_control"): path_control,
            ("output", "fields_every"): fields_every,
        }
        changes = {path: value for path, value in given.items() if value is not None}
        document = dict(self._document)
        for (section, key), value in changes.items():
            table = document.get(section, {})
            parameter = key in ("to", "step", "fields_every")
            entry = {key: as_written(self.drive[-1].dimension, value) if parameter else value}
            if not isinstance(table, list):
                document[section] = table | entry
            elif key == "path_control":
                document[section] = [stage | entry for stage in table]
            else:
                document[section] = [*table[:-1], table[-1] | entry]
        try:
            return self._checked(document)
        except InputError as error:
            for (section, key), value in changes.items():
                several_stages = section == "drive" and isinstance(document[section], list)
                # what all stages have is blamed on the first
                number = 1 if key == "path_control" else len(self.drive)
                place = f"{section}.{number}" if several_stages else section
                blamed = [f"{place}.{key}"]
                if key == "to" and step is None:
                    blamed.append(f"{place}.step")  # which was good until the way became longer
                if key in ("to", "step"):
                    blamed.append("drive")  # of all stages together
                if error.field in blamed:
                    option = "control" if key == "path_control" else key.replace("_", "-")
                    raise InputError(f"--{option}", value, error.allowed) from error
            raise

    def with_values(self, values: Mapping[str, Any]) -> Self:
        """Return the case with other values of any keys, as a case file would have them.

        Keys are dotted names, such as `adhesion.work_of_adhesion`, and `drive.2.to` where a case has several
        stages; None leaves a key out. Raises InputError, whose field is the key, as for a case file.
        """
        return self._checked(changed(self._document, values))

    @property
    def text(self) -> str:
        """The case as TOML, with the units it was written in."""
        return tomli_w.dumps(self._document)

    def problem(self) -> Problem:
        """Build the problem of the first stage, in L0 and E0."""
        return self.stages()[0].problem

    def stages(self) -> tuple[Stage, ...]:
        """Build all stages: one body and its adhesion, and a drive each."""
        with measured_in(self.units.system()):
            return self._stages()

    def _stages(self) -> tuple[Stage, ...]:
        shape, law = self.body.body_shape(), self.adhesion.adhesion_law()
        substrate = self.substrate.substrate(law.equilibrium_gap)
        if self.adhesion.symmetric and not isinstance(substrate, Flat):
            allowed = "a body meets its mirror image at a plane, so that the substrate must be flat"
            raise InputError("adhesion.symmetric", True, allowed)
        if self.adhesion.symmetric and self.adhesion.sliding_length is not None:
            allowed = "a body and its mirror image do not slip past each other; leave out sliding_length"
            raise InputError("adhesion.symmetric", True, allowed)
        length = self.adhesion.length
        start, end = (0.0, 1.0) if length is None else shape.adhering_part(length)
        body = Body(shape.surface(), self.material.material())
        adhesion = Interface(
            body.side("bottom", start, end),
            law=law,
            substrate=substrate,
            traction=self.adhesion.traction,
            irreversible=self.adhesion.irreversible,
            sliding_length=self.adhesion.sliding_length,
        )
        last = self.drive[-1]
        usual = (Support(body.side(shape.usual_hold), (0,)),)
        supports = usual if self.held is None else self.held.supports(body)
        return tuple(
            Stage(
                name=stage.label,
                problem=Problem(self.name, (body,), (adhesion,), supports, stage.drive()),
                parameters=stage.parameters(),
                path_control=stage.path_control,
                fields_every=self.output.fields_every if stage is last else stage.usual_fields_every,
                window=self.reading.window if self.reading and stage is last else None,
            )
            for stage in self.drive
        )

    def space(self) -> RowSpace:
        """Build the space of the displacement."""
        chosen = self.discretization
        shape = self.body.body_shape().surface()
        mesh, usual_grading = usual_mesh(self.body.body_shape())
        if chosen.mesh is not None:
            mesh, usual_grading = parse_mesh("discretization.mesh", chosen.mesh), (1.0, 1.0)
        grading = chosen.grading or usual_grading
        usual = usual_across_degree(self.material.material().poissons_ratio, shape)
        try:
            space = row_space(chosen.space, mesh, chosen.across_degree or usual, grading, shape)
        except InputError as error:
            raise InputError(f"discretization.{error.field}", error.value, error.allowed) from error
        sides: tuple[tuple[Side, Side], ...] = ("bottom", "top"), ("left", "right")
        lengths = [max(shape.boundary(side).length() for side in pair) for pair in sides]
        along, across = (
            length * np.diff(directional.breakpoints)
            for length, directional in zip(lengths, (space.rows[0], space.across), strict=True)
        )
        for one, other in ((along.max(), across.min()), (along.min(), across.max())):
            if max(one, other) > LARGEST_ASPECT * min(one, other):
                sizes = " x ".join(shown(size, self.units.system(), length=1) for size in (one, other))
                allowed = (
                    f"it has elements of {sizes}; one side may be {LARGEST_ASPECT:g} times the other at most"
                )
                raise InputError("discretization.mesh", "{}x{}".format(*mesh), allowed)
        return space


def usual_mesh(shape: Shape) -> tuple[tuple[int, int], tuple[float, float]]:
    """Return the elements along the length and the height where a case names none, and their grading.

    Of most bodies 200, and 2 to 10 across: they are about as high as they are long, as the stresses of a
    front are as wide in both directions, and two are enough for bending, with the degree across that is
    usual. A quarter cylinder touches around one corner: 120x16, graded to 1:20 both ways, is within 0.4 % of
    the pull-off force of Johnson, Kendall and Roberts, and of the load of Hertz, where 200x10 is off by 4 %
    (cases 124, 151 and 188 of `benchmarks/trial.py`).
    """
    if shape.name == QuarterCylinder.name:
        return CYLINDER_ELEMENTS, (CYLINDER_GRADING, CYLINDER_GRADING)
    surface = shape.surface()
    length, height = (
        max(surface.boundary(side).length() for side in pair)
        for pair in (("bottom", "top"), ("left", "right"))
    )
    along, fewest, most = USUAL_ELEMENTS
    return (along, min(max(round(along * height / length), fewest), most)), (1.0, 1.0)


def usual_across_degree(poissons_ratio: float, shape: NurbsSurface) -> int:
    """The degree across where a case names none: 2, 3 of nearly incompressible bodies, or that of the shape.

    A strip that bends shortens and lifts by squares of the height, which a linear space does not contain. At
    finite strain a change of volume in the fourth power is left by degree 2, which the bulk modulus makes
    stiff: a moment of 3.6 % more at nu = 0.499 of a strip bent to 15 times its height, with one element
    across, and of 0.4 % at 0.49 (`benchmarks/locking.py`). It grows with the square of the curvature.
    """
    bending = 2 if poissons_ratio <= 0.45 else 3
    return min(max(bending, shape.spaces[1].degree), HIGHEST_ACROSS)


def _units(document: Mapping[str, Any]) -> UnitSystem:
    """The units of a case; the usual ones where it has none that can be used, which checking it will tell."""
    try:
        return UnitsSection.model_validate(document.get("units", {})).system()
    except ValidationError:
        return UnitSystem()


def shipped_cases() -> tuple[str, ...]:
    """Return names of the cases that come with the package."""
    folders = resources.files("isopeel").joinpath("cases").iterdir()
    return tuple(sorted(folder.name for folder in folders if folder.is_dir() and folder.name[0] not in "._"))


def load_case(case: str | Path) -> Case:
    """Load a shipped case by its name, or a TOML file by its path.

    Raises InputError; its field is the key's path, or CASE where the file itself cannot be used.
    """
    if case in shipped_cases():
        file = resources.files("isopeel").joinpath("cases", str(case), "case.toml")
        return Case.parse(file.read_text("utf-8"))
    path = Path(case)
    try:
        # what is no file, such as a pipe, could be waited for without an end
        if not path.is_file():
            kind = "is no file" if path.exists() else "does not exist"
            allowed = f"it {kind}; give a TOML file or a shipped case: {', '.join(shipped_cases())}"
            raise InputError("CASE", str(case), allowed)
        with path.open("rb") as opened:
            content = opened.read(LARGEST_FILE + 1)
        if len(content) > LARGEST_FILE:
            raise InputError("CASE", str(case), f"a case has at most {LARGEST_FILE} bytes")
        text = content.decode()
    except OSError as error:
        raise InputError("CASE", str(case), f"it cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        is_utf_16 = content.startswith((b"\xff\xfe", b"\xfe\xff"))
        allowed = "a TOML file is UTF-8 text; " + (
            "it is UTF-16, to be saved as UTF-8" if is_utf_16 else f"byte {error.start} is not"
        )
        raise InputError("CASE", str(case), allowed) from error
    return Case.parse(text.replace("\r\n", "\n"), str(case), path.parent)


def parse_mesh(field: str, text: str) -> tuple[int, int]:
    """Read a number of elements along the length x the height, such as 200x10; InputError names the field."""
    parts = re.fullmatch(r"(\d{1,15})x(\d{1,15})", text)
    if not parts:
        raise InputError(field, text, "elements along length x height are needed, such as 200x10")
    return int(parts[1]), int(parts[2])
