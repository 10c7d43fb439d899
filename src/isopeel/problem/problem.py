"""A peeling problem, as data."""

from dataclasses import dataclass, replace
from itertools import combinations
from typing import TypeVar

from isopeel.common.errors import InputError
from isopeel.physics.materials import Material
from isopeel.problem.boundary import Boundary, Driven, boundary_names, driven_boundaries
from isopeel.problem.drives import Drive
from isopeel.problem.interface import Interface
from isopeel.problem.loads import HeldLoad
from isopeel.problem.tie import Tie
from isopeel.splines.nurbs import NurbsSurface, Side

Part = TypeVar("Part")


@dataclass(frozen=True)
class Body:
    """A solid in plane strain: one NURBS patch of a material."""

    shape: NurbsSurface
    material: Material
    name: str = "body"

    def side(self, side: Side, start: float = 0.0, end: float = 1.0) -> Boundary:
        """Return a part of a side."""
        return Boundary(self.name, side, start, end)


@dataclass(frozen=True)
class Support:
    """A boundary whose displacement components (0: x, 1: y) are held, at zero or as the last stage left them.

    On a part of a side, all functions are held that do not vanish there. So the held part extends to the next
    breakpoints, unless it ends at breakpoints.
    """

    boundary: Boundary
    components: tuple[int, ...]

    def __post_init__(self) -> None:
        """Check the components."""
        if not set(self.components) <= {0, 1}:
            raise InputError("support.components", self.components, "components are 0 (x) and 1 (y)")

    @property
    def side(self) -> Side:
        """Of its body."""
        return self.boundary.side


@dataclass(frozen=True)
class Problem:
    """Bodies, their interfaces, their supports, the drive, loads that are held, and ties of sides.

    A drive that names no body acts on the first one. Any consistent units can be used: results call the unit
    of length L0 and that of stress E0, and are for a width of L0.

    Raises InputError if two bodies have one name, if a boundary is of no body, if two supports hold the same
    component on a part of a side, or if a part of a side is tied that is tied or has an interface already.
    """

    name: str
    bodies: tuple[Body, ...]
    interfaces: tuple[Interface, ...]
    supports: tuple[Support, ...]
    drive: Drive
    loads: tuple[HeldLoad, ...] = ()
    ties: tuple[Tie, ...] = ()

    def __post_init__(self) -> None:
        """Check the names, and the supports against each other."""
        names = [body.name for body in self.bodies]
        if not names or len(set(names)) < len(names):
            raise InputError("bodies", names, "at least one is needed, and no two may have the same name")
        boundaries = [one.boundary for one in self.driven]
        for parts in (self.interfaces, self.supports, self.loads):
            boundaries += [one.boundary for one in parts]
        joined = [one.boundary for one in self.interfaces]
        joined += [one.against for one in self.interfaces if isinstance(one.against, Boundary)]
        tied = [boundary for tie in self.ties for boundary in (tie.boundary, tie.to)]
        for boundary in (*boundaries, *joined, *tied):
            if boundary.body not in names:
                raise InputError("body", boundary.body, f"the bodies are {', '.join(names)}")
        for number, boundary in enumerate(tied):
            for others, what in ((tied[:number], "tied already"), (joined, "a side of an interface")):
                if any(boundary.overlaps(other) for other in others):
                    allowed = f"a part of this side is {what}; tie a side once, and where it has no interface"
                    key = f"tie.{number // 2 + 1}.between"
                    raise InputError(key, f"{boundary.body}.{boundary.side}", allowed)
        for (before, one), (number, other) in combinations(enumerate(self.supports, start=1), 2):
            if one.boundary.overlaps(other.boundary) and {*one.components} & {*other.components}:
                place = f"{other.boundary.body}.{other.side}"
                allowed = f"support.{before} already holds a part of it; hold each part once"
                raise InputError(f"support.{number}.boundary", place, allowed)

    @property
    def driven(self) -> tuple[Driven, ...]:
        """The boundaries that the drive acts on, with their factors."""
        return driven_boundaries(self.drive.on, self.bodies[0].name)

    @property
    def driven_names(self) -> tuple[str, ...]:
        """Their names, as `body.right`."""
        return boundary_names([one.boundary for one in self.driven])

    @property
    def driven_side(self) -> Side | None:
        """The side that the drive acts on; None if it acts on several boundaries, or by a factor."""
        (boundary, factor), *others = self.driven
        return None if others or factor != 1.0 else boundary.side

    def side_name(self, boundary: Boundary) -> str:
        """Side of a boundary, with its body where there are several: `right`, or `upper.right`."""
        return boundary.side if len(self.bodies) == 1 else f"{boundary.body}.{boundary.side}"

    def body_of(self, name: str) -> Body:
        """The body of a name."""
        return next(body for body in self.bodies if body.name == name)

    def interface_of(self, name: str = "") -> Interface:
        """Return the interface of one of the `interface_names`, without a name the only one.

        Raises InputError where there is none of the name, or there are several and no name is given.
        """
        if not name:
            return self.adhesion
        if name not in self.interface_names:
            raise InputError("interface", name, f"there is {', '.join(self.interface_names) or 'none'}")
        return self.faces[self.interface_names.index(name)]

    @property
    def is_single(self) -> bool:
        """Whether it is one body with one interface."""
        return len(self.bodies) == len(self.interfaces) == 1

    @property
    def body(self) -> Body:
        """The only body."""
        return _only("body", self.bodies)

    @property
    def adhesion(self) -> Interface:
        """The only interface."""
        return _only("interface", self.interfaces)

    @property
    def faces(self) -> tuple[Interface, ...]:
        """All interfaces as seen from each boundary that is integrated."""
        return tuple(face for interface in self.interfaces for face in interface.faces)

    @property
    def interface_names(self) -> tuple[str, ...]:
        """Body and side of each of the `faces`, as `body.bottom`, with a number where that has several."""
        return boundary_names([one.boundary for one in self.faces])

    def changed(
        self,
        *,
        body: Body | None = None,
        adhesion: Interface | None = None,
        supports: tuple[Support, ...] | None = None,
        drive: Drive | None = None,
    ) -> "Problem":
        """Return the same problem of one body and one interface, with other values for some of its fields."""
        return replace(
            self,
            bodies=self.bodies if body is None else (body,),
            interfaces=self.interfaces if adhesion is None else (adhesion,),
            supports=self.supports if supports is None else supports,
            drive=drive or self.drive,
        )


def _only(kind: str, parts: tuple[Part, ...]) -> Part:
    if len(parts) != 1:
        raise InputError("problem", f"{len(parts)} of the kind {kind}", "this needs exactly one of them")
    return parts[0]
