"""Two arms that peel off each other in isopeel, to the tolerance of the peers."""

from collections.abc import Iterator
from contextlib import suppress

import numpy as np

import isopeel
from isopeel.problem.place import placed
from isopeel.splines.nurbs import rectangle
from peers.laws import ADHERING_LENGTH, HAMAKER, HEIGHT, INTERACTION_DISTANCE, LENGTH, POISSON_RATIO
from peers.newton import ENERGY_TOLERANCE, LoadStep, by_processor_time

#: Displacements of the path that compiles all functions: until the front has passed some elements.
_UNTIMED = np.arange(0.0, 14.5)


def start(degree: int, elements: tuple[int, int], displacements: Iterator[float]) -> Iterator[LoadStep]:
    """Return the path of isopeel."""
    # the scale of energies is that of two bodies with Young's modulus 1
    settings = isopeel.NewtonSettings(tolerance=ENERGY_TOLERANCE / (2 * LENGTH * HEIGHT))
    space = isopeel.row_space(f"L{degree}", elements)
    spaces = {"upper": space, "lower": space}
    problem = two_arms()
    with suppress(isopeel.ConvergenceError):
        for _ in isopeel.trace(problem, spaces, _UNTIMED, settings):
            pass
    return by_processor_time(_steps(isopeel.trace(problem, spaces, displacements, settings)))


def _steps(path: Iterator[isopeel.Step]) -> Iterator[LoadStep]:
    try:
        for step in path:
            yield LoadStep(step.reaction, len(step.iterations), step.seconds)
    except isopeel.ConvergenceError as error:
        raise ArithmeticError(error.reason) from error


def two_arms() -> isopeel.Problem:
    """Return two strips at the equilibrium gap, whose right ends are moved apart along y.

    The energy is that of the gaps of the upper arm's points (`biased`), as in NGSolve.
    """
    material = isopeel.NeoHooke(1.0, POISSON_RATIO)
    law = isopeel.VanDerWaals(HAMAKER, INTERACTION_DISTANCE)
    shape = rectangle(LENGTH, HEIGHT)
    upper = isopeel.Body(shape, material, "upper")
    lower = isopeel.Body(placed(shape, (0.0, -HEIGHT - law.equilibrium_gap), 0.0), material, "lower")
    joint = isopeel.Interface(
        upper.side("bottom", end=ADHERING_LENGTH / LENGTH), law, lower.side("top"), scheme="biased"
    )
    supports = isopeel.Support(upper.side("left"), (0,)), isopeel.Support(lower.side("left"), (0, 1))
    apart = isopeel.MovedSide(((upper.side("right"), 1.0), (lower.side("right"), -1.0)), np.pi / 2)
    return isopeel.Problem("two arms", (upper, lower), (joint,), supports, apart)
