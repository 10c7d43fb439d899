"""Compute a study: its runs, and from their outcomes its tables, figures and report."""

from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

from isopeel.common.processes import cores
from isopeel.report.document import write_document
from isopeel.report.folder import RUNS, TABLES, replaced, take_folder
from isopeel.report.wording import listed
from isopeel.results.provenance import Provenance
from isopeel.running.folder import make_folder
from isopeel.study.execution import Executor, InProcesses, Store, compute
from isopeel.study.outcome import Outcome, Task
from isopeel.study.report import make_document
from isopeel.study.study import Study
from isopeel.study.table import StudyResults, write_tables
from isopeel.study.time_left import TimeLeft


def run_study(
    study: Study,
    out: Path,
    console: Console,
    executor: Executor | None = None,
    *,
    force: bool = False,
    command: str = "isopeel study",
) -> StudyResults:
    """Compute the runs of a study that its folder does not have yet, and write its tables and report.

    The runs are computed by an executor, by default in a process for each core. Raises InputError if the
    folder cannot be written, or if it contains files that are not of a report, unless with `force`. Raises
    OSError if a file cannot be written.
    """
    folder = take_folder(out, "", lambda _: False, force=force)
    make_folder(out / RUNS)
    results = compute_study(study, Store(out / RUNS), console, executor, replaced(folder))
    make_folder(folder / TABLES)
    files = write_tables(results, folder / TABLES)
    write_document(make_document(results, Provenance.of_this_process(), command), folder)
    for name in results.missing_outputs:
        known = ", ".join(results.reading_names) or "none"
        console.print(f"note: no run has the reading {name!r}; there are {known}", soft_wrap=True)
    console.print(f"the tables are {listed(list(map(str, files)))}", soft_wrap=True)
    return results


def compute_study(
    study: Study, store: Store | None, console: Console, executor: Executor | None, message: str = ""
) -> StudyResults:
    """Compute the runs of a study that the store does not have, or all of them, and return the results.

    `message` is printed below the number of runs. Raises InputError and OSError as `execution.compute`.
    """
    tasks = [Task(study.case.text, point) for point in study.points]
    known = 0 if store is None else sum(store.read(task) is not None for task in tasks)
    console.print(f"{len(tasks)} runs, {known} of them are finished already")
    if message:
        console.print(message, soft_wrap=True)
    with _progress(console) as bar:
        line = bar.add_task(study.name, total=len(tasks), completed=known, known=known)

        def finished(number: int, outcome: Outcome) -> None:
            bar.update(line, advance=1)
            if outcome.ending != "completed":
                bar.console.print(f"run {number + 1}: {outcome.ending}: {outcome.cause}", soft_wrap=True)

        outcomes = compute(tasks, store, executor or InProcesses(cores()), finished)
    return StudyResults(study, tuple(outcomes))


def _progress(console: Console) -> Progress:
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(bar_width=None),
        MofNCompleteColumn(),
        TextColumn("runs, left"),
        TimeLeft(),
        console=console,
        transient=True,
        disable=not console.is_terminal,
    )
