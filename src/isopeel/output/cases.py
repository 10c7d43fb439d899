"""The table of the shipped cases, and copies of them."""

from pathlib import Path
from shlex import quote

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from isopeel.case import load_case, shipped_cases
from isopeel.case.load import shipped_text
from isopeel.common.errors import InputError


def cases_table() -> Table:
    """Return a table of the shipped cases, with the first sentence of each."""
    table = Table("case", "what it is", box=SIMPLE_HEAD)
    for name in shipped_cases():
        table.add_row(name, load_case(name).about)
    return table


def copy_case(name: str, file: Path | None, console: Console) -> None:
    """Write the file of a shipped case to another file that does not exist, or print it if there is none.

    Raises InputError if there is no such case, or if the file exists, and OSError if it cannot be written.
    """
    text = shipped_text(name)
    if file is None:
        console.print(text.rstrip(), soft_wrap=True)
        return
    write_new(file, text, "--copy")
    console.print(f"{file}: a copy of {name}; `isopeel run {quote(str(file))}` runs it", soft_wrap=True)


def write_new(file: Path, text: str, field: str) -> None:
    """Write a text to a file that does not exist; InputError for the field if it does, else OSError."""
    try:
        with file.open("x", encoding="utf-8") as opened:
            opened.write(text)
    except FileExistsError as error:
        raise InputError(field, str(file), "it exists, and is not replaced; give another file") from error
