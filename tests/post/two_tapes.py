"""Two tapes beside each other on one substrate, each with its own law, and each of them alone."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from isopeel import (
    Body,
    Exponential,
    Flat,
    Interface,
    MovedSide,
    NeoHooke,
    Problem,
    PulledSide,
    RotatedSide,
    RowSpace,
    Support,
    row_space,
)
from isopeel.problem import Drive
from isopeel.problem.boundary import driven_boundaries
from isopeel.splines.nurbs import NurbsSurface, rectangle

#: The laws of both, weak enough for the front to be longer than an element; the second is damaged.
LAWS = Exponential(0.03, 0.015, 0.3), Exponential(0.02, 0.01, 0.2)


def tape(length: float, height: float, at: tuple[float, float]) -> NurbsSurface:
    """A rectangle with its lower left corner somewhere."""
    shape = rectangle(length, height)
    return replace(shape, control_points=shape.control_points + np.array(at))


FIRST = Body(tape(80.0, 4.0, (0.0, 0.3)), NeoHooke(1.0, 0.2), "first")
SECOND = Body(tape(60.0, 3.0, (110.0, 0.2)), NeoHooke(0.8, 0.3), "second")
JOINTS = (
    Interface(FIRST.side("bottom", end=0.75), LAWS[0], Flat()),
    Interface(SECOND.side("bottom", end=0.8), LAWS[1], Flat(), irreversible=True),
)
SPACES: Mapping[str, RowSpace] = {"first": row_space("N2.1", (40, 2)), "second": row_space("N3", (30, 2))}


def alone(number: int, drive: Drive) -> Problem:
    """One of the tapes, held at its left end."""
    body = (FIRST, SECOND)[number]
    return Problem(body.name, (body,), (JOINTS[number],), (Support(body.side("left"), (0,)),), drive)


def both(drive: RotatedSide | MovedSide | PulledSide, driven: str) -> Problem:
    """Both tapes in one problem, of which the drive acts on one."""
    supports = (Support(FIRST.side("left"), (0,)), Support(SECOND.side("left"), (0,)))
    ((boundary, _),) = driven_boundaries(drive.on, driven)
    return Problem("two", (FIRST, SECOND), JOINTS, supports, replace(drive, on=boundary))
