"""The tables [[tie]] of a case: sides of two bodies that move as one."""

from collections.abc import Mapping
from typing import Annotated, Self

from pydantic import BeforeValidator, model_validator

from isopeel.case.bodies import PlacedBody
from isopeel.case.boundaries import TWO_SIDES, SideKey
from isopeel.case.values import Needed, Section, list_of, means
from isopeel.common.errors import InputError
from isopeel.common.units import UnitSystem
from isopeel.problem import Tie


class TieTable(Section):
    """A whole side of a body that follows the side of another body that it lies on, or a part of that."""

    between: Annotated[
        tuple[SideKey, SideKey],
        BeforeValidator(list_of(2, TWO_SIDES)),
        Needed(TWO_SIDES),
        means(
            "a whole side of a body, and the side of another body that it follows. In place of the second "
            "BODY.SIDE, a table with `boundary` and a part of this side is possible",
            ["upper.bottom", "lower.top"],
            see="howto/bodies.md#layers-and-other-solids-of-several-bodies",
        ),
    ]

    @property
    def names(self) -> list[str]:
        """The two sides, as BODY.SIDE."""
        return [side.boundary for side in self.between]

    @model_validator(mode="after")
    def _of_two_bodies(self) -> Self:
        own, to = self.between
        if own.boundary.rpartition(".")[0] == to.boundary.rpartition(".")[0]:
            allowed = "the sides must be of two bodies: a body is not tied to itself"
            raise InputError("tie.between", self.names, allowed)
        if own.model_fields_set > {"boundary"}:
            allowed = "the first side follows as a whole; give a part of the second one only"
            raise InputError("tie.between", self.names, allowed)
        return self

    def tie(self, key: str, bodies: Mapping[str, PlacedBody], units: UnitSystem) -> Tie:
        """Build the tie. Raises InputError whose field begins with the key of the table."""
        own, to = (
            side.part(f"{key}.between.{number}", bodies, units)
            for number, side in enumerate(self.between, start=1)
        )
        return Tie(own, to)
