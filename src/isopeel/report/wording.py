"""How numbers and lists are written in a report."""

from collections.abc import Sequence

ABSENT = "-"


def digits(value: float | None, count: int = 4) -> str:
    """Return a number with so many digits."""
    return ABSENT if value is None else f"{value:#.{count}g}"


def number(count: float | None, digits_after: int = 3) -> str:
    """Return a number with so many digits after its point."""
    return ABSENT if count is None else f"{count:.{digits_after}f}"


def deviation(ours: float | None, theirs: float | None) -> str:
    """Return by how many percent ours is above theirs."""
    return ABSENT if ours is None or theirs is None else f"{100 * (ours / theirs - 1):+.0f} %"


def listed(words: Sequence[str]) -> str:
    """Return the words separated by commas, with "and" before the last."""
    return " and ".join(filter(None, [", ".join(words[:-1]), *words[-1:]]))
