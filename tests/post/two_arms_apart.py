"""Two equal arms that adhere to each other and are turned apart, and one of them on its mirror plane."""

from collections.abc import Sequence

import numpy as np

from isopeel import (
    Body,
    Curve,
    Exponential,
    Flat,
    Interface,
    NeoHooke,
    NewtonSettings,
    Problem,
    RotatedSide,
    RowSpace,
    Step,
    Support,
    row_space,
    trace,
)
from isopeel.assembly.spaces import SpaceOfBodies
from isopeel.common.arrays import FloatArray
from isopeel.physics.adhesion.mirrored import Mirrored
from isopeel.problem import Scheme
from isopeel.problem.place import placed
from isopeel.results.fields import StoredState
from isopeel.results.provenance import Provenance
from isopeel.results.run_file import StoredRun, run_attributes
from isopeel.splines.nurbs import rectangle

LENGTH, HEIGHT, PART = 30.0, 3.0, 0.7
#: Soft enough for a process zone of three elements.
LAW = Exponential(0.03, 0.02)
SOFT = NeoHooke(1.0, 0.3)
UPPER = Body(rectangle(LENGTH, HEIGHT), SOFT, "upper")
LOWER = Body(placed(rectangle(LENGTH, HEIGHT), (0.0, -HEIGHT), 0.0), SOFT, "lower")
HELD = Support(UPPER.side("left"), (0,))
SPACE: RowSpace = row_space("N2", (30, 2), 2)
SPACES = {"upper": SPACE, "lower": SPACE}
ANGLES = np.radians(np.arange(0.0, 111.0, 5.0))


def two(scheme: Scheme = "unbiased", *, irreversible: bool = False) -> Problem:
    """The two arms."""
    joint = Interface(
        UPPER.side("bottom", end=PART),
        LAW,
        LOWER.side("top", end=PART),
        irreversible=irreversible,
        scheme=scheme,
    )
    turn = RotatedSide(((UPPER.side("right"), 1.0), (LOWER.side("right"), -1.0)))
    held = HELD, Support(LOWER.side("left"), (0, 1))
    return Problem("two", (UPPER, LOWER), (joint,), held, turn)


def one() -> Problem:
    """The upper arm and its mirror image."""
    joint = Interface(UPPER.side("bottom", end=PART), Mirrored(LAW), Flat())
    return Problem("one", (UPPER,), (joint,), (HELD,), RotatedSide("right"))


def steps_of(problem: Problem, space: SpaceOfBodies, path: FloatArray = ANGLES) -> list[Step]:
    """The steps along a path, with cuts and jumps where they are needed."""
    return list(trace(problem, space, path, NewtonSettings(path_control="auto")))


def run_of(problem: Problem, space: SpaceOfBodies, steps: Sequence[Step]) -> StoredRun:
    """A run of which every second state is stored, and the last one."""
    attributes = run_attributes(problem, space, Provenance({}, "", "", "", ""))
    kept = [*steps[:-1:2], steps[-1]]
    states = tuple(StoredState.of(step, problem.drive) for step in kept)
    curve = Curve.of(steps, problem.drive)
    return StoredRun("", curve, states, attributes | {"L0": "1 nm", "E0": "1 GPa"}, "completed")
