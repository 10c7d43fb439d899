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
from isopeel.case.values import LengthKey, list_of, read_quantity, several
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
#: Keys of the space, which a body may have of its own.
_OF_THE_SPACE = ("space", "mesh", "across_degree", "grading")


class PlacedBody(NamedTuple):
    """A body where it is, and its shape as it is without its place."""

    shape: Shape
    body: Body


class BodyTable(BodySection):
    """A body: its shape, turned by an angle about its origin and then moved, its material and its space."""

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,39}$", description=_A_NAME)]
    material: Annotated[MaterialSection, Field(description=_A_MATERIAL)]
    at: Annotated[
        tuple[LengthKey, LengthKey], BeforeValidator(list_of(2, _A_PLACE)), Field(description=_A_PLACE)
    ] = (0.0, 0.0)
    rotated: Annotated[float, BeforeValidator(lambda written: radians(read_quantity(ANGLE, written)))] = 0.0
    on: Annotated[str | None, Field(description=A_BOUNDARY)] = None
    gap: LengthKey | None = None
    space: SpaceKey | None = None
    mesh: MeshKey = None
    across_degree: AcrossDegreeKey = None
    grading: GradingKey = None

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
