"""Time of a load step of the peeled strip: isopeel against the same problem in scikit-fem with PARDISO."""

import os

os.environ.update(dict.fromkeys([f"{name}_NUM_THREADS" for name in ("OMP", "MKL", "OPENBLAS", "NUMBA")], "1"))

import platform
import sys
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.progress import Progress
from threadpoolctl import threadpool_limits

import isopeel
from in_turn import Program, advance_in_turn, table
from isopeel.arrays import FloatArray
from isopeel.case import parse_mesh
from scikit_fem_strip import ENERGY_TOLERANCE, PEERS, LoadStep, Strip, trace
from scikit_fem_strip.problem import HEIGHT, LENGTH

LABELS = {"plain": "plain", "forms": "forms", "blas": "hand-tuned"}
PEER_DEGREES = {"L1": 1, "L2": 2, "L4": 4}
UNTIMED_STEP = 0.5  # degrees
PACKAGES = ("isopeel", "numpy", "scipy", "numba", "scikit-fem", "pypardiso", "mkl")


def build(space: str, mesh: tuple[int, int], peers: list[str], angles: FloatArray) -> list[Program]:
    """Build isopeel and the peers, each at the start of its path."""
    if space not in PEER_DEGREES:
        raise isopeel.InputError("--space", space, f"the peers know {', '.join(PEER_DEGREES)}")
    if unknown := set(peers) - set(PEERS):
        raise isopeel.InputError("--peers", unknown.pop(), f"the peers are {', '.join(PEERS)}")
    strip = Strip(PEER_DEGREES[space], mesh)
    programs = [Program(LABELS[name], trace(strip, *PEERS[name](strip), angles)) for name in peers]
    return [Program("isopeel", isopeel_path(space, mesh, angles)), *programs]


def isopeel_path(space: str, mesh: tuple[int, int], angles: FloatArray) -> Iterator[LoadStep]:
    """Trace the strip in isopeel, to the tolerance of the peers."""
    settings = isopeel.NewtonSettings(tolerance=ENERGY_TOLERANCE / (LENGTH * HEIGHT))
    for step in isopeel.trace(isopeel.strip(), isopeel.row_space(space, mesh), angles, settings):
        yield LoadStep(step.parameter, step.reaction, len(step.iterations))


def untimed_angles(start: float, step: float) -> FloatArray:
    """Degrees that lead to `start` by large steps; the last two as timed, for the predictor."""
    last = start - step * np.array([2, 1, 0])
    return np.concatenate([np.arange(0, last[0], UNTIMED_STEP), last[last >= 0]])


def machine() -> str:
    """Return the processor, its cores and load, and the versions in use."""
    information = Path("/proc/cpuinfo")
    lines = information.read_text().splitlines() if information.exists() else []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    model = models[0] if models else platform.processor()
    versions = ", ".join(f"{name} {version(name)}" for name in PACKAGES)
    load = ", ".join(f"{number:.2f}" for number in os.getloadavg())
    return f"{model}, {os.cpu_count()} cores, load {load}; Python {platform.python_version()}, {versions}"


def main(
    space: Annotated[str, typer.Option(help="L1, L2 or L4.")] = "L2",
    mesh: Annotated[str, typer.Option(help="Elements along length x height.")] = "200x10",
    start: Annotated[float, typer.Option("--from", help="Degrees that untimed steps lead to.")] = 0.0,
    to: Annotated[float, typer.Option(help="Last angle in degrees.")] = 120.0,
    step: Annotated[float, typer.Option(help="Degrees per load step.")] = 0.1,
    peers: Annotated[str, typer.Option(help="What to compare with.")] = "plain,forms,blas",
    block: Annotated[int, typer.Option(min=1, help="Load steps of one program before the next's turn.")] = 50,
) -> None:
    """Time isopeel and its peers in turn on one thread; no time is shown unless all moments agree."""
    if not (start >= 0 and 0 < step < 2 * (to - start)):
        value, allowed = (
            f"{start:g}, {to:g}, {step:g}",
            "0 <= from, and to at least a step beyond, are needed",
        )
        raise isopeel.InputError("--from, --to, --step", value, allowed)
    untimed = untimed_angles(start, step)
    count = round((to - start) / step)
    angles = np.deg2rad(np.concatenate([untimed, start + step * np.arange(1, count + 1)]))
    programs = build(space, parse_mesh("--mesh", mesh), peers.split(","), angles)
    # refreshed between blocks only: a thread that draws would take time from the programs
    bar = Progress(console=Console(stderr=True), auto_refresh=False, transient=True)
    with threadpool_limits(1), bar:
        _, largest = advance_in_turn(programs, untimed.size)
        for done in bar.track(range(0, count, block)):
            blocks, difference = advance_in_turn(programs, min(block, count - done))
            largest = max(largest, difference)
            for program, timed in zip(programs, blocks, strict=True):
                program.blocks.append(timed)
    console = Console(highlight=False)
    console.print(f"strip, {space}, {mesh}: {count} load steps of {step:g} degrees, {start:g} to {to:g}")
    console.print(f"moments agree to {largest:.1e} E0 L0^3 at all steps")
    console.print(table(programs))
    console.print(machine(), soft_wrap=True)


if __name__ == "__main__":
    try:
        typer.run(main)
    except (ValueError, ArithmeticError) as error:
        sys.exit(f"load_step: {error}")
