"""Costs of the runs of the published study: steps, corrections, time and memory of each run, and of all."""

import sys
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

import machine
from isopeel import InputError
from isopeel.common.processes import cores
from isopeel.paper.study import MESHES, SPACES, Run, table_runs
from printing import plain_table, wide_console
from published import Study, follow_all


def chosen_runs(spaces: list[str] | None, meshes: list[str] | None) -> list[Run]:
    """Return the published runs of these spaces and meshes, by default of all."""
    for option, chosen, known in (("--space", spaces, SPACES), ("--mesh", meshes, MESHES)):
        if unknown := set(chosen or ()) - set(known):
            raise InputError(option, unknown.pop(), f"the study has {', '.join(known)}")
    return [run for run in table_runs(meshes or MESHES) if run.space in (spaces or SPACES)]


def study_table(study: Study) -> Table:
    """Return the table of the runs, the costliest first."""
    table = plain_table(
        "runs of the published study",
        *(
            "space",
            "mesh",
            "steps",
            "corrections\nper step",
            "ms\nper step",
            "seconds",
            "peak MB",
            "ended at",
        ),
        caption="seconds: with tables and start; peak: of the process so far;\n"
        "ended at: degrees, where no further equilibrium was found, or wanted",
    )
    for cost, seconds in zip(study.costs, study.seconds, strict=True):
        steps = max(cost.steps, 1)
        table.add_row(
            cost.run.space,
            cost.run.mesh,
            str(cost.steps),
            f"{cost.corrections / steps:.2f}",
            f"{1e3 * cost.seconds / steps:.2f}",
            f"{seconds:.1f}",
            f"{cost.peak:.0f}",
            f"{cost.last_deg:g}",
        )
    return table


def main(
    space: Annotated[list[str] | None, typer.Option(help="All nine when left out; repeatable.")] = None,
    mesh: Annotated[list[str] | None, typer.Option(help="m1, m2, m3; all when left out; repeatable.")] = None,
    to: Annotated[float, typer.Option(min=0, help="Last angle in degrees.")] = 150.0,
    processes: Annotated[int | None, typer.Option(min=1, help="All cores when left out.")] = None,
) -> None:
    """Compute the published runs as `isopeel paper` does, without files or report, and print their costs."""
    runs, workers = chosen_runs(space, mesh), processes or cores()
    bar = Progress(console=Console(stderr=True), transient=True)
    with bar:
        task = bar.add_task("runs", total=len(runs))
        study = follow_all(runs, to, workers, lambda: bar.advance(task))
    console = wide_console()
    console.print(study_table(study))
    total, started = sum(study.seconds), ", ".join(f"{seconds:.1f}" for seconds in study.started)
    console.print(
        f"{len(runs)} runs in {study.wall:.1f} s by {workers} processes; their sum is {total:.1f} s"
    )
    console.print(f"processes began with their first run after {started} s")
    console.print(machine.description(), soft_wrap=True)


if __name__ == "__main__":
    try:
        typer.run(main)
    except (ValueError, ArithmeticError) as error:
        sys.exit(f"study: {error}")
