"""The tables [[interface]] of a case: a law between a boundary and a substrate, or between two bodies."""

from collections.abc import Mapping, Sequence
from itertools import combinations, product
from typing import Annotated, Self

import numpy as np
from pydantic import BeforeValidator, model_validator

from isopeel.case.bodies import PlacedBody
from isopeel.case.boundaries import TWO_SIDES, PartKeys, SideKey, split_boundary
from isopeel.case.errors import named_by
from isopeel.case.sections import A_BOUNDARY, AdhesionSection, SubstrateSection
from isopeel.case.values import FlagKey, Needed, list_of, means
from isopeel.common.arrays import FloatArray
from isopeel.common.errors import InputError
from isopeel.common.units import UnitSystem
from isopeel.physics.substrates import Flat, Substrate
from isopeel.problem import Boundary, Interface, Scheme
from isopeel.problem.boundary import ROUND_OFF
from isopeel.splines.nurbs import NurbsCurve, Side

#: A boundary is straight where it leaves its chord by no more than this share of it.
_STRAIGHT = 1e-12


class InterfaceTable(PartKeys, AdhesionSection):
    """A law between a boundary and a substrate, or between two bodies.

    Without a substrate, it is a plane along the boundary. Between two bodies, the keys of a part apply to
    each of the two sides that is not a table with keys of its own.
    """

    # between two bodies, a joint law too
    packages = (*AdhesionSection.packages, "isopeel.physics.joints")

    boundary: Annotated[
        str | None,
        Needed(A_BOUNDARY),
        means("BODY.SIDE that adheres to a rigid substrate", "lower.bottom", usual="none, with `between`"),
    ] = None
    between: Annotated[
        tuple[SideKey, SideKey] | None,
        BeforeValidator(list_of(2, TWO_SIDES)),
        Needed(TWO_SIDES),
        means(
            "the sides of two bodies that adhere to each other, in place of `boundary`. In place of "
            "BODY.SIDE, a table with `boundary` and a part of this side is possible",
            ["upper.bottom", "lower.top"],
            usual="none, with `boundary`",
            see="howto/bodies.md#two-bodies-that-adhere-to-each-other",
        ),
    ] = None
    scheme: Annotated[
        Scheme | None,
        Needed("'unbiased', 'biased' or 'two-half-pass' is needed"),
        means(
            "how the sides are integrated, with `between`",
            "biased",
            usual='`"unbiased"`',
            see="howto/bodies.md#two-bodies-that-adhere-to-each-other",
        ),
    ] = None
    smoothed: Annotated[
        FlagKey,
        means(
            "whether closest points are found on a smooth curve through the nodes of a side of Lagrange "
            "elements, with `between`",
            True,
            see="theory/adhesion.md#smoothed-sides",
        ),
    ] = False
    substrate: Annotated[
        SubstrateSection | None,
        Needed("a table is needed, such as { kind = 'flat', height = '0 nm' }"),
        means(
            "a table with the keys of `[substrate]`; not with `between`",
            {"kind": "flat", "height": "0 nm"},
            usual="a plane along the boundary",
        ),
    ] = None

    @model_validator(mode="after")
    def _of_one_kind(self) -> Self:
        if self.between is None:
            if self.boundary is None:
                raise InputError("adhesion.boundary", None, f"the key is missing; {A_BOUNDARY}, or `between`")
            if self.scheme is not None:
                raise InputError("adhesion.scheme", self.scheme, "an interface with a substrate has none")
            return self
        own, against = (name.rpartition(".")[0] for name in self.names)
        if own == against:
            allowed = "the sides must be of two bodies: a body does not adhere to itself"
            raise InputError("adhesion.between", list(self.names), allowed)
        substrate = self.substrate and f"{{ kind = '{self.substrate.kind}' }}"
        for key, value in (("boundary", self.boundary), ("substrate", substrate)):
            if value is not None:
                allowed = "an interface is `between` two bodies, or of a boundary and a substrate"
                raise InputError(f"adhesion.{key}", value, allowed)
        if self.symmetric:
            allowed = "between two bodies there is no mirror plane; leave it out"
            raise InputError("adhesion.symmetric", True, allowed)
        return self

    @property
    def names(self) -> tuple[str, ...]:
        """The two sides that it is between, as BODY.SIDE; none where it is against a substrate."""
        return tuple(side.boundary for side in self.between or ())

    def interface_of(self, key: str, bodies: Mapping[str, PlacedBody], units: UnitSystem) -> Interface:
        """Build the interface. Raises InputError whose field begins with the key of the table."""
        if self.between is not None:
            own, against = self._sides(key, bodies, units)
            with named_by({"adhesion": key}):
                law, scheme = self.adhesion_law(), self.scheme or "unbiased"
                return self.interface(own, law, against, scheme, smoothed=self.smoothed)
        name, side = split_boundary(f"{key}.boundary", str(self.boundary), list(bodies))
        boundary = self.part_of(name, side, key, bodies, units)
        with named_by({"adhesion": key, "substrate": f"{key}.substrate"}):
            law, table = self.adhesion_law(), self.substrate
            gap = law.equilibrium_gap if table is None or table.gap is None else table.gap
            surface = self.surface(key, bodies[name], boundary)
            return self.interface(boundary, law, surface.receded(gap), smoothed=self.smoothed)

    def _sides(
        self, key: str, bodies: Mapping[str, PlacedBody], units: UnitSystem
    ) -> tuple[Boundary, Boundary]:
        found = []
        for number, table in enumerate(self.between or (), start=1):
            place = f"{key}.between.{number}"
            name, side = split_boundary(place, table.boundary, list(bodies))
            keys, of = (table, place) if table.model_fields_set > {"boundary"} else (self, key)
            found.append(keys.part_of(name, side, of, bodies, units))
        own, against = found
        return own, against

    def surface(self, key: str, body: PlacedBody, boundary: Boundary) -> Substrate:
        """Build the substrate as it lies before it recedes by the gap. Raises as `interface_of`."""
        table = self.substrate
        if table is None or table.model_fields_set <= {"gap"}:
            return _plane_along(key, body, boundary)
        return table.surface()


def check_apart(
    tables: Sequence[InterfaceTable], interfaces: Sequence[Interface], bodies: Mapping[str, PlacedBody]
) -> None:
    """Raise InputError where two interfaces overlap and attract to the same, so that they would add up."""
    for before, number in combinations(range(len(tables)), 2):
        for one, other in product(interfaces[before].faces, interfaces[number].faces):
            if not one.boundary.overlaps(other.boundary):
                continue
            if isinstance(one.against, Boundary) and isinstance(other.against, Boundary):
                same = (one.against.body, one.against.side) == (other.against.body, other.against.side)
                key, what = "between", "between the same sides"
            elif isinstance(one.against, Boundary) or isinstance(other.against, Boundary):
                continue
            else:
                surfaces = (
                    tables[n].surface(f"interface.{n + 1}", bodies[face.boundary.body], face.boundary)
                    for n, face in ((before, one), (number, other))
                )
                same = _are_one(*surfaces)
                key, what = "boundary", "on the same substrate"
            if same:
                allowed = f"it overlaps interface.{before + 1} {what}; let each part adhere by one law"
                written = tables[number].boundary or list(tables[number].names)
                raise InputError(f"interface.{number + 1}.{key}", written, allowed)


def _are_one(one: Substrate, other: Substrate) -> bool:
    """Return whether two substrates are one; planes may differ by the round-off of their description."""
    if isinstance(one, Flat) and isinstance(other, Flat):
        size = max(abs(one.height), abs(other.height), 1.0)
        return bool(np.abs(one.parameters - other.parameters).max() <= ROUND_OFF * size)
    return one == other


def inward_normal(curve: NurbsCurve, side: Side) -> FloatArray | None:
    """Return the unit normal (2,) of a straight side that points into its body; None where it is curved."""
    first, last = curve.control_points[[0, -1]]
    chord = last - first
    length = float(np.hypot(*chord))
    along = chord / length if length else chord
    across = (curve.control_points - first) @ np.array([-along[1], along[0]])
    if np.abs(across).max() > _STRAIGHT * length or not length:
        return None
    # xi runs along the lower and the upper side, and eta along the others
    inwards = 1.0 if side in ("bottom", "right") else -1.0
    normal: FloatArray = inwards * np.array([-along[1], along[0]])
    return normal


def _plane_along(key: str, body: PlacedBody, boundary: Boundary) -> Flat:
    """Return the plane along a straight boundary, which faces the body."""
    curve = body.body.shape.boundary(boundary.side)
    normal = inward_normal(curve, boundary.side)
    if normal is None:
        allowed = "a plane lies along a straight boundary only; give a table, such as { kind = 'flat' }"
        raise InputError(f"{key}.substrate", None, allowed)
    return Flat(float(normal @ curve.control_points[0]), float(np.arctan2(normal[1], normal[0])))
