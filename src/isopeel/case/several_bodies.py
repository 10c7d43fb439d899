"""The form of a case for several bodies, interfaces, ties and supports, each in a list of tables."""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Field

from isopeel.case.bodies import BodyTable, PlacedBody, check_held, width_of
from isopeel.case.boundaries import SupportTable
from isopeel.case.case import Case
from isopeel.case.errors import renamed
from isopeel.case.interfaces import InterfaceTable, check_apart
from isopeel.case.placing import placed_bodies
from isopeel.case.ties import TieTable
from isopeel.case.values import Needed, means
from isopeel.common.errors import InputError
from isopeel.problem import Boundary, Interface, Support, Tie
from isopeel.problem.boundary import driven_boundaries
from isopeel.splines.rows import RowSpace

#: Tables of the form for one body, and those of several that the system calls by these names. It numbers
#: substrates where there are several interfaces.
_LISTS = {
    "held": "support",
    "adhesion": "interface",
    "substrate": "interface.1.substrate",
    "between": "interface.1.between",
}


class SeveralBodies(Case):
    """Bodies by their names, with any interfaces, ties and supports."""

    body: Annotated[
        tuple[BodyTable, ...],
        Needed("a table [[body]] is needed for each body"),
        means("a body with a name"),
    ]
    interface: Annotated[
        tuple[InterfaceTable, ...],
        Field(min_length=1),
        Needed("a table [[interface]] is needed for each interface, or none"),
        means("a law between a boundary and a substrate, or between two bodies"),
    ] = ()
    tie: Annotated[
        tuple[TieTable, ...],
        Field(min_length=1),
        Needed("a table [[tie]] is needed for each tie, or none"),
        means("two sides that move as one"),
    ] = ()
    support: Annotated[
        tuple[SupportTable, ...],
        Field(min_length=1),
        Needed("a table [[support]] is needed for each support, or none"),
        means("a boundary that is held"),
    ] = ()

    def spaces(self) -> dict[str, RowSpace]:
        """Build the spaces: keys of a body take the place of those of all bodies."""
        units = self.units.system()
        return {
            table.name: table.row_space(f"body.{number}", self.discretization, units)
            for number, table in enumerate(self.body, start=1)
        }

    def each_has(self, key: str) -> bool:
        """Whether each body has a key of its own, so that the one of `discretization` has no effect."""
        return all(getattr(table, key) is not None for table in self.body)

    def named(self, error: InputError) -> InputError:
        """Return an error of the system with the key of the case in place of its field."""
        for number, (table, space) in enumerate(zip(self.body, self.spaces().values(), strict=True), start=1):
            values = {"space": (table.space, space.name), "across_degree": (table.across_degree,) * 2}
            own, used = values.get(error.field, (None, None))
            if own is not None and used == error.value:
                return InputError(f"body.{number}.{error.field}", error.value, error.allowed)
        found = renamed(super().named(error), _LISTS)
        numbers = [n for n, table in enumerate(self.support, start=1) if table.boundary == error.value]
        if found.field == "support" and len(numbers) == 1:
            return InputError(f"support.{numbers[0]}.boundary", found.value, found.allowed)
        return found

    @property
    def width(self) -> float | None:
        """That of all bodies, where one has any."""
        return width_of(self.body)

    @property
    def _only(self) -> str:
        return ""

    def _placed(self) -> dict[str, PlacedBody]:
        width_of(self.body)
        return placed_bodies(self.body, self.interface)

    def _joined(self, placed: Mapping[str, PlacedBody]) -> tuple[tuple[Interface, ...], tuple[Support, ...]]:
        units = self.units.system()
        interfaces = tuple(
            table.interface_of(f"interface.{number}", placed, units)
            for number, table in enumerate(self.interface, start=1)
        )
        supports = tuple(
            table.support(f"support.{number}", placed, units)
            for number, table in enumerate(self.support, start=1)
        )
        check_apart(self.interface, interfaces, placed)
        boundaries = [one.boundary for one in interfaces] + [one.boundary for one in supports]
        boundaries += [one.against for one in interfaces if isinstance(one.against, Boundary)]
        boundaries += [side for one in self._ties(placed) for side in (one.boundary, one.to)]
        boundaries += [one.boundary for drive in self._drives(placed) for one in driven_boundaries(drive.on)]
        check_held(list(placed), {boundary.body for boundary in boundaries})
        return interfaces, supports

    def _ties(self, placed: Mapping[str, PlacedBody]) -> tuple[Tie, ...]:
        units = self.units.system()
        return tuple(
            table.tie(f"tie.{number}", placed, units) for number, table in enumerate(self.tie, start=1)
        )

    def _with_files(self, document: dict[str, Any]) -> dict[str, Any]:
        bodies = [
            written | table.files(f"body.{number}")
            for number, (written, table) in enumerate(zip(document["body"], self.body, strict=True), start=1)
        ]
        return document | {"body": bodies}
