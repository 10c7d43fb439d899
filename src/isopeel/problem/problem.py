"""A peeling problem, as data."""

from dataclasses import dataclass
from typing import Literal, get_args

from isopeel.common.errors import InputError
from isopeel.physics.adhesion import AdhesionLaw
from isopeel.physics.materials import Material
from isopeel.physics.substrates import Substrate
from isopeel.problem.drives import Drive
from isopeel.splines.nurbs import NurbsSurface, Side, check_side

#: Area that the adhesive traction acts on: the reference area, or its projection on the substrate.
Traction = Literal["reference", "projected"]


@dataclass(frozen=True)
class Body:
    """A solid in plane strain: one NURBS patch of a material."""

    shape: NurbsSurface
    material: Material


@dataclass(frozen=True)
class AdhesiveSide:
    """The part of a side, from parameter `start` to `end` in [0, 1], that a substrate attracts.

    Force on the body, F_c = -int N^T T n_o dA per reference area dA (`reference`; it has a potential), or the
    same with dA projected on the substrate, times -n_o . F^-T N_o (`projected`; its tangent is not
    symmetric), with the substrate's normal n_o and the outward normal N_o of the side (Sadhana 46:3, 2021,
    Eq. 19, read in two ways). Where it is `irreversible`, what has opened closes again along the secant of
    the law (`physics.adhesion.irreversible`). Without a `sliding_length` it slides along the substrate
    without friction, with one it is held there as well (`physics.adhesion.sliding`).
    """

    side: Side
    law: AdhesionLaw
    substrate: Substrate
    start: float = 0.0
    end: float = 1.0
    traction: Traction = "reference"
    irreversible: bool = False
    sliding_length: float | None = None

    def __post_init__(self) -> None:
        """Check the side, the interval, the kind of traction and what holds along the substrate."""
        check_side("adhesion.side", self.side)
        if self.traction not in get_args(Traction):
            raise InputError("adhesion.traction", self.traction, f"it is {' or '.join(get_args(Traction))}")
        if not 0 <= self.start < self.end <= 1:
            raise InputError("adhesion", (self.start, self.end), "need 0 <= start < end <= 1 along the side")
        if self.sliding_length is None:
            return
        if not 0 < self.sliding_length < float("inf"):
            raise InputError("adhesion.sliding_length", self.sliding_length, "it must be positive")
        if self.irreversible or self.traction != "reference":
            allowed = "a joint that holds along the substrate is reversible, with 'reference' traction"
            raise InputError("adhesion.sliding_length", self.sliding_length, allowed)


@dataclass(frozen=True)
class FixedSide:
    """A side of which displacement components (0: x, 1: y) are held, at zero or where a stage left them."""

    side: Side
    components: tuple[int, ...]

    def __post_init__(self) -> None:
        """Check the side and the components."""
        check_side("fixed.side", self.side)
        if not set(self.components) <= {0, 1}:
            raise InputError("fixed.components", self.components, "components are 0 (x) and 1 (y)")


@dataclass(frozen=True)
class Problem:
    """A body, where it adheres, what is held, and the drive.

    Any consistent units: results call the unit of length L0 and that of stress E0, and are for a width of L0.
    """

    name: str
    body: Body
    adhesion: AdhesiveSide
    fixed: tuple[FixedSide, ...]
    drive: Drive
