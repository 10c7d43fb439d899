"""Ties: sides of bodies that move as one."""

from dataclasses import dataclass

from isopeel.common.errors import InputError
from isopeel.problem.boundary import Boundary


@dataclass(frozen=True)
class Tie:
    """A whole side of a body that follows the side of another body that it lies on.

    So several patches make one solid, each with its material and its mesh. The displacement of the side
    equals that of the other one where both have the same functions, or where the following side can represent
    all functions of the other one, as a refined mesh does. Elsewhere it is the mortar projection of the other
    displacement, with the weighted integrals of both equal (`isopeel.assembly.mortar`): then the finer side
    should follow.

    Raises InputError for a part of a side that follows, or for sides of one body.
    """

    boundary: Boundary
    to: Boundary

    def __post_init__(self) -> None:
        """Check the boundaries."""
        if not self.boundary.is_whole:
            allowed = "a whole side follows the other one; exchange them, or divide the body"
            raise InputError("tie.boundary", self.boundary.part, allowed)
        if self.boundary.body == self.to.body:
            raise InputError("tie.to", self.to.body, "it must be the side of another body")
