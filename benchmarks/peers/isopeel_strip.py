"""The strip in isopeel, to the tolerance of the peers."""

from collections.abc import Iterator

import isopeel
from peers.laws import HEIGHT, LENGTH
from peers.newton import ENERGY_TOLERANCE, LoadStep


def start(degree: int, elements: tuple[int, int], angles: Iterator[float]) -> Iterator[LoadStep]:
    """Start isopeel on its path."""
    settings = isopeel.NewtonSettings(tolerance=ENERGY_TOLERANCE / (LENGTH * HEIGHT))
    space = isopeel.row_space(f"L{degree}", elements)
    for plain in (True, False):
        # compile what steps call, Newton's method among it, before the first one that is timed
        small = isopeel.row_space(f"L{degree}", (20, 2))
        next(isopeel.trace(isopeel.strip(), small, [0.0], isopeel.NewtonSettings(plain=plain)))
    try:
        for step in isopeel.trace(isopeel.strip(), space, angles, settings):
            yield LoadStep(step.reaction, len(step.iterations), step.seconds)
    except isopeel.ConvergenceError as error:
        raise ArithmeticError(error.reason) from error
