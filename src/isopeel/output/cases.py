"""The table of the shipped cases."""

from rich.box import SIMPLE_HEAD
from rich.table import Table

from isopeel.case import load_case, shipped_cases


def cases_table() -> Table:
    """Return a table of the shipped cases, with the first sentence of each."""
    table = Table("case", "what it is", box=SIMPLE_HEAD)
    for name in shipped_cases():
        table.add_row(name, load_case(name).about)
    return table
