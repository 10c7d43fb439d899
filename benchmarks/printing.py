"""Tables as all benchmarks print them."""

import sys

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table


def plain_table(title: str, *columns: str, caption: str = "", labels: int = 2) -> Table:
    """Empty table whose first columns are `labels`, and all others numbers."""
    table = Table(*columns, title=title, caption=caption, box=SIMPLE_HEAD, pad_edge=False)
    for column in table.columns[labels:]:
        column.justify = "right"
    return table


def wide_console() -> Console:
    """Of standard output; a file that it goes to does not say how wide it is."""
    return Console(highlight=False, width=None if sys.stdout.isatty() else 130)
