"""The tables [[body]] of a case: bodies by their names, each with its shape, place, material and space."""

from collections.abc import Collection, Sequence
from math import radians
from typing import Annotated, NamedTuple, Self

from pydantic import BeforeValidator, Field, model_validator

from isopeel.case.discretization import space_of
from isopeel.case.errors import named_by
from isopeel.case.sections import (
    A_BOUNDARY,
    AcrossDegreeKey,
    BodySection,
    DiscretizationSection,
    GradingKey,
    MaterialSection,
    MeshKey,
    SpaceKey,
)
from isopeel.case.values import LengthKey, Needed, list_of, means, read_quantity, several
from isopeel.common.errors import InputError
from isopeel.common.quantities import ANGLE, LENGTH
from isopeel.common.units import UnitSystem
from isopeel.problem import Body
from isopeel.problem.place import placed
from isopeel.problem.shapes import Shape
from isopeel.splines.rows import RowSpace

_A_NAME = "a name of letters, digits, '_' and '-' is needed, of 40 at most"
_A_PLACE = several(2, LENGTH.needed)
_A_MATERIAL = (
    "a table is needed, such as { law = 'neo-hooke', youngs_modulus = '2 GPa', poissons_ratio = 0.2 }"
)
#: The default of keys of the space.
_USUAL = "that of `[discretization]`"
#: Keys of the space, which a body may have of its own.
_OF_THE_SPACE = ("space", "mesh", "across_degree", "grading")


class PlacedBody(NamedTuple):
    """A body where it is, and its shape as it is without its place."""

    shape: Shape
    body: Body


class BodyTable(BodySection):
    """A body: its shape, turned by an angle about its origin and then moved, its material and its space."""

    name: Annotated[
        str,
        Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,39}$"),
        Needed(_A_NAME),
        means("name of the body, of letters, digits, '_' and '-'", "upper"),
    ]
    material: Annotated[
        MaterialSection,
        Needed(_A_MATERIAL),
        means(
            "a table with the keys of `[material]`",
            {"law": "neo-hooke", "youngs_modulus": "2 GPa", "poissons_ratio": 0.2},
        ),
    ]
    at: Annotated[
        tuple[LengthKey, LengthKey],
        BeforeValidator(list_of(2, _A_PLACE)),
        Needed(_A_PLACE),
        means("place of the origin of the shape", ["0 nm", "20 nm"], usual='`["0 nm", "0 nm"]`'),
    ] = (0.0, 0.0)
    rotated: Annotated[
        float,
        ANGLE,
        BeforeValidator(lambda written: radians(read_quantity(ANGLE, written))),
        means(
            "angle by which the shape is rotated first, anticlockwise about its origin",
            "180 deg",
            usual="none",
        ),
    ] = 0.0
    on: Annotated[
        str | None,
        Needed(A_BOUNDARY),
        means(
            "straight side of another body, BODY.SIDE: after `rotated` and `at`, the body is moved along the "
            "normal of this side, until their distance is `gap`",
            "lower.top",
            usual="none",
        ),
    ] = None
    gap: Annotated[
        LengthKey | None,
        means(
            "smallest distance between the body and the side `on` which it lies",
            "1 nm",
            usual="the equilibrium gap of the interface between them, or 0 without one",
        ),
    ] = None
    space: Annotated[
        SpaceKey | None, means("as in `[discretization]`, for this body", "N2.1", usual=_USUAL)
    ] = None
    mesh: Annotated[MeshKey, means("as in `[discretization]`, for this body", "200x10", usual=_USUAL)] = None
    across_degree: Annotated[
        AcrossDegreeKey, means("as in `[discretization]`, for this body", 2, usual=_USUAL)
    ] = None
    grading: Annotated[
        GradingKey, means("as in `[discretization]`, for this body", [0.1, 1.0], usual=_USUAL)
    ] = None

    @model_validator(mode="after")
    def _gap_to_a_side(self) -> Self:
        if self.gap is not None and (self.on is None or self.gap < 0):
            allowed = "it is the distance from the side that the body lies `on`, and not negative"
            raise InputError("body.gap", self.gap, allowed)
        return self

    def placed(self, key: str) -> PlacedBody:
        """Build the body, without the side that it lies on.

        Raises InputError whose field begins with the key of the table.
        """
        with named_by({"body": key, "material": f"{key}.material"}):
            shape = self.body_shape()
            surface = placed(shape.surface(), self.at, self.rotated)
            return PlacedBody(shape, Body(surface, self.material.material(), self.name))

    def row_space(self, key: str, usual: DiscretizationSection, units: UnitSystem) -> RowSpace:
        """Build the space of the displacement, by the `usual` keys where the body has none of its own.

        It does not depend on the place of the body.

        Raises as `placed` does.
        """
        own = {name: value for name in _OF_THE_SPACE if (value := getattr(self, name)) is not None}
        shape, body = self.placed(key)
        with named_by({f"discretization.{name}": f"{key}.{name}" for name in own}):
            return space_of(shape, body, usual.model_copy(update=own), units)


def check_held(names: Sequence[str], held: Collection[str]) -> None:
    """Raise InputError where a body has no interface, no tie and no support, and is not driven."""
    for number, name in enumerate(names, start=1):
        if name not in held:
            allowed = "nothing holds or drives this body; give it an [[interface]], [[tie]] or [[support]]"
            raise InputError(f"body.{number}.name", name, allowed)


def width_of(tables: Sequence[BodyTable]) -> float | None:
    """Return the width of the bodies, where one has any. Raises InputError where two differ."""
    widths = {number: table.width for number, table in enumerate(tables, start=1) if table.width is not None}
    if len(set(widths.values())) > 1:
        raise InputError(f"body.{max(widths)}.width", max(widths.values()), "all bodies have one width")
    return next(iter(widths.values()), None)
