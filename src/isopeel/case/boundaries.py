"""The tables [[interface]] and [[support]] of a case, and what is common to them: a part of a boundary."""

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Annotated, Any, Literal, NamedTuple, get_args

import numpy as np
from pydantic import Field, PlainValidator, field_validator

from isopeel.case.bodies import PlacedBody
from isopeel.case.errors import named_by
from isopeel.case.sections import A_BOUNDARY, AdhesionSection, SubstrateSection
from isopeel.case.values import LengthKey, Section, read_quantity
from isopeel.common.errors import InputError
from isopeel.common.quantities import LENGTH
from isopeel.common.units import UnitSystem, shown
from isopeel.physics.substrates import Flat, Substrate
from isopeel.problem import Boundary, Interface, Support
from isopeel.problem.boundary import ROUND_OFF
from isopeel.problem.shapes.base import parameter_at_length
from isopeel.splines.nurbs import NurbsCurve, Side

_AN_END = (
    "a length from the left or lower end of the side is needed, such as '20 nm', or the parameter along the"
    " side, a number from 0 to 1"
)
#: A boundary is straight where it leaves its chord by no more than this share of it.
_STRAIGHT = 1e-12


class End(NamedTuple):
    """An end of a part of a side: a length from the start of the side, or the parameter."""

    value: float
    is_length: bool

    def length(self, curve: NurbsCurve) -> float:
        """Length from the start of the side."""
        return self.value if self.is_length else _length_to(curve, self.value)

    def parameter(self, curve: NurbsCurve) -> float:
        """Parameter of the side."""
        return _parameter_at(curve, self.value) if self.is_length else self.value


def _read_end(written: object) -> End:
    if isinstance(written, int | float) and not isinstance(written, bool):
        return End(float(written), is_length=False)
    if not isinstance(written, str):
        raise ValueError(_AN_END)
    return End(read_quantity(LENGTH, written), is_length=True)


EndKey = Annotated[End | None, PlainValidator(_read_end), Field(description=_AN_END)]


class BoundaryTable(Section):
    """A side of a body, or a part of it: between two ends, or by its length from one of them."""

    boundary: Annotated[str, Field(description=A_BOUNDARY)]
    start: EndKey = None
    end: EndKey = None
    length: LengthKey | None = None

    def part(self, key: str, bodies: Mapping[str, PlacedBody], units: UnitSystem) -> Boundary:
        """Find the part of the boundary. Raises InputError whose field begins with the key of the table."""
        name, side = split_boundary(f"{key}.boundary", self.boundary, list(bodies))
        shape, body = bodies[name]
        curve = body.shape.boundary(side)
        for field, end in (("start", self.start), ("end", self.end)):
            if end is not None and not 0 <= end.value <= (_length_to(curve, 1.0) if end.is_length else 1.0):
                allowed = _on_the_side(curve, units)
                if not end.is_length:
                    allowed = f"a number is the parameter along the side, from 0 to 1; {allowed}"
                raise InputError(f"{key}.{field}", end.value, allowed)
        if self.length is None:
            first = 0.0 if self.start is None else self.start.parameter(curve)
            last = 1.0 if self.end is None else self.end.parameter(curve)
        elif self.start is None and self.end is None and side == "bottom" and self.length > 0:
            with named_by({"adhesion": key}):
                first, last = shape.adhering_part(self.length)
        else:
            first, last = self._by_length(self.length, key, curve, units)
        if not last - first > ROUND_OFF:
            raise InputError(f"{key}.end", last, "it must lie beyond the start of the part")
        return Boundary(name, side, first, last)

    def _by_length(
        self, length: float, key: str, curve: NurbsCurve, units: UnitSystem
    ) -> tuple[float, float]:
        """Return the parameters between which a part of a length lies, from one of its ends."""
        if length <= 0 or (self.start is not None and self.end is not None):
            allowed = "it must be positive, and stand with the start or the end of the part, not with both"
            raise InputError(f"{key}.length", length, allowed)
        if self.end is None:
            first = 0.0 if self.start is None else self.start.length(curve)
            last = first + length
        else:
            last = self.end.length(curve)
            first = last - length
        total = _length_to(curve, 1.0)
        if first < -ROUND_OFF * total or last > (1 + ROUND_OFF) * total:
            raise InputError(f"{key}.length", length, _on_the_side(curve, units))
        start, end = (_parameter_at(curve, min(max(at, 0.0), total)) for at in (first, last))
        return start, end


class InterfaceTable(BoundaryTable, AdhesionSection):
    """What attracts a boundary, by a law; a plane along it where no substrate is given."""

    between: Any = None
    substrate: Annotated[
        SubstrateSection | None,
        Field(description="a table is needed, such as { kind = 'flat', height = '0 nm' }"),
    ] = None

    @field_validator("between")
    @classmethod
    def _against_a_substrate(cls, between: object) -> object:
        allowed = "an interface between two bodies is not supported yet; give one boundary, and a substrate"
        raise InputError("adhesion.between", between, allowed)

    def interface_of(self, key: str, bodies: Mapping[str, PlacedBody], units: UnitSystem) -> Interface:
        """Build the interface. Raises InputError whose field begins with the key of the table."""
        boundary = self.part(key, bodies, units)
        with named_by({"adhesion": key, "substrate": f"{key}.substrate"}):
            law, table = self.adhesion_law(), self.substrate
            gap = law.equilibrium_gap if table is None or table.gap is None else table.gap
            surface = self.surface(key, bodies[boundary.body], boundary)
            return self.interface(boundary, law, surface.receded(gap))

    def surface(self, key: str, body: PlacedBody, boundary: Boundary) -> Substrate:
        """Build the substrate as it lies before it recedes by the gap. Raises as `interface_of`."""
        table = self.substrate
        if table is None or table.model_fields_set <= {"gap"}:
            return _plane_along(key, body, boundary)
        return table.surface()


class SupportTable(BoundaryTable):
    """What holds a boundary, at zero or where an earlier stage left it."""

    holds: Annotated[Literal["x", "y", "xy"], Field(description="'x', 'y' or 'xy' is needed")]

    def support(self, key: str, bodies: Mapping[str, PlacedBody], units: UnitSystem) -> Support:
        """Build the support. Raises InputError whose field begins with the key of the table."""
        components = tuple("xy".index(component) for component in self.holds)
        return Support(self.part(key, bodies, units), components)


def check_apart(
    tables: Sequence[InterfaceTable], boundaries: Sequence[Boundary], bodies: Mapping[str, PlacedBody]
) -> None:
    """Raise InputError where two interfaces overlap on one substrate, so that their adhesion would add up."""
    for before, number in combinations(range(len(tables)), 2):
        if not boundaries[number].overlaps(boundaries[before]):
            continue
        one, other = (
            tables[n].surface(f"interface.{n + 1}", bodies[boundaries[n].body], boundaries[n])
            for n in (before, number)
        )
        if _are_one(one, other):
            allowed = (
                f"it overlaps interface.{before + 1} on the same substrate; let each part adhere by one law"
            )
            raise InputError(f"interface.{number + 1}.boundary", tables[number].boundary, allowed)


def _are_one(one: Substrate, other: Substrate) -> bool:
    """Return whether two substrates are one; planes may differ by the round-off of their description."""
    if isinstance(one, Flat) and isinstance(other, Flat):
        size = max(abs(one.height), abs(other.height), 1.0)
        return bool(np.abs(one.parameters - other.parameters).max() <= ROUND_OFF * size)
    return one == other


def split_boundary(key: str, written: str, names: Sequence[str]) -> tuple[str, Side]:
    """Return body and side of BODY.SIDE. Raises InputError where there is no such body or side."""
    name, _, side = written.rpartition(".")
    if name not in names:
        raise InputError(key, written, f"{A_BOUNDARY}, and the bodies are {', '.join(names)}")
    for known in get_args(Side):
        if side == known:
            return name, known
    raise InputError(key, written, f"{A_BOUNDARY}, and the sides are {', '.join(get_args(Side))}")


def _plane_along(key: str, body: PlacedBody, boundary: Boundary) -> Flat:
    """Return the plane along a straight boundary, which faces the body."""
    curve = body.body.shape.boundary(boundary.side)
    first, last = curve.control_points[[0, -1]]
    chord = last - first
    length = float(np.hypot(*chord))
    along = chord / length if length else chord
    across = (curve.control_points - first) @ np.array([-along[1], along[0]])
    if np.abs(across).max() > _STRAIGHT * length or not length:
        allowed = "a plane lies along a straight boundary only; give a table, such as { kind = 'flat' }"
        raise InputError(f"{key}.substrate", None, allowed)
    # xi runs along the lower and the upper side, and eta along the others
    inwards = 1.0 if boundary.side in ("bottom", "right") else -1.0
    normal = inwards * np.array([-along[1], along[0]])
    return Flat(float(normal @ first), float(np.arctan2(normal[1], normal[0])))


def _on_the_side(curve: NurbsCurve, units: UnitSystem) -> str:
    length = shown(_length_to(curve, 1.0), units, length=1)
    return f"the part must lie on the side, which is {length} long"


def _is_linear(curve: NurbsCurve) -> bool:
    return len(curve.control_points) == 2 and bool(np.ptp(curve.weights) == 0)


def _length_to(curve: NurbsCurve, parameter: float) -> float:
    if _is_linear(curve):
        return parameter * float(np.hypot(*np.diff(curve.control_points, axis=0)[0]))
    return curve.length(parameter)


def _parameter_at(curve: NurbsCurve, length: float) -> float:
    return length / _length_to(curve, 1.0) if _is_linear(curve) else parameter_at_length(curve, length)
