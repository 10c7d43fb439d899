"""The progress of a run, and of other work, on a terminal."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

from isopeel.problem import Drive
from isopeel.solve.step import Step

_REFRESHES_PER_SECOND = 5


@contextmanager
def progress(console: Console, drive: Drive, steps: int, before: int = 0) -> Iterator[Callable[[Step], None]]:
    """Show a bar while the context is open, and give the function that moves it to a step.

    The bar begins after the steps `before`, and says that kernels are compiled until the first one
    arrives. Nothing is shown where the console is no terminal.
    """
    bar = _bar(console)
    parameter, reaction = drive.parameter_column, drive.reaction_column

    met: set[float] = set()

    def show(step: Step) -> None:
        # a curve that turns back meets a parameter again
        if step.kind == "requested":
            met.add(step.parameter)
        bar.update(
            task,
            completed=before + len(met),
            description=f"{parameter.shown(step.parameter):7.2f} {parameter.unit}  "
            f"{reaction.name} {reaction.factor * step.reaction:.6g}  {len(step.iterations)} iterations",
        )

    with bar:
        task = bar.add_task("compiling", total=steps, completed=before)
        yield show


@contextmanager
def counted(console: Console, what: str, total: int) -> Iterator[Callable[[], None]]:
    """Show a bar while the context is open, and give the function that moves it by one.

    Nothing is shown where the console is no terminal.
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
