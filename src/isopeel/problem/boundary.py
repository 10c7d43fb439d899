"""Boundaries: parts of sides of bodies, and those that a drive acts on, by factors."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple, TypeAlias

from isopeel.common.errors import InputError
from isopeel.splines.nurbs import Side, check_side

#: Shortest part of a side, in the parameter: ends that meet are sums of lengths, to round-off.
ROUND_OFF = 1e-12
#: Largest factor, and inverse of the smallest: beyond it one boundary would move by round-off only.
_LARGEST_FACTOR = 1e6


@dataclass(frozen=True)
class Boundary:
    """A part of a side of the body with this name, from parameter `start` to `end` in [0, 1] along it."""

    body: str
    side: Side
    start: float = 0.0
    end: float = 1.0

    def __post_init__(self) -> None:
        """Check the side and the interval."""
        check_side("boundary.side", self.side)
        if not (0 <= self.start < self.end - ROUND_OFF and self.end <= 1):
            raise InputError("boundary", (self.start, self.end), "need 0 <= start < end <= 1 along the side")

    @property
    def part(self) -> tuple[float, float]:
        """Its first and last parameter."""
        return self.start, self.end

    @property
    def is_whole(self) -> bool:
        """Whether it is all of the side."""
        return self.part == (0.0, 1.0)

    def overlaps(self, other: "Boundary") -> bool:
        """Return whether two boundaries have a part of a side in common, not only an end to round-off."""
        same = (self.body, self.side) == (other.body, other.side)
        return same and min(self.end, other.end) - max(self.start, other.start) > ROUND_OFF


class Driven(NamedTuple):
    """A boundary that a drive acts on, and its factor on the motion or the load of the drive."""

    boundary: Boundary
    factor: float


#: Where a drive acts: on a side of the first body, on a boundary, or on several boundaries by factors.
Place: TypeAlias = Side | Boundary | tuple[tuple[Boundary, float], ...]


def driven_boundaries(on: Place, body: str = "") -> tuple[Driven, ...]:
    """Return the boundaries of a drive; a side, or a boundary without a name, is of the named body.

    Raises InputError where there is no such side, a factor is out of bounds, or boundaries overlap.
    """
    if isinstance(on, str):
        check_side("drive.side", on)
        on = Boundary(body, on)
    elif not isinstance(on, Boundary) and not all(one.body for one, _ in on):
        raise InputError("drive.on", "", "of several boundaries each needs the name of its body")
    pairs = ((on, 1.0),) if isinstance(on, Boundary) else on
    found = tuple(
        Driven(one if one.body else Boundary(body, one.side, *one.part), float(factor))
        for one, factor in pairs
    )
    if not found:
        raise InputError("drive.on", (), "a drive acts on one boundary at least")
    for number, one in enumerate(found, start=1):
        if not 1 / _LARGEST_FACTOR <= abs(one.factor) <= _LARGEST_FACTOR:
            allowed = f"its size must be from {1 / _LARGEST_FACTOR:g} to {_LARGEST_FACTOR:g}"
            raise InputError(f"drive.on.{number}.factor", one.factor, allowed)
    for one, other in combinations(found, 2):
        if one.boundary.overlaps(other.boundary):
            (name,) = boundary_names([one.boundary])
            raise InputError("drive.on", name, "the drive acts twice on one part of it; name it once")
    return found


def boundary_names(boundaries: Sequence[Boundary]) -> tuple[str, ...]:
    """Body and side of each boundary, as `body.bottom`, with a number where a side has several."""
    names: list[str] = []
    for boundary in boundaries:
        name = f"{boundary.body}.{boundary.side}"
        known = sum(other.partition("#")[0] == name for other in names)
        names.append(f"{name}#{known + 1}" if known else name)
    return tuple(names)
