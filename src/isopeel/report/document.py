"""The blocks of a report, and how they are written: Markdown, one HTML page, CSV, and the console."""

import csv
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import count
from pathlib import Path
from typing import TypeAlias

from matplotlib.figure import Figure
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table as ConsoleTable
from rich.text import Text as PlainText

from isopeel.common.errors import InputError
from isopeel.post.style import save
from isopeel.report.html import anchor, to_html
from isopeel.results.files import replacing

_CONTENTS = "Contents"
#: The name of a table or picture in a text, which is replaced by its number.
_REFERENCE = re.compile(r"\{([a-z0-9_-]+)\}")
#: Characters that are marks in Markdown; < and & only before letters, and _ only at the end of a word.
_MARKS = re.compile(r"[\\`*|\[\]~$#>]|<(?=[a-z/!?])|&(?=[a-z#])|(?<![^\W_])_|_(?![^\W_])", re.IGNORECASE)


@dataclass(frozen=True)
class Text:
    """A paragraph or a list in Markdown, without headings.

    {NAME} in it becomes the number of the table or picture of that name in the document, as in "Table 2".
    """

    markdown: str


@dataclass(frozen=True)
class Table:
    """A table of plain texts; `name` is that of its file.

    The first column is aligned left, the others right. Raises InputError if a row does not have one cell
    for each heading, if the name has other characters than small letters, digits, - and _, or for a text of
    several lines.
    """

    name: str
    title: str
    headings: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        _check_name("table", self.name)
        if not self.headings:
            raise InputError(f"table {self.name}", self.headings, "a table needs columns")
        for row in self.rows:
            if len(row) != len(self.headings):
                raise InputError(f"table {self.name}", row, f"a row has {len(self.headings)} cells")
        for text in (self.title, *self.headings, *(cell for row in self.rows for cell in row), *self.notes):
            _check_line(f"table {self.name}", text)


@dataclass(frozen=True)
class Picture:
    """A figure, drawn when it is written; `caption` is plain text, `name` that of its files.

    Raises InputError as a table does.
    """

    name: str
    caption: str
    draw: Callable[[], Figure]

    def __post_init__(self) -> None:
        _check_name("picture", self.name)
        _check_line(f"picture {self.name}", self.caption)


Block: TypeAlias = Text | Table | Picture


@dataclass(frozen=True)
class Section:
    """A part of a document; `command` is the command line that computes its numbers, empty if it has none."""

    title: str
    blocks: tuple[Block, ...]
    command: str = ""

    def __post_init__(self) -> None:
        _check_line("section", self.title)


@dataclass(frozen=True)
class Document:
    """A report.

    Raises InputError where two sections, tables or pictures have the same name, or a text refers to a table
    or picture that does not exist.
    """

    title: str
    abstract: Text
    sections: tuple[Section, ...]

    def __post_init__(self) -> None:
        _check_line("document", self.title)
        headings = (self.title, _CONTENTS, *(section.title for section in self.sections))
        _check_unique("section", map(anchor, headings))
        _check_unique("name", (block.name for block in self.blocks if not isinstance(block, Text)))
        for text in (self.abstract, *(block for block in self.blocks if isinstance(block, Text))):
            for name in _REFERENCE.findall(text.markdown):
                if name not in self.numbers:
                    raise InputError("text", f"{{{name}}}", f"it names one of {', '.join(self.numbers)}")

    @property
    def blocks(self) -> Iterator[Block]:
        """All blocks of all sections."""
        return (block for section in self.sections for block in section.blocks)

    @cached_property
    def numbers(self) -> dict[str, str]:
        """The numbers of tables and pictures, such as Table 1, by their names."""
        tables, pictures = count(1), count(1)
        return {
            block.name: f"Table {next(tables)}" if isinstance(block, Table) else f"Figure {next(pictures)}"
            for block in self.blocks
            if not isinstance(block, Text)
        }


def to_markdown(document: Document) -> str:
    """Return a document as Markdown with pipe tables; its figures are figures/NAME.png beside it."""
    contents = [f"- [{_escaped(section.title)}](#{anchor(section.title)})" for section in document.sections]
    abstract = _block_markdown(document.abstract, document)
    parts = [f"# {_escaped(document.title)}", abstract, f"## {_CONTENTS}", "\n".join(contents)]
    for section in document.sections:
        parts.append(f"## {_escaped(section.title)}")
        parts += (_block_markdown(block, document) for block in section.blocks)
        if section.command:
            parts.append(f"This section is made by\n\n```sh\n{section.command}\n```")
    return "\n\n".join(parts) + "\n"


def write_document(document: Document, folder: Path) -> None:
    """Write report.md and report.html, with figures/NAME.png and .pdf, and tables/NAME.csv.

    Each file has its old content or its new content; the report is written last. Raises OSError where a file
    cannot be written.
    """
    figures, tables = folder / "figures", folder / "tables"
    for directory in (figures, tables):
        directory.mkdir(parents=True, exist_ok=True)
    for block in document.blocks:
        match block:
            case Picture(name):
                figure = block.draw()
                for suffix in (".png", ".pdf"):
                    with replacing(figures / f"{name}{suffix}") as path:
                        save(figure, path)
            case Table(name):
                with (
                    replacing(tables / f"{name}.csv") as path,
                    path.open("w", encoding="utf-8", newline="") as file,
                ):
                    csv.writer(file, lineterminator="\n").writerows((block.headings, *block.rows))
    markdown = to_markdown(document)
    for name, text in (("report.md", markdown), ("report.html", to_html(markdown, folder))):
        with replacing(folder / name) as path:
            path.write_text(text, "utf-8", newline="\n")


def print_table(table: Table, console: Console) -> None:
    """Print a table with its notes."""
    shown = ConsoleTable(title=PlainText(table.title), box=SIMPLE_HEAD)
    for number, heading in enumerate(table.headings):
        # a narrow console must not cut off digits of a number
        shown.add_column(PlainText(heading), justify="right" if number else "left", overflow="fold")
    for row in table.rows:
        shown.add_row(*map(PlainText, row))
    console.print(shown)
    for note in table.notes:
        console.print(PlainText(note))


def _block_markdown(block: Block, document: Document) -> str:
    match block:
        case Text(markdown):
            return _REFERENCE.sub(lambda found: document.numbers[found[1]], markdown.strip())
        case Picture(name, caption):
            caption = _escaped(caption)
            return f"![{caption}](figures/{name}.png)\n\n**{document.numbers[name]}.** {caption}"
        case Table(name, title):
            parts = [f"**{document.numbers[name]}.** {_escaped(title)}", _pipe_table(block)]
            if block.notes:
                parts.append("\n>\n".join(f"> {_escaped_line(note)}" for note in block.notes))
            return "\n\n".join(parts)


def _pipe_table(table: Table) -> str:
    """Return a table in Markdown with aligned columns, so that the source is readable."""
    rows = [[_escaped(cell) for cell in row] for row in (table.headings, *table.rows)]
    widths = [max(2, *map(len, column)) for column in zip(*rows, strict=True)]
    rule = [
        ("-" * (width - 1) + ":") if number else ":" + "-" * (width - 1)
        for number, width in enumerate(widths)
    ]
    lines = [
        [
            cell.rjust(width) if number else cell.ljust(width)
            for number, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        for row in rows
    ]
    return "\n".join(f"| {' | '.join(line)} |" for line in (lines[0], rule, *lines[1:]))


def _escaped(text: str) -> str:
    """Return plain text as Markdown that shows it unchanged."""
    return _MARKS.sub(r"\\\g<0>", text)


def _escaped_line(text: str) -> str:
    """Return the same for text that begins a line, where a number or a dash could begin a list."""
    return re.sub(r"^(\d*)([-+.)])(?=\W|$)", r"\1\\\2", _escaped(text))


def _check_name(field: str, name: str) -> None:
    if not re.fullmatch("[a-z0-9_-]+", name):
        raise InputError(field, name, "it must consist of small letters, digits, - and _")


def _check_line(field: str, text: str) -> None:
    if text != text.strip() or len(text.splitlines()) > 1:
        raise InputError(field, text, "it must be one line, without blanks at its ends")


def _check_unique(field: str, names: Iterable[str]) -> None:
    for name, times in Counter(names).items():
        if times > 1:
            raise InputError(field, name, "this name is used twice")
