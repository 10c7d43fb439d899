"""The progress of a run, and of other work, on a terminal."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from isopeel.problem import Column, Drive
from isopeel.solve.step import Step

_REFRESHES_PER_SECOND = 5


@contextmanager
def progress(
    console: Console,
    drive: Drive,
    steps: int,
    before: int = 0,
    shown: Callable[[Column, float], str] | None = None,
) -> Iterator[Callable[[Step], None]]:
    """Show a bar while the context is open, and yield the function that moves it to a step.

    The bar begins after the steps `before`, and shows that kernels are compiled until the first step. Nothing
    is shown where the console is not a terminal. `shown` writes a value of a column.
    """
    bar = _bar(console)
    write = shown or Column.text
    parameter, reaction = drive.parameter_column, drive.reaction_column

    met: set[float] = set()

    def show(step: Step) -> None:
        # a curve that turns back meets a parameter again
        if step.kind == "requested":
            met.add(step.parameter)
        found = write(reaction, reaction.factor * step.reaction)
        bar.update(
            task,
            completed=before + len(met),
            description=f"{write(parameter, parameter.shown(step.parameter))}  "
            f"{reaction.name} {found}  {len(step.iterations)} iterations",
        )

    with bar:
        task = bar.add_task("compiling", total=steps, completed=before)
        yield show


@contextmanager
def counted(console: Console, what: str, total: int) -> Iterator[Callable[[], None]]:
    """Show a bar while the context is open, and yield the function that moves it by one.

    Nothing is shown where the console is not a terminal.
    """
    with _bar(console) as bar:
        task = bar.add_task(what, total=total)
        yield lambda: bar.advance(task)


def _bar(console: Console) -> Progress:
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(bar_width=None),
        TextColumn("{task.completed}/{task.total}"),
        TimeRemainingColumn(compact=True),
        console=console,
        refresh_per_second=_REFRESHES_PER_SECOND,
        transient=True,
        disable=not console.is_terminal,
    )
