"""Time and memory of a load step over the size of strip and mesh, and the gain of more processes."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from statistics import mean, median
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.progress import Progress
from rich.table import Table
from threadpoolctl import threadpool_limits

import machine
from isopeel import ConvergenceError, InputError
from isopeel.case import parse_mesh
from isopeel.common.processes import compute_all, cores
from isopeel.paper.study import table_runs
from peeling import LENGTH, STEP, TIMED, Strip, left_out, peel
from printing import plain_table, wide_console
from published import follow_all

FAMILIES = ("longer", "along", "across")
#: Lengths of strips, in lengths of the shipped strip.
LENGTHS = (1, 2, 5, 10)
#: Factors on the number of elements of a mesh.
REFINEMENTS = (0.5, 1, 2)


@dataclass(frozen=True)
class Measured:
    """Of one strip."""

    strip: Strip
    unknowns: int
    seconds: list[float]  # of each timed step
    corrections: float  # per step
    peak: float  # MB
    added: float  # MB beyond those of a strip of few elements


def family(name: str, space: str, mesh: tuple[int, int]) -> list[Strip]:
    """Return strips of increasing size."""
    x, y = mesh
    if name not in FAMILIES:
        raise InputError("--growth", name, f"a strip can grow {', '.join(FAMILIES)}")
    match name:
        case "longer":
            return [Strip(space, (x * times, y), LENGTH * times) for times in LENGTHS]
        case "along":
            return [Strip(space, (round(x * times), y)) for times in REFINEMENTS]
        case _:
            return [Strip(space, (x, round(y * times))) for times in REFINEMENTS]


def measure(strip: Strip, reach: float, coarse: float, steps: int) -> Measured:
    """Time the steps of a strip in a process that has computed nothing else."""
    # load everything that is loaded only once
    for _ in peel(Strip(strip.space, (10, 1)), 2.0, 1.0, 1):
        pass
    before = machine.peak_megabytes()
    unknowns, seconds, corrections = 0, [], []
    with threadpool_limits(1):
        for step in peel(strip, reach, coarse, steps):
            unknowns = step.unknown_values.size
            seconds.append(step.seconds)
            corrections.append(len(step.iterations))
    peak = machine.peak_megabytes()
    return Measured(strip, unknowns, seconds, mean(corrections), peak, peak - before)


def measure_alone(strip: Strip, reach: float, coarse: float, steps: int) -> Measured:
    """Do the same in a separate process."""
    (done,) = compute_all([partial(measure, strip, reach, coarse, steps)], 1, lambda *_: None)
    assert isinstance(done.outcome, Measured)
    return done.outcome


def exponent(sizes: Sequence[float], times: Sequence[float]) -> float:
    """Return the exponent k of time ~ size^k, fitted to the logarithms; nan for one size."""
    if len(sizes) < 2:
        return float("nan")
    return float(np.polyfit(np.log(sizes), np.log(times), 1)[0])


def scaling_table(families: Sequence[tuple[str, list[Measured]]]) -> Table:
    """Return the table of times and memory, with the exponents of the times below each family."""
    table = plain_table(
        "a load step, by the size of the strip and its mesh",
        *("space", "growth", "nm", "mesh", "unknowns", "corrections", "median ms", "mean ms"),
        *("peak MB", "added MB"),
        caption="growth: of the strip with its mesh, of the mesh along it, of the mesh across it;\n"
        "added: to what a process takes for a strip of 10 elements; exponent: of the unknowns",
    )
    for name, members in families:
        for one in members:
            table.add_row(
                one.strip.space,
                name,
                f"{one.strip.length:g}",
                "{}x{}".format(*one.strip.mesh),
                str(one.unknowns),
                f"{one.corrections:.2f}",
                f"{1e3 * median(one.seconds):.2f}",
                f"{1e3 * mean(one.seconds):.2f}",
                f"{one.peak:.0f}",
                f"{one.added:.1f}",
            )
        unknowns = [one.unknowns for one in members]
        fitted = [exponent(unknowns, [of(one.seconds) for one in members]) for of in (median, mean)]
        table.add_row("", "exponent", *[""] * 4, *(f"{k:.2f}" for k in fitted))
        table.add_section()
    return table


def print_speed_up(console: Console, to: float) -> None:
    """Time the first steps of the published runs on one mesh, in one process and in one process per core."""
    runs = table_runs(["m2"])
    studies = {workers: follow_all(runs, to, workers) for workers in dict.fromkeys((1, cores()))}
    table = plain_table(
        f"{len(runs)} runs on m2 to {to:g} degrees",
        *("processes", "seconds", "of it starting", "speed-up"),
        labels=0,
    )
    for workers, study in studies.items():
        ratio = studies[1].wall / study.wall
        table.add_row(str(workers), f"{study.wall:.1f}", f"{max(study.started):.1f}", f"{ratio:.2f}")
    console.print(table)


def main(
    space: Annotated[list[str] | None, typer.Option(help="N2.1 and L4 when left out; repeatable.")] = None,
    growth: Annotated[
        list[str] | None, typer.Option(help=f"{', '.join(FAMILIES)}; all when left out; repeatable.")
    ] = None,
    mesh: Annotated[str, typer.Option(help="Elements of the strip that all others vary.")] = "200x10",
    reach: Annotated[float, typer.Option(help="Degrees at the end of the untimed steps.")] = 90.0,
    coarse: Annotated[float, typer.Option(help="Degrees of an untimed step.")] = 1.0,
    steps: Annotated[int, typer.Option(min=1, help=f"Timed steps, of {STEP} degrees.")] = TIMED,
    processes: Annotated[
        bool, typer.Option("--processes", help="Time the study in one process and in more, instead.")
    ] = False,
    to: Annotated[float, typer.Option(min=0, help="Last angle of --processes, in degrees.")] = 40.0,
) -> None:
    """Print time and memory per load step over the size of the strip, on one thread."""
    console = wide_console()
    if processes:
        print_speed_up(console, to)
    else:
        elements = parse_mesh("--mesh", mesh)
        families = [
            (name, family(name, chosen, elements))
            for chosen in space or ("N2.1", "L4")
            for name in growth or FAMILIES
        ]
        # refreshed between strips only: a drawing thread would take time from them
        bar = Progress(console=Console(stderr=True), auto_refresh=False, transient=True)
        measured: list[tuple[str, list[Measured]]] = []
        with bar:
            task = bar.add_task("strips", total=sum(len(strips) for _, strips in families))
            for name, strips in families:
                measured.append((name, []))
                for strip in strips:
                    try:
                        measured[-1][1].append(measure_alone(strip, reach, coarse, steps))
                    except ConvergenceError as error:
                        console.print(left_out(strip, error))
                    bar.advance(task)
                    bar.refresh()
        console.print(scaling_table(measured))
    console.print(machine.description(), soft_wrap=True)


if __name__ == "__main__":
    try:
        typer.run(main)
    except (ValueError, ArithmeticError) as error:
        sys.exit(f"scaling: {error}")
