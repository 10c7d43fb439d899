"""Time of a load step of the peeled strip, in isopeel and in other libraries."""

import os
import platform
import sys
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.progress import Progress

import isopeel
from comparison import Comparison, Entry
from isopeel.case import parse_mesh
from isopeel.common.arrays import FloatArray
from peers.laws import ADHERING_LENGTH, LENGTH
from peers.names import ISOPEEL, PEERS, PROGRAMS
from programs import GoneError, Program
from table import table

DEGREES = {"L1": 1, "L2": 2, "L4": 4}
UNTIMED_STEP = 0.5  # degrees, and twice that before the strip begins to peel, at about
ONSET = 50.0


def start(space: str, mesh: str, peers: str) -> Comparison:
    """Start isopeel and the peers, each at the start of its path, with notes on unavailable ones."""
    elements = parse_mesh("--mesh", mesh)
    if space not in DEGREES:
        raise isopeel.InputError("--space", space, f"the peers have {', '.join(DEGREES)}")
    if elements[0] * ADHERING_LENGTH % LENGTH:
        raise isopeel.InputError("--mesh", mesh, "3/4 of the elements along x must adhere")
    names = list(dict.fromkeys(peers.split(",")))
    if unknown := set(names) - set(PEERS):
        raise isopeel.InputError("--peers", unknown.pop(), f"the peers are {', '.join(PEERS)}")
    comparison = Comparison([Entry(Program(ISOPEEL, DEGREES[space], elements))])
    for name in names:
        try:
            comparison.entries.append(Entry(Program(name, DEGREES[space], elements)))
        except GoneError as error:
            comparison.notes.append(f"{PROGRAMS[name].label} is left out: {error}")
    return comparison


def untimed_angles(start: float, step: float) -> FloatArray:
    """Return angles of large steps up to `start`; the last two have the timed size, for the predictor."""
    last = start - step * np.array([2, 1, 0])
    before = np.arange(0, min(ONSET, last[0]), 2 * UNTIMED_STEP)
    return np.concatenate([before, np.arange(ONSET, last[0], UNTIMED_STEP), last[last >= 0]])


def machine(comparison: Comparison) -> str:
    """Return the processor, its cores and load, and the versions in use."""
    information = Path("/proc/cpuinfo")
    lines = information.read_text().splitlines() if information.exists() else []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    model = models[0] if models else platform.processor()
    libraries: dict[str, str] = {}
    for entry in comparison.entries:
        libraries |= entry.program.versions
    versions = ", ".join(f"{name} {version}" for name, version in libraries.items())
    load = ", ".join(f"{number:.2f}" for number in os.getloadavg())
    return f"{model}, {os.cpu_count()} cores, load {load}; Python {platform.python_version()}, {versions}"


def run(comparison: Comparison, untimed: FloatArray, timed: FloatArray, block: int) -> None:
    """Trace all programs by blocks of load steps, to the last angle or until one stops."""
    parts = [(part, False) for part in _blocks(untimed, block)] + [
        (part, True) for part in _blocks(timed, block)
    ]
    # refreshed between blocks only: a drawing thread would take time from the programs
    with Progress(console=Console(stderr=True), auto_refresh=False, transient=True) as bar:
        for part, is_timed in bar.track(parts):
            if not comparison.ended:
                comparison.trace(np.deg2rad(part).tolist(), timed=is_timed)


def _blocks(angles: FloatArray, size: int) -> list[FloatArray]:
    return [angles[first : first + size] for first in range(0, angles.size, size)]


def main(
    space: Annotated[str, typer.Option(help="L1, L2 or L4.")] = "L2",
    mesh: Annotated[str, typer.Option(help="Elements along length x height.")] = "200x10",
    begin: Annotated[float, typer.Option("--from", help="Degrees at the end of the untimed steps.")] = 0.0,
    to: Annotated[float, typer.Option(help="Last angle in degrees.")] = 120.0,
    step: Annotated[float, typer.Option(help="Degrees per load step.")] = 0.1,
    peers: Annotated[str, typer.Option(help="What to compare with.")] = ",".join(PEERS),
    block: Annotated[int, typer.Option(min=1, help="Load steps of one program before the next's turn.")] = 5,
) -> None:
    """Time isopeel and its peers in turn on one thread; programs that disagree are excluded."""
    if not (begin >= 0 and 0 < step < 2 * (to - begin)):
        value, allowed = (
            f"{begin:g}, {to:g}, {step:g}",
            "0 <= from, and to at least a step beyond, are needed",
        )
        raise isopeel.InputError("--from, --to, --step", value, allowed)
    comparison = start(space, mesh, peers)
    count = round((to - begin) / step)
    timed = np.linspace(begin, begin + step * count, count + 1)[1:]
    run(comparison, untimed_angles(begin, step), timed, block)
    console = Console(highlight=False)
    for note in comparison.notes:
        console.print(note, soft_wrap=True)
    count = len(comparison.entries[0].steps)
    if not count:
        raise ArithmeticError("no step was timed")
    reached, last = begin + step * count, comparison.entries[0].steps[-1].moment
    console.print(f"strip, {space}, {mesh}: {count} load steps of {step:g} degrees, {begin:g} to {reached:g}")
    agreement = f"{comparison.largest_difference:.1e} at all {comparison.compared} steps, untimed ones too"
    console.print(f"moments agree to {agreement}; the last is {last:.8f} E0 L0^3", soft_wrap=True)
    console.print(table(comparison.entries))
    console.print(machine(comparison), soft_wrap=True)
    for entry in comparison.entries:
        entry.program.close()


if __name__ == "__main__":
    try:
        typer.run(main)
    except (ValueError, ArithmeticError, GoneError) as error:
        sys.exit(f"load_step: {error}")
