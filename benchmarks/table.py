"""The table of a comparison."""

from collections.abc import Iterable
from statistics import median

from rich.box import SIMPLE_HEAD
from rich.table import Table

from comparison import Entry
from peers.newton import LoadStep

COLUMNS = ("assembly", "solve", "median", "mean", "Newton", "MB", "ratio", "range")


def table(entries: list[Entry]) -> Table:
    """Return the table of times, iterations and memory of programs, isopeel first."""
    result = Table(
        "",
        *COLUMNS,
        title="milliseconds; Newton iterations per load step",
        caption="assembly and solve: of one iteration; median of blocks, and mean: of a step\n"
        "MB: peak memory; ratio: of means to isopeel's; range: of blocks",
        box=SIMPLE_HEAD,
        pad_edge=False,
        padding=(0, 1, 0, 0),
    )
    result.columns[0].no_wrap = True
    for column in result.columns[1:]:
        column.justify = "right"
    first = _by_block(entries[0])
    for entry in entries:
        steps, by_block = entry.steps, _by_block(entry)
        ratios = [one / other for one, other in zip(by_block, first, strict=True)]
        mean = _mean(steps)
        result.add_row(
            entry.program.label,
            _per_iteration(steps, [step.assembly for step in steps]),
            _per_iteration(steps, [step.solution for step in steps]),
            f"{1e3 * median(by_block):.2f}",
            f"{1e3 * mean:.2f}",
            f"{sum(step.iterations for step in steps) / len(steps):.2f}",
            f"{entry.peak_megabytes:.0f}",
            _ratio(mean / _mean(entries[0].steps)),
            f"{_ratio(min(ratios))}-{_ratio(max(ratios))}",
        )
    return result


def _ratio(ratio: float) -> str:
    return f"{ratio:.2f}" if ratio < 10 else f"{ratio:.1f}"


def _mean(steps: list[LoadStep]) -> float:
    return sum(step.seconds for step in steps) / len(steps)


def _by_block(entry: Entry) -> list[float]:
    """Return the seconds per load step of each block."""
    return [_mean(block) for block in entry.blocks]


def _per_iteration(steps: list[LoadStep], seconds: Iterable[float | None]) -> str:
    known = [one for one in seconds if one is not None]
    if len(known) < len(steps):
        return "-"
    return f"{1e3 * sum(known) / sum(step.iterations for step in steps):.2f}"
