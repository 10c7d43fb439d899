"""Time of two arms that peel off each other, in isopeel and in NGSolve by its `ContactBoundary`."""

import sys
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

import isopeel
from comparison import Comparison, Entry
from isopeel.case import parse_mesh
from isopeel.common.arrays import FloatArray
from load_step import machine
from peers.laws import ADHERING_LENGTH, LENGTH
from peers.names import ARMS
from peers.newton import LoadStep
from programs import GoneError, Program

#: Two programs agree if their forces differ by less, as a share of the largest one.
FORCE_TOLERANCE = 1e-5


@dataclass
class Path:
    """A program, and its steps at all displacements so far."""

    program: Program
    steps: list[LoadStep] = field(default_factory=list)

    @property
    def forces(self) -> FloatArray:
        """Forces (steps,) in E0 nm."""
        return np.array([step.moment for step in self.steps])

    @property
    def seconds(self) -> float:
        """Processor time of all steps."""
        return sum(step.seconds for step in self.steps)


def run(paths: list[Path], displacements: FloatArray, block: int) -> str | None:
    """Trace both paths in turn, by blocks of load steps, and return where and why one ends early."""
    for first in range(0, displacements.size, block):
        part = displacements[first : first + block].tolist()
        ends = []
        for path in paths:
            path.program.begin(part)
            found = path.program.finish()
            path.steps += found.steps
            if found.stopped:
                at = part[len(found.steps)]
                ends.append(f"no equilibrium at {at:g} nm: {path.program.label} ({found.stopped})")
        if ends:
            count = min(len(path.steps) for path in paths)
            for path in paths:
                del path.steps[count:]
            return "; ".join(ends)
    return None


def table(paths: list[Path]) -> Table:
    """Return times, corrections and deviations of the paths, isopeel first."""
    result = Table(
        "", "seconds", "ms a step", "corrections", "ms each", "ratio", "deviation", box=SIMPLE_HEAD
    )
    for column in result.columns[1:]:
        column.justify = "right"
    result.columns[0].no_wrap = True
    for path in paths:
        corrections, count = sum(step.iterations for step in path.steps), len(path.steps)
        result.add_row(
            path.program.label,
            f"{path.seconds:.1f}",
            f"{1e3 * path.seconds / count:.1f}",
            f"{corrections / count:.2f}",
            f"{1e3 * path.seconds / corrections:.1f}",
            f"{path.seconds / paths[0].seconds:.2f}",
            f"{deviation(path, paths[0]):.1e}",
        )
    result.caption = (
        "processor time; deviation: largest difference of forces, as a share of the largest force"
    )
    return result


def deviation(path: Path, other: Path) -> float:
    """Return the largest difference of forces at one step, as a share of the largest force."""
    return float(np.abs(path.forces - other.forces).max() / np.abs(other.forces).max())


def main(
    mesh: Annotated[str, typer.Option(help="Elements of one arm along length x height.")] = "200x10",
    to: Annotated[float, typer.Option(help="Last displacement of each end, in nm.")] = 18.0,
    step: Annotated[float, typer.Option(help="Displacement per load step, in nm.")] = 0.1,
    block: Annotated[int, typer.Option(min=1, help="Load steps of one program in one turn.")] = 10,
) -> None:
    """Compare two arms of degree 2 in isopeel and in NGSolve, on one thread."""
    elements = parse_mesh("--mesh", mesh)
    if elements[0] * ADHERING_LENGTH % LENGTH:
        raise isopeel.InputError("--mesh", mesh, "3/4 of the elements along x must adhere")
    if not 0 < step <= to:
        raise isopeel.InputError("--to, --step", f"{to:g}, {step:g}", "0 < step <= to is needed")
    paths = [Path(Program(name, 2, elements)) for name in ARMS]
    count = round(to / step)
    ended = run(paths, np.linspace(0.0, step * count, count + 1), block)
    console = Console(highlight=False)
    if ended:
        console.print(ended, soft_wrap=True)
    count = len(paths[0].steps) - 1
    if count < 1:
        raise ArithmeticError("no step was timed")
    forces = paths[0].forces
    console.print(f"two arms of {mesh}, L2: {count + 1} load steps of {step:g} nm, 0 to {step * count:g} nm")
    console.print(f"the largest force is {forces.max():.8f} E0 L0, the last is {forces[-1]:.8f}")
    console.print(table(paths))
    console.print(machine(Comparison([Entry(path.program) for path in paths])), soft_wrap=True)
    for path in paths:
        path.program.close()
    if not deviation(paths[1], paths[0]) < FORCE_TOLERANCE:
        raise ArithmeticError(f"the forces differ by more than {FORCE_TOLERANCE:g}")


if __name__ == "__main__":
    try:
        typer.run(main)
    except (ValueError, ArithmeticError, GoneError) as error:
        sys.exit(f"arms: {error}")
