"""The time of a load step by its parts, and its bounds: operations, bytes, and the machine."""

import sys
from collections.abc import Iterable
from dataclasses import dataclass
from statistics import mean
from typing import Annotated

import typer
from rich.table import Table
from threadpoolctl import threadpool_limits

import isopeel
import machine
import work
from clock import PARTS, Clock
from isopeel.assembly.system import System
from isopeel.case import parse_mesh
from isopeel.common.arrays import FloatArray
from isopeel.matrix.mixed_precision import approximate
from isopeel.paper.study import MESHES, SPACES
from isopeel.solve.lbfgs import LbfgsPairs
from peeling import STEP, TIMED, Strip, left_out, peel
from printing import plain_table, wide_console
from work import Work


@dataclass(frozen=True)
class Profile:
    """Of one space and mesh."""

    strip: Strip
    unknowns: int
    half_bandwidth: int
    alone: dict[str, float]  # least seconds of a call of each part
    work: dict[str, Work]
    clock: Clock
    steps: list[isopeel.Step]

    @property
    def label(self) -> tuple[str, str]:
        return self.strip.space, "{}x{}".format(*self.strip.mesh)

    @property
    def wall(self) -> float:
        """Mean seconds of a step."""
        return mean(step.seconds for step in self.steps)

    @property
    def corrections(self) -> float:
        """Per step, as calls of all parts are."""
        return mean(len(step.iterations) for step in self.steps)

    def calls(self, part: str) -> float:
        return self.clock.calls[part] / len(self.steps)

    def share(self, part: str) -> float:
        """Of the time of all steps."""
        return self.clock.seconds[part] / sum(step.seconds for step in self.steps)


def profile(strip: Strip, reach: float, coarse: float, steps: int) -> Profile:
    """Time and count the parts of some steps from an angle on; then time each part in the last state."""
    path = peel(strip, reach, coarse, steps)
    clock = Clock()
    timed: list[isopeel.Step] = []
    pairs = LbfgsPairs.none(0)
    with clock.running():
        for step in path:
            timed.append(step)
            # only the newest step has its solver state
            solver_state = step.state.solver_state
            if solver_state is not None and len(solver_state.lbfgs_pairs.corrections) >= len(
                pairs.corrections
            ):
                pairs = solver_state.lbfgs_pairs
    system = System(strip.problem, strip.row_space)
    u, load = system.state(timed[-1].unknown_values, timed[-1].parameter)
    residual = system.equilibrium(u, load).residual
    n, b = system.constraints.count, system.half_bandwidth
    below = work.below(system.linearize(u, load=load)[1].entries)
    alone = parts_alone(system, u, load, residual, pairs)
    needed = {
        "forces": work.forces(system),
        "tangent": work.tangent(system),
        "factor": work.factorization(below),
        "solve": work.solution(below),
        "update": work.update(n, len(pairs.corrections)),
    }
    return Profile(strip, n, b, alone, needed, clock, timed)


def parts_alone(
    system: System, u: FloatArray, load: float, residual: FloatArray, pairs: LbfgsPairs
) -> dict[str, float]:
    """Return the least seconds of each part, for coefficients u (size, 2) and a residual (count,)."""
    matrix = system.linearize(u, load=load)[1]
    alone = {
        "forces": machine.least_seconds(lambda: system.equilibrium(u, load)),
        "tangent": machine.least_seconds(lambda: system.linearize(u, load=load)),
        "factor": machine.least_seconds(lambda: approximate(matrix)),
    }
    factor = approximate(matrix).factor
    alone["solve"] = machine.least_seconds(lambda: factor.solve(residual))
    alone["update"] = machine.least_seconds(lambda: pairs.correction(factor, residual)) - alone["solve"]
    return alone


def parts_table(profiles: Iterable[Profile]) -> Table:
    """Return the table of sizes, and of milliseconds of one call of each part."""
    table = plain_table(
        "milliseconds of one call",
        *("space", "mesh", "unknowns", "half-band", "forces", "tangent", "factor", "solve", "update"),
        caption="the least of many calls; tangent: with forces;\nupdate: what the pairs add to a solution",
    )
    for one in profiles:
        alone = [f"{1e3 * seconds:.3f}" for seconds in one.alone.values()]
        table.add_row(*one.label, str(one.unknowns), str(one.half_bandwidth), *alone)
    return table


def steps_table(profiles: Iterable[Profile]) -> Table:
    """Return the table of a load step: its time, its calls, and the share of each part in percent."""
    table = plain_table(
        "a load step: milliseconds, calls, and shares in percent",
        *("space", "mesh", "ms", "corrections", "forces", "tangents"),
        *(f"{part}\n%" for part in (*PARTS, "rest")),
        caption="means of all timed steps; corrections: with their forces, solutions and updates",
    )
    for one in profiles:
        shares = [one.share(part) for part in PARTS]
        counts = [f"{n:.2f}" for n in (one.corrections, one.calls("forces"), one.calls("tangent"))]
        percent = [f"{100 * share:.1f}" for share in (*shares, 1 - sum(shares))]
        table.add_row(*one.label, f"{1e3 * one.wall:.2f}", *counts, *percent)
    return table


def bounds_table(profiles: Iterable[Profile], ceiling: machine.Ceiling) -> Table:
    """Return the table of the work of one call of each part, and the speed that it reaches."""
    table = plain_table(
        "work of one call, and what is reached",
        *("space", "mesh", "part", "MFlop", "MB", "ms", "GFlop/s", "GB/s", "copy\nGB/s"),
        *("flops\nms", "bytes\nms", "reached\n%"),
        caption=f"one core at best: {ceiling.matrix_product:.1f} GFlop/s in dgemm,"
        f" {ceiling.vector_sum:.1f} in y += a x within the first cache, {ceiling.copy:.1f} GB/s\n"
        "in a copy beyond all caches; copy: of as many bytes as the part moves; flops, bytes: what they\n"
        "take at the pace of dgemm and of that copy; reached: the longer of the two by what the part takes",
        labels=3,
    )
    for one in profiles:
        for part, needed in one.work.items():
            seconds, copy = one.alone[part], machine.copy_rate(needed.moved)
            at_least = needed.flops / ceiling.matrix_product / 1e9, needed.moved / copy / 1e9
            table.add_row(
                *one.label,
                part,
                f"{needed.flops / 1e6:.3f}",
                f"{needed.moved / 1e6:.3f}",
                f"{1e3 * seconds:.3f}",
                f"{needed.flops / seconds / 1e9:.2f}",
                f"{needed.moved / seconds / 1e9:.2f}",
                f"{copy:.1f}",
                *(f"{1e3 * least:.3f}" for least in at_least),
                f"{100 * max(at_least) / seconds:.0f}",
            )
        table.add_section()
    return table


def least_table(profiles: Iterable[Profile], ceiling: machine.Ceiling) -> Table:
    """Return the table of a load step with the same calls at the best speed of the machine."""
    table = plain_table(
        "a load step at best, in milliseconds",
        *("space", "mesh", "measured", "dgemm", "y += a x", "measured\n/ dgemm", "measured\n/ y += a x"),
        caption="the same calls of the same parts and nothing else, each at the pace of the copy\n"
        "of its bytes or of the operation that is named, whatever takes longer",
    )
    for one in profiles:
        at_best = []
        for pace in (ceiling.matrix_product, ceiling.vector_sum):
            parts = {
                part: max(needed.flops / pace, needed.moved / machine.copy_rate(needed.moved)) / 1e9
                for part, needed in one.work.items()
            }
            at_best.append(sum(one.calls(part) * seconds for part, seconds in parts.items()))
        table.add_row(
            *one.label,
            f"{1e3 * one.wall:.2f}",
            *(f"{1e3 * seconds:.2f}" for seconds in at_best),
            *(f"{one.wall / seconds:.1f}" for seconds in at_best),
        )
    return table


def main(
    space: Annotated[list[str] | None, typer.Option(help="All of the published study; repeatable.")] = None,
    mesh: Annotated[
        list[str] | None, typer.Option(help="m1, m2, m3, or elements such as 200x10; repeatable.")
    ] = None,
    reach: Annotated[float, typer.Option(help="Degrees at the end of the untimed steps.")] = 90.0,
    coarse: Annotated[float, typer.Option(help="Degrees of an untimed step.")] = 0.5,
    steps: Annotated[int, typer.Option(min=1, help=f"Timed steps, of {STEP} degrees.")] = TIMED,
) -> None:
    """Print the time of a load step of the peeled strip by its parts, on one thread."""
    strips = [
        Strip(name, MESHES.get(elements) or parse_mesh("--mesh", elements))
        for name in space or SPACES
        for elements in mesh or ["m2"]
    ]
    console = wide_console()
    profiles = []
    with threadpool_limits(1):
        for strip in strips:
            try:
                profiles.append(profile(strip, reach, coarse, steps))
            except isopeel.ConvergenceError as error:
                console.print(left_out(strip, error))
    console.print(f"strip: {steps} load steps of {STEP:g} degrees from {reach:g} degrees on")
    ceiling = machine.ceiling()
    for table in (parts_table(profiles), steps_table(profiles), bounds_table(profiles, ceiling)):
        console.print(table)
    console.print(least_table(profiles, ceiling))
    console.print(machine.description(), soft_wrap=True)


if __name__ == "__main__":
    try:
        typer.run(main)
    except (ValueError, ArithmeticError) as error:
        sys.exit(f"profile_step: {error}")
