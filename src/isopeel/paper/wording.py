"""Texts of the study's figures and runs in its report."""

from collections.abc import Iterable, Sequence

from isopeel.paper.published import Figures
from isopeel.paper.record import Record
from isopeel.report.wording import ABSENT

#: The unit of all moments of the report.
UNIT = "E0 L0^3 = 2 nN nm for a width of L0 = 1 nm"


def triple(figures: Sequence[float] | None) -> str:
    """Amplitude, rise and fall in one cell."""
    return ABSENT if figures is None else " / ".join(f"{value:#.4g}" for value in figures)


def deviations(ours: Figures | None, theirs: Figures | None) -> str:
    """Return the deviations of our amplitude, rise and fall from theirs in percent, in one cell."""
    if ours is None or theirs is None:
        return ABSENT
    return " / ".join(f"{100 * (a / b - 1):+.0f}" for a, b in zip(ours, theirs, strict=True)) + " %"


def endings(records: Iterable[Record]) -> tuple[str, ...]:
    """Return a note on each run that ended early: its angle and its reason."""
    return tuple(f"{record.run.name}: {record.ended}." for record in records if record.ended is not None)
