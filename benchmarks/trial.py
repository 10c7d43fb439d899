"""Random cases with a known answer: counts of right results, and of wrong ones with and without a note."""

import csv
import sys
import time
from collections.abc import Callable, Sequence
from math import isclose, isfinite
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress

import machine
from isopeel.case import shipped_cases
from isopeel.common.processes import cores
from printing import wide_console
from trials.case import Trial
from trials.drawing import refined
from trials.drawing import trial as drawn_trial
from trials.running import Attempt, Outcome, Shipped
from trials.tables import Found, counts, gains, listed
from trials.verdict import RIGHT, Verdict, deviation, verdict, warned_by_default
from trials.workers import Lost, run_all

LIMIT = 30.0  # seconds of the processor
_COLUMNS = (
    *("seed", "number", "family", "kind", "verdict", "ending", "value", "right", "deviation", "element"),
    *("theory", "steps", "seconds", "gain", "notes", "cause"),
)


def outcomes(
    trials: Sequence[Trial], processes: int, limit: float, finished: Callable[[Trial, Outcome], None]
) -> Found:
    """Run trials, and report when each is finished; trials that take longer than the limit are ended."""
    # in this process: trials that are ended do not remove their files
    with TemporaryDirectory(prefix="isopeel-trial-") as folder:
        tasks = [Attempt(trial, Path(folder)) for trial in trials]
        done = run_all(
            tasks, processes, limit, lambda number, one: finished(trials[number], _outcome(one, limit))
        )
    return [(trial, _outcome(one, limit)) for trial, one in zip(trials, done, strict=True)]


def _outcome(done: object, limit: float) -> Outcome:
    if isinstance(done, Outcome):
        return done
    if isinstance(done, Lost) and done.out_of_time:
        return Outcome("too slow", cause=f"not finished after {limit:g} s", seconds=limit)
    return Outcome("crashed", cause="the process was lost", seconds=0.0)


def _row(trial: Trial, outcome: Outcome) -> list[object]:
    """Return one line of the table of all cases."""
    drawn, gain = trial.drawn, outcome.gain and outcome.gain.share
    return [
        *(trial.seed, trial.number, trial.family, drawn.kind, verdict(trial, outcome).value),
        *(outcome.ending, outcome.value, drawn.answer.value, deviation(trial, outcome)),
        *(drawn.element, outcome.theory, outcome.steps, outcome.seconds, gain),
        *(" | ".join(outcome.notes), outcome.cause),
    ]


def report(found: Found, console: Console, *, everything: bool) -> None:
    """Print the tables."""
    console.print(counts(found))
    for line in listed(found, everything=everything):
        console.print(line, soft_wrap=True)
    table = gains(found)
    if table.row_count:
        console.print(table)
    warned, default = warned_by_default(found)
    of_space, both = warned_by_default(found, any_space=False)
    close = sum(verdict(*one) is Verdict.WARNED_CLOSE for one in found)
    total = len(found)
    console.print(
        f"on the default mesh {warned} of {default} cases have a note or fail ({_percent(warned, default)})"
    )
    console.print(f"in the default space and on its mesh {of_space} of {both} ({_percent(of_space, both)})")
    console.print(f"right within 1 % but warned: {close} of {total} ({_percent(close, total)})")
    shown = [pair for pair in found if isfinite(pair[1].theory)]
    wrong = [pair for pair in shown if not isclose(pair[1].theory, pair[0].drawn.answer.value, rel_tol=RIGHT)]
    numbers = ", ".join(str(trial.number) for trial, _ in wrong)
    console.print(
        f"closed forms shown: {len(shown)}, off by more than 3 %: {len(wrong)} {numbers and f'({numbers})'}"
    )
    console.print(f"steps that gain energy without work: in {table.row_count} of {total} cases")


def _percent(part: int, whole: int) -> str:
    return f"{100 * part / max(whole, 1):.1f} %"


def run_shipped(processes: int, console: Console) -> None:
    """Run the shipped cases, and print the energy that each gained without work."""
    names = shipped_cases()
    with TemporaryDirectory(prefix="isopeel-trial-") as folder:
        done = run_all([Shipped(name, Path(folder)) for name in names], processes, 600.0, lambda *_: None)
    for name, one in zip(names, done, strict=True):
        outcome = _outcome(one, 600.0)
        gain = "-" if outcome.gain is None else f"{outcome.gain.share:.1e} at {outcome.gain.parameter:.5g}"
        console.print(
            f"{name}: {outcome.ending}, {outcome.steps} steps, largest gain of energy {gain} of W A"
        )


def main(
    seed: Annotated[list[int] | None, typer.Option(help="Of the draw, 1 when left out; repeatable.")] = None,
    count: Annotated[int, typer.Option(min=1, help="Cases of each seed.")] = 500,
    only: Annotated[
        list[int] | None, typer.Option(help="Numbers of cases, printed as TOML; repeatable.")
    ] = None,
    family: Annotated[list[str] | None, typer.Option(help="Families; all when left out; repeatable.")] = None,
    processes: Annotated[int | None, typer.Option(min=1, help="All cores when left out.")] = None,
    limit: Annotated[float, typer.Option(min=1, help="Seconds of the processor for a case.")] = LIMIT,
    out: Annotated[Path, typer.Option(help="Table of every case.")] = Path("out/trial.csv"),
    everything: Annotated[bool, typer.Option("--all", help="List every case.")] = False,
    fine: Annotated[
        bool, typer.Option("--fine", help="On fine meshes, which shows the closed forms.")
    ] = False,
    shipped: Annotated[
        bool, typer.Option("--shipped", help="Check the energy of the shipped cases too.")
    ] = False,
) -> None:
    """Draw random cases with a known answer, run them as a user would, and count the right results."""
    seeds, console, began = seed or [1], wide_console(), time.perf_counter()
    trials = [drawn_trial(one, number) for one in seeds for number in only or range(count)]
    trials = [trial for trial in trials if not family or trial.family in family]
    if fine:
        trials = [refined(trial) for trial in trials]
    if only:
        for trial in trials:
            print(trial.text)
            for name, text in trial.drawn.files.items():
                print(f"# {name}\n# {text}\n")
    out.parent.mkdir(parents=True, exist_ok=True)
    bar = Progress(console=Console(stderr=True), transient=True)
    with bar, out.open("w", newline="", encoding="utf-8") as file:
        writer, task = csv.writer(file), bar.add_task("cases", total=len(trials))
        writer.writerow(_COLUMNS)

        def finished(trial: Trial, outcome: Outcome) -> None:
            writer.writerow(_row(trial, outcome))
            file.flush()
            bar.advance(task)

        found = outcomes(trials, processes or cores(), limit, finished)
    for one in seeds:
        console.print(f"seed {one}")
        report([pair for pair in found if pair[0].seed == one], console, everything=everything or bool(only))
    if shipped:
        run_shipped(processes or cores(), console)
    console.print(
        f"seeds {', '.join(map(str, seeds))}: {len(trials)} cases in {time.perf_counter() - began:.0f} s"
    )
    console.print(f"every case in {out}", soft_wrap=True)
    console.print(machine.description(), soft_wrap=True)


if __name__ == "__main__":
    try:
        typer.run(main)
    except (ValueError, OSError) as error:
        sys.exit(f"trial: {error}")
