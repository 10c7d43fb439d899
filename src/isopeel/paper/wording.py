"""How numbers and runs are written in the report."""

from collections.abc import Iterable, Sequence

from isopeel.paper.published import Figures
from isopeel.paper.record import Record

ABSENT = "-"
#: The unit of all moments of the report.
UNIT = "E0 L0^3 = 2 nN nm for a width of L0 = 1 nm"


def digits(value: float | None, count: int = 4) -> str:
    """A number with so many digits."""
    return ABSENT if value is None else f"{value:#.{count}g}"


def triple(figures: Sequence[float] | None) -> str:
    """Amplitude, rise and fall in one cell."""
    return ABSENT if figures is None else " / ".join(f"{value:#.4g}" for value in figures)


def deviation(ours: float | None, theirs: float | None) -> str:
    """By how many percent ours is above theirs."""
    return ABSENT if ours is None or theirs is None else f"{100 * (ours / theirs - 1):+.0f} %"


def deviations(ours: Figures | None, theirs: Figures | None) -> str:
    """The same of amplitude, rise and fall in one cell."""
    if ours is None or theirs is None:
        return ABSENT
    return " / ".join(f"{100 * (a / b - 1):+.0f}" for a, b in zip(ours, theirs, strict=True)) + " %"


def endings(records: Iterable[Record]) -> tuple[str, ...]:
    """A note for each run that ended early, where and why."""
    return tuple(f"{record.run.name}: {record.ended}." for record in records if record.ended is not None)


def number(count: float | None, digits_after: int = 3) -> str:
    """A number with so many digits after its point."""
    return ABSENT if count is None else f"{count:.{digits_after}f}"


def listed(words: Sequence[str]) -> str:
    """Words with commas, and with "and" before the last."""
    return " and ".join(filter(None, [", ".join(words[:-1]), *words[-1:]]))
