"""What each method for speed gains: the published study with all methods, and without each of them."""

import json
import os
import subprocess
import sys
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, NamedTuple

import typer
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

import machine
from ablations.methods import METHODS, Method
from isopeel import InputError
from isopeel.paper.study import MESHES, SPACES, Run, table_runs
from printing import plain_table, wide_console

#: The runs that `load_step.py` compares with other libraries.
_LOAD_STEPS = ("L1-m2", "L2-m2", "L4-m2")
_HERE = Path(__file__).parent


class Cost(NamedTuple):
    """The cost of one run in one process."""

    seconds: float  # of the processor
    steps: int
    corrections: int
    moment: float  # at the last step


class Worker:
    """A process without one method, or with all of them."""

    def __init__(self, method: Method | None, cache: Path) -> None:
        environment = os.environ | {"OMP_NUM_THREADS": "1", "PYTHONPATH": os.pathsep.join(sys.path)}
        if method is not None and method.compiles:
            environment["NUMBA_CACHE_DIR"] = str(cache / method.name.replace(" ", "-"))
        self.method = method
        self.costs: dict[str, list[Cost]] = {}
        name = "" if method is None else method.name
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "ablations.worker", name],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=environment,
            text=True,
        )

    def send(self, run: Run, to: float) -> None:
        """Send a run, and its last angle in degrees, to the process."""
        assert self._process.stdin is not None
        print(json.dumps([run.space, run.mesh, to]), file=self._process.stdin, flush=True)

    def receive(self) -> Cost:
        """Return the cost of the requested run; raises ArithmeticError if the process ended."""
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            name = "all methods" if self.method is None else f"without {self.method.name}"
            raise ArithmeticError(f"the process {name} ended")
        return Cost(*json.loads(line))

    def least(self, runs: list[Run]) -> float:
        """Return the sum over runs of the least seconds of each."""
        return sum(min(cost.seconds for cost in self.costs[run.name]) for run in runs)

    def corrections(self, runs: list[Run]) -> float:
        """Return the corrections per step over runs."""
        costs = [self.costs[run.name][0] for run in runs]
        return sum(cost.corrections for cost in costs) / max(sum(cost.steps for cost in costs), 1)

    def close(self) -> None:
        """End the process."""
        with self._process:
            self._process.kill()


def ablation_table(base: Worker, workers: list[Worker], runs: list[Run]) -> Table:
    """Tabulate the additional time without each method."""
    steps = [run for run in runs if run.name in _LOAD_STEPS]
    table = plain_table(
        "additional time without a method",
        *("method", "instead", "lines", "study", *(run.space for run in steps), "corrections", "moment"),
        caption="study, spaces: more processor time than with all methods; corrections: per step;\n"
        "moment: largest relative difference at the last step, of runs with as many steps",
    )
    for worker in workers:
        assert worker.method is not None
        differences = [
            abs(worker.costs[run.name][0].moment / base.costs[run.name][0].moment - 1)
            for run in runs
            if worker.costs[run.name][0].steps == base.costs[run.name][0].steps
        ]
        table.add_row(
            worker.method.name,
            worker.method.instead,
            str(worker.method.lines),
            f"{worker.least(runs) / base.least(runs) - 1:+.1%}",
            *(f"{worker.least([run]) / base.least([run]) - 1:+.0%}" for run in steps),
            f"{worker.corrections(runs):.2f}",
            f"{max(differences):.0e}" if differences else "",
        )
    return table


def main(
    space: Annotated[list[str] | None, typer.Option(help="All nine when left out; repeatable.")] = None,
    mesh: Annotated[list[str] | None, typer.Option(help="m1, m2, m3; all when left out; repeatable.")] = None,
    method: Annotated[list[str] | None, typer.Option(help="All when left out; repeatable.")] = None,
    to: Annotated[float, typer.Option(min=1, help="Last angle in degrees.")] = 150.0,
    passes: Annotated[int, typer.Option(min=1, help="Times that each run is computed.")] = 1,
) -> None:
    """Compute the published study with all methods that save time, and without each of them, in turn.

    The table is printed after each mesh, over all runs so far.
    """
    for option, chosen, known in (
        ("--space", space, SPACES),
        ("--mesh", mesh, tuple(MESHES)),
        ("--method", method, tuple(one.name for one in METHODS)),
    ):
        if unknown := set(chosen or ()) - set(known):
            raise InputError(option, unknown.pop(), f"there is {', '.join(known)}")
    meshes = mesh or list(MESHES)
    runs_of = {name: [run for run in table_runs([name]) if run.space in (space or SPACES)] for name in meshes}
    first = runs_of[meshes[0]][0]
    with TemporaryDirectory(prefix="isopeel-ablation-") as folder:
        base = Worker(None, Path(folder))
        workers = [Worker(one, Path(folder)) for one in METHODS if one.name in (method or (one.name,))]
        everyone = [base, *workers]
        try:
            # a whole path compiles all functions, which most processes load from the first one
            base.send(first, to)
            base.receive()
            for worker in workers:
                worker.send(first, to)
            for worker in workers:
                worker.receive()
            for number, name in enumerate(meshes, 1):
                with Progress(console=Console(stderr=True), auto_refresh=False, transient=True) as bar:
                    for _, run in bar.track(list(product(range(passes), runs_of[name])), description=name):
                        for worker in everyone:
                            worker.send(run, to)
                            worker.costs.setdefault(run.name, []).append(worker.receive())
                # what is known so far: the whole study takes an hour
                _show(base, workers, [run for mesh in meshes[:number] for run in runs_of[mesh]], to)
        finally:
            for worker in everyone:
                worker.close()


def _show(base: Worker, workers: list[Worker], runs: list[Run], to: float) -> None:
    console = wide_console()
    console.print(ablation_table(base, workers, runs))
    console.print(
        f"{len(runs)} runs to {to:g} degrees with all methods: {base.least(runs):.1f} s of processor time, "
        f"{base.corrections(runs):.2f} corrections per step"
    )
    console.print(machine.description(), soft_wrap=True)


if __name__ == "__main__":
    try:
        typer.run(main)
    except (ValueError, ArithmeticError) as error:
        sys.exit(f"ablation: {error}")
