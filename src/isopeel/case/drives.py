"""The tables [[drive]] and [[load]] of a case: what moves or pulls, where, and how far."""

from collections.abc import Mapping
from math import radians
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, Field, model_validator

from isopeel.case.bodies import PlacedBody
from isopeel.case.boundaries import BoundaryTable, EndOfPart, LengthOfPart, StartOfPart
from isopeel.case.errors import named_by
from isopeel.case.kinds import KindSection
from isopeel.case.sections import A_BOUNDARY, A_WINDOW, PARAMETER
from isopeel.case.stages import Steps, stage_parameters, stage_steps
from isopeel.case.values import Needed, NumberKey, key_of, means, read_quantity
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.path_control import PathControl
from isopeel.common.quantities import ANGLE, FORCE_PER_WIDTH, Dimension
from isopeel.common.units import UnitSystem
from isopeel.problem import Drive, HeldLoad, Place
from isopeel.splines.nurbs import Side

_A_SIDE = key_of(Side).needed
ForceKey = Annotated[
    float,
    FORCE_PER_WIDTH,
    BeforeValidator(lambda written: read_quantity(FORCE_PER_WIDTH, written)),
    Needed(FORCE_PER_WIDTH.needed),
]
AngleKey = Annotated[
    float,
    ANGLE,
    BeforeValidator(lambda written: radians(read_quantity(ANGLE, written))),
    Needed(ANGLE.needed),
]
#: Keys of a part of the driven boundary.
_PART = ("start", "end", "length")
_SEVERAL = "a table [[drive.on]] is needed for each boundary, or none"


class DrivenTable(BoundaryTable):
    """One of several boundaries that a drive acts on, and its factor."""

    factor: Annotated[
        NumberKey,
        means("factor of the motion or the force on this boundary, of a size from 1e-6 to 1e6", -1.0),
    ] = 1.0


class LoadTable(BoundaryTable):
    """A load that is held: a force per width on a boundary."""

    force: Annotated[ForceKey, means("force per width", "0.05 N/m")]
    angle: Annotated[AngleKey, means("angle of the force from the x axis", "90 deg")]

    def load(self, key: str, bodies: Mapping[str, PlacedBody], units: UnitSystem) -> HeldLoad:
        """Build the load. Raises InputError whose field begins with the key of the table."""
        boundary = self.part(key, bodies, units)
        with named_by({"load": key}):
            return HeldLoad(boundary, self.force, self.angle)


class DriveSection(KindSection):
    """One stage: a drive, how far it goes, and in which steps, in the dimension of its parameter."""

    table, packages, chooser, usual = "drive", ("isopeel.problem.drives",), "kind", "rotation"
    own = frozenset({"on"})

    name: Annotated[
        str | None,
        Field(pattern=r"^[A-Za-z0-9-]{1,40}$"),
        Needed("a name of letters, digits and '-' is needed"),
        means("name of the stage, of letters, digits and '-'", "press", usual="the kind"),
    ] = None
    side: Annotated[
        Side | None,
        Needed(_A_SIDE or ""),
        means("the driven side of the only body", "right", usual='`"right"` for a rotation, else required'),
    ] = None
    boundary: Annotated[
        str | None,
        Needed(A_BOUNDARY),
        means(
            "BODY.SIDE, in place of `side` in a case of several bodies", "upper.right", usual="required there"
        ),
    ] = None
    start: StartOfPart = None
    end: EndOfPart = None
    length: LengthOfPart = None
    on: Annotated[
        tuple[DrivenTable, ...],
        Field(min_length=1),
        Needed(_SEVERAL),
        means(
            "tables `[[drive.on]]`, one for each of several boundaries, in place of the five keys above",
            see="theory/drives.md#several-boundaries",
        ),
    ] = ()
    to: Annotated[
        Any,
        *PARAMETER,
        means("last parameter", "120 deg", usual='`"120 deg"` if the parameter is an angle, else required'),
    ] = "120 deg"
    step: Annotated[
        Any,
        *PARAMETER,
        means(
            "step of the parameter",
            "0.1 deg",
            usual='`"0.1 deg"` if the parameter is an angle, else required',
        ),
    ] = "0.1 deg"
    path_control: Annotated[
        PathControl,
        Needed("'newton', 'auto', 'jump' or 'continuation' is needed"),
        means("what to do when a step finds no equilibrium", "continuation", see="howto/controls.md"),
    ] = "auto"

    @model_validator(mode="after")
    def _can_be_made(self) -> Self:
        for key in ("to", "step"):
            if not self.dimension.angle and key not in self.model_fields_set:
                raise InputError(f"drive.{key}", None, f"the key is missing; {self.dimension.needed}")
        self.steps()
        return self

    @property
    def label(self) -> str:
        """The name of the stage, given or not."""
        return self.name or str(getattr(self, self.chooser))

    def drive(self, place: Place) -> Drive:
        """Build the drive on a place."""
        drive: Drive = self.made(on=place)
        return drive

    def place(self, key: str, bodies: Mapping[str, PlacedBody], units: UnitSystem, only: str = "") -> Place:
        """Find where it acts: on a side of the `only` body, on a boundary, or on several boundaries.

        Raises InputError whose field begins with the key of the table.
        """
        if self.on:
            for name in ("side", "boundary", *_PART):
                if name in self.model_fields_set:
                    value = getattr(self, name)
                    raise InputError(f"{key}.{name}", value, "the boundaries are the tables [[drive.on]]")
            numbered = [(f"{key}.on.{number}", table) for number, table in enumerate(self.on, start=1)]
            return tuple((table.part(name, bodies, units), table.factor) for name, table in numbered)
        # of values that are checked
        part = {name: getattr(self, name) for name in _PART}
        table = BoundaryTable.model_construct(boundary=self._boundary(key, only), **part)
        found = table.part(key, bodies, units)
        return found.side if only and found.is_whole else found

    def _boundary(self, key: str, only: str) -> str:
        """BODY.SIDE: of the only body, which has a side; of several, each boundary is named."""
        if only:
            if self.boundary is not None:
                allowed = "the drive of the only body has a side in place of a boundary"
                raise InputError(f"{key}.boundary", self.boundary, allowed)
            side = self.side or getattr(self.maker, "on", None)
            if side is None:
                raise InputError(f"{key}.side", None, f"the key is missing; {_A_SIDE}")
            return f"{only}.{side}"
        if self.side is not None:
            allowed = f"with [[body]], {A_BOUNDARY}, in place of a side"
            raise InputError(f"{key}.side", self.side, allowed)
        if self.boundary is None:
            raise InputError(f"{key}.boundary", None, f"the key is missing; {A_BOUNDARY}")
        return self.boundary

    @property
    def dimension(self) -> Dimension:
        """Dimension of the parameter, which does not depend on the place."""
        return self.drive("right").parameter_dimension

    @property
    def usual_fields_every(self) -> float:
        """Return the default distance of stored fields: 10 degrees, or a tenth of the path."""
        return 10.0 if self.dimension.angle else abs(self.steps().last) / 10

    def steps(self) -> Steps:
        """How far the stage goes, and in which steps."""
        return stage_steps(self.dimension, self.to, self.step)

    def parameters(self) -> FloatArray:
        """Return parameters of the steps, in radians, or in L0 and E0."""
        return stage_parameters(self.dimension, self.to, self.step)


def window_of(written: Mapping[str, Any], stage: DriveSection) -> Mapping[str, Any]:
    """Read the window of a section in the dimension of a stage."""
    if "window" not in written:
        return written
    needed = f"{A_WINDOW}; for each, {stage.dimension.needed}"
    window = written["window"]
    if not isinstance(window, list) or len(window) != 2:
        raise InputError("reading.window", window, needed)
    try:
        start, end = (read_quantity(stage.dimension, value) for value in window)
    except ValueError as error:
        raise InputError("reading.window", window, str(error)) from error
    if not start < end:
        raise InputError("reading.window", window, needed)
    return {**written, "window": (start, end)}


def fields_every_of(written: Mapping[str, Any], stage: DriveSection) -> Mapping[str, Any]:
    """Read the distance of fields in the dimension of a stage."""
    if "fields_every" not in written:
        return written
    every = written["fields_every"]
    try:
        value = read_quantity(stage.dimension, every)
    except ValueError as error:
        raise InputError("output.fields_every", every, str(error)) from error
    if not value > 0:
        raise InputError("output.fields_every", every, f"it must be positive; {stage.dimension.needed}")
    return {**written, "fields_every": value}
