"""Parts of boundaries, as the tables of a case name them, and the tables [[support]]."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Literal, NamedTuple, get_args

import numpy as np
from pydantic import BeforeValidator, PlainValidator

from isopeel.case.bodies import PlacedBody
from isopeel.case.errors import named_by
from isopeel.case.sections import A_BOUNDARY
from isopeel.case.values import LengthKey, Needed, Section, means, read_quantity
from isopeel.common.errors import InputError
from isopeel.common.quantities import LENGTH, NUMBER
from isopeel.common.units import UnitSystem, shown
from isopeel.problem import Boundary, Support
from isopeel.problem.boundary import ROUND_OFF
from isopeel.problem.shapes.base import parameter_at_length
from isopeel.splines.nurbs import NurbsCurve, Side

_AN_END = (
    "a length from the left or lower end of the side is needed, such as '20 nm', or the parameter along the"
    " side, a number from 0 to 1"
)


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


EndKey = Annotated[End | None, LENGTH, NUMBER, PlainValidator(_read_end), Needed(_AN_END)]


StartOfPart = Annotated[
    EndKey,
    means(
        "start of a part of the side: a length from its left or lower end, or the parameter from 0 to 1",
        "20 nm",
        usual="the start of the side",
        see="howto/bodies.md#parts-of-a-side",
    ),
]
EndOfPart = Annotated[
    EndKey,
    means(
        "end of the part, in the same way",
        "80 nm",
        usual="the end of the side",
        see="howto/bodies.md#parts-of-a-side",
    ),
]
LengthOfPart = Annotated[
    LengthKey | None,
    means(
        "length of the part, from its start or to its end",
        "60 nm",
        usual="the whole side",
        see="howto/bodies.md#parts-of-a-side",
    ),
]


class PartKeys(Section):
    """The keys of a part of a side: between two ends, or by its length from one of them."""

    start: StartOfPart = None
    end: EndOfPart = None
    length: LengthOfPart = None

    def part_of(
        self, name: str, side: Side, key: str, bodies: Mapping[str, PlacedBody], units: UnitSystem
    ) -> Boundary:
        """Find the part of a side. Raises InputError whose field begins with the key of the table."""
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


class BoundaryTable(PartKeys):
    """A side of a body, or a part of it."""

    boundary: Annotated[str, Needed(A_BOUNDARY), means("a side of a body, BODY.SIDE", "upper.right")]

    def part(self, key: str, bodies: Mapping[str, PlacedBody], units: UnitSystem) -> Boundary:
        """Find the part of the boundary. Raises InputError whose field begins with the key of the table."""
        name, side = split_boundary(f"{key}.boundary", self.boundary, list(bodies))
        return self.part_of(name, side, key, bodies, units)


TWO_SIDES = "a list of 2 boundaries is needed, such as ['upper.bottom', 'lower.top']"
#: One of the two sides of an interface or a tie: its name, or a table of a part of it.
SideKey = Annotated[
    BoundaryTable,
    BeforeValidator(lambda written: {"boundary": written} if isinstance(written, str) else written),
]


class SupportTable(BoundaryTable):
    """What holds a boundary, at zero or where an earlier stage left it."""

    holds: Annotated[
        Literal["x", "y", "xy"],
        Needed("'x', 'y' or 'xy' is needed"),
        means("components of the displacement that are held", "xy"),
    ]

    def support(self, key: str, bodies: Mapping[str, PlacedBody], units: UnitSystem) -> Support:
        """Build the support. Raises InputError whose field begins with the key of the table."""
        components = tuple("xy".index(component) for component in self.holds)
        return Support(self.part(key, bodies, units), components)


def split_boundary(key: str, written: str, names: Sequence[str]) -> tuple[str, Side]:
    """Return body and side of BODY.SIDE. Raises InputError where there is no such body or side."""
    name, _, side = written.rpartition(".")
    if name not in names:
        raise InputError(key, written, f"{A_BOUNDARY}, and the bodies are {', '.join(names)}")
    for known in get_args(Side):
        if side == known:
            return name, known
    raise InputError(key, written, f"{A_BOUNDARY}, and the sides are {', '.join(get_args(Side))}")


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
