"""Tables and the console of all benchmarks."""

import sys

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table


def plain_table(title: str, *columns: str, caption: str = "", labels: int = 2) -> Table:
    """Return an empty table, whose first `labels` columns are texts and the others numbers."""
    table = Table(*columns, title=title, caption=caption, box=SIMPLE_HEAD, pad_edge=False)
    for column in table.columns[labels:]:
        column.justify = "right"
    return table


def wide_console() -> Console:
    """Return a console on standard output; for a file, which has no width, the width is set."""
    return Console(highlight=False, width=None if sys.stdout.isatty() else 130)
