"""The strip in isopeel, to the tolerance of the peers."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace

import numpy as np

import isopeel
from peers.laws import HEIGHT, LENGTH
from peers.newton import ENERGY_TOLERANCE, LoadStep


def start(degree: int, elements: tuple[int, int], angles: Iterator[float]) -> Iterator[LoadStep]:
    """Return the path of isopeel."""
    settings = isopeel.NewtonSettings(tolerance=ENERGY_TOLERANCE / (LENGTH * HEIGHT))
    space = isopeel.row_space(f"L{degree}", elements)
    _compile(space, settings)
    try:
        for step in isopeel.trace(isopeel.strip(), space, angles, settings):
            yield LoadStep(step.reaction, len(step.iterations), step.seconds)
    except isopeel.ConvergenceError as error:
        raise ArithmeticError(error.reason) from error


def _compile(space: isopeel.RowSpace, settings: isopeel.NewtonSettings) -> None:
    """Compile all functions before the first timed step, by larger steps and Newton's method."""
    strip = isopeel.strip()
    next(isopeel.trace(strip, space, [0.0], replace(settings, plain=True)))
    with suppress(isopeel.ConvergenceError):
        # until the front has passed some elements
        for _ in isopeel.trace(strip, space, np.radians(np.arange(0.0, 96.0)), settings):
            pass
