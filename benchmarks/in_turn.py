"""Programs that trace the same path, advanced and timed in turn, and held to the same moments."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import islice
from statistics import median
from time import perf_counter, process_time

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.table import Table

from scikit_fem_strip import LoadStep

MOMENT_TOLERANCE = 1e-8  # E0 L0^3


@dataclass(frozen=True)
class Block:
    """Consecutive load steps of one program, and the seconds they took."""

    steps: list[LoadStep]
    wall: float
    cpu: float


class Program:
    """A program on its way along the path."""

    def __init__(self, name: str, path: Iterator[LoadStep]) -> None:
        self.name, self._path = name, path
        self.blocks: list[Block] = []

    def advance(self, count: int) -> Block:
        wall, cpu = perf_counter(), process_time()
        steps = list(islice(self._path, count))
        return Block(steps, perf_counter() - wall, process_time() - cpu)

    def per_step(self, quantity: Callable[[Block], float]) -> float:
        """Mean over the timed load steps."""
        return sum(map(quantity, self.blocks)) / sum(len(block.steps) for block in self.blocks)

    def wall_by_block(self) -> list[float]:
        """Seconds per load step."""
        return [block.wall / len(block.steps) for block in self.blocks]


def advance_in_turn(programs: list[Program], count: int) -> tuple[list[Block], float]:
    """Advance each program; return the blocks, and the largest difference from the first's moments.

    Raises ArithmeticError where that is not below the tolerance.
    """
    blocks = [program.advance(count) for program in programs]
    moments = np.array([[step.moment for step in block.steps] for block in blocks])
    differences = abs(moments - moments[0])
    if not differences.max() <= MOMENT_TOLERANCE:
        k, j = np.argwhere(~(differences <= MOMENT_TOLERANCE))[0]
        found = ", ".join(f"{programs[n].name} {moments[n, j]:.10f}" for n in (0, k))
        angle = np.rad2deg(blocks[0].steps[j].theta)
        raise ArithmeticError(f"moments differ at {angle:g} degrees: {found} E0 L0^3")
    return blocks, float(differences.max())


def table(programs: list[Program]) -> Table:
    """Tabulate times per load step, and their ratios to the first program's."""
    result = Table(
        "",
        *("wall ms", "median", "CPU ms", "Newton", "ratio", "median", "range"),
        title="milliseconds and Newton iterations per load step",
        caption="ratio: of wall time to isopeel's; median and range: of blocks\n"
        "plain: as scikit-fem's examples show it; forms: as an expert writes it;\n"
        "hand-tuned: assembled by matrix products",
        box=SIMPLE_HEAD,
        pad_edge=False,
    )
    for column in result.columns[1:]:
        column.justify = "right"
    first = programs[0]
    for program in programs:
        wall, by_block = program.per_step(lambda block: block.wall), program.wall_by_block()
        ratios = [one / other for one, other in zip(by_block, first.wall_by_block(), strict=True)]
        result.add_row(
            program.name,
            f"{1e3 * wall:.2f}",
            f"{1e3 * median(by_block):.2f}",
            f"{1e3 * program.per_step(lambda block: block.cpu):.2f}",
            f"{program.per_step(lambda block: sum(step.iterations for step in block.steps)):.3f}",
            f"{wall / first.per_step(lambda block: block.wall):.2f}",
            f"{median(ratios):.2f}",
            f"{min(ratios):.2f}-{max(ratios):.2f}",
        )
    return result
