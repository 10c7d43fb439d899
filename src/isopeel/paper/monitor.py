"""The progress of the study: a line for each current run, with the time left, and for each finished run."""

from collections.abc import Sequence
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeRemainingColumn

from isopeel.paper.execution import Report
from isopeel.paper.study import Run
from isopeel.results.run_file import StoredRun

_SPEED_SECONDS = 120.0  # the time left is estimated from the last seconds: paths are slower on the plateau


class Monitor:
    """Shows the progress of runs on a console; if the console is no terminal, finished runs only."""

    def __init__(self, console: Console, runs: Sequence[Run]) -> None:
        self._console = console
        self._left = {run: run.cost for run in runs}
        self._lines: dict[Run, TaskID] = {}
        self._progress = Progress(
            TextColumn("{task.description:26s}"),
            BarColumn(bar_width=None),
            TextColumn("{task.percentage:3.0f} %, left"),
            TimeRemainingColumn(),
            console=console,
            speed_estimate_period=_SPEED_SECONDS,
            transient=True,
            disable=not console.is_terminal,
        )
        self._all = self._progress.add_task(f"all {len(runs)} runs", total=sum(self._left.values()))
        self._total = sum(self._left.values())
        self._count, self._done = len(runs), 0

    def __enter__(self) -> Self:
        """Begin to show."""
        self._progress.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Clear the shown lines."""
        self._progress.stop()

    def report(self, report: Report) -> None:
        """Show the progress of a run."""
        if report.run not in self._lines:
            self._lines[report.run] = self._progress.add_task(report.run.name, total=report.of)
        self._progress.update(self._lines[report.run], completed=report.steps)
        self._show_left(report.run, report.run.cost * (1 - report.steps / report.of))

    def finished(self, run: Run, stored: StoredRun) -> None:
        """Write a line about a finished run, and count it."""
        seconds, reached = stored.curve.seconds.sum(), stored.curve.parameter[-1:].sum()  # 0 without a step
        ending = "" if stored.failure is None else f"  ended early: {stored.failure.reason}"
        self._write(run, f"to {reached:5.1f} degrees in {seconds:5.1f} s{ending}")

    def skipped(self, run: Run) -> None:
        """Write a line about a variant that cannot be computed, and count it."""
        self._write(run, "not computed: the run that it starts from ended before")

    def _write(self, run: Run, text: str) -> None:
        line = self._lines.pop(run, None)
        if line is not None:
            self._progress.remove_task(line)
        self._done += 1
        self._show_left(run, 0.0)
        self._console.print(f"{self._done:3d}/{self._count}  {run.name:26s} {text}", soft_wrap=True)

    def _show_left(self, run: Run, cost: float) -> None:
        self._left[run] = cost
        self._progress.update(self._all, completed=self._total - sum(self._left.values()))
