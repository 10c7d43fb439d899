"""Where a drive of a case acts: the keys that all kinds of drives have."""

from typing import Annotated

from pydantic import Field

from isopeel.case.values import NumberKey, Section, key_of
from isopeel.common.errors import InputError
from isopeel.problem import Boundary, Place
from isopeel.splines.nurbs import Side

A_SIDE = key_of(Side).needed


class DrivenKeys(Section):
    """A side of the body, or its part from one parameter along it to another."""

    side: Annotated[Side | None, Field(description=A_SIDE)] = None
    start: NumberKey = 0.0
    end: NumberKey = 1.0

    def place(self, body: str, usual: Place | None) -> Place:
        """Where it acts on a body; a usual place where no side is given. Raises InputError."""
        if not 0 <= self.start < self.end <= 1:
            raise InputError("drive", (self.start, self.end), "need 0 <= start < end <= 1 along the side")
        side = self.side
        if side is None:
            if not isinstance(usual, str):
                raise InputError("drive.side", None, f"the key is missing; {A_SIDE}")
            side = usual
        if not body and (self.start, self.end) == (0.0, 1.0):
            return side
        return Boundary(body, side, self.start, self.end)
