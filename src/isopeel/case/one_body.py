"""The form of a case for one body that adheres with its lower face."""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Field

from isopeel.case.bodies import PlacedBody
from isopeel.case.case import Case
from isopeel.case.discretization import space_of
from isopeel.case.sections import (
    AdhesionSection,
    BodySection,
    HeldSection,
    MaterialSection,
    SubstrateSection,
)
from isopeel.case.values import means
from isopeel.problem import Body, Interface, Support
from isopeel.splines.rows import RowSpace


class OneBody(Case):
    """A body that adheres with its lower face: the tables of the short form."""

    body: Annotated[BodySection, means("the shape of the body")]
    material: Annotated[MaterialSection, means("the material of the body")]
    adhesion: Annotated[AdhesionSection, means("the adhesion of the lower face")]
    substrate: Annotated[SubstrateSection, means("the rigid substrate")] = Field(
        default={}, validate_default=True
    )
    held: Annotated[
        HeldSection | None,
        means(
            "the sides that are held, and in which components",
            usual="the left side in x; the top of a half cylinder in x",
        ),
    ] = None

    def spaces(self) -> dict[str, RowSpace]:
        """That of the body."""
        body = self._body()
        shape, units = self.body.body_shape(), self.units.system()
        return {body.name: space_of(shape, body, self.discretization, units)}

    @property
    def width(self) -> float | None:
        """That of the body."""
        return self.body.width

    def _body(self) -> Body:
        return Body(self.body.body_shape().surface(), self.material.material())

    @property
    def _only(self) -> str:
        return Body.name

    def _placed(self) -> dict[str, PlacedBody]:
        body = self._body()
        return {body.name: PlacedBody(self.body.body_shape(), body)}

    def _joined(self, placed: Mapping[str, PlacedBody]) -> tuple[tuple[Interface, ...], tuple[Support, ...]]:
        (shape, body), law = placed[self._only], self.adhesion.adhesion_law()
        substrate = self.substrate.substrate(law.equilibrium_gap)
        length = self.adhesion.length
        start, end = (0.0, 1.0) if length is None else shape.adhering_part(length)
        interface = self.adhesion.interface(body.side("bottom", start, end), law, substrate)
        usual = (Support(body.side(shape.usual_hold), (0,)),)
        return (interface,), usual if self.held is None else self.held.supports(body)

    def _with_files(self, document: dict[str, Any]) -> dict[str, Any]:
        return document | {"body": document["body"] | self.body.files("body")}
