"""What goes into a report comes out of it: in Markdown, on the page, in the files and on the console."""

import csv
import re
from base64 import b64decode
from collections.abc import Callable
from html.parser import HTMLParser
from io import StringIO
from pathlib import Path
from struct import unpack
from urllib.parse import unquote

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from markdown_it import MarkdownIt
from matplotlib.figure import Figure
from rich.console import Console

from isopeel import InputError
from isopeel.post.style import style
from isopeel.report.document import (
    Document,
    Picture,
    Section,
    Table,
    Text,
    print_table,
    to_markdown,
    write_document,
)
from isopeel.report.html import anchor, to_html

# All that Markdown, HTML and rich take for marks, and what they might change
SPECIAL = (
    "a|b",
    "<b>&amp;</b>",
    "5 < 6 & 7 > 6",
    "*x* **y** _z_ n_y __w__",
    "$f$ \\alpha \\| \\\\",
    "[a](b) ![c](d) [e]",
    "`c` `` ` ``",
    "~s~ ~~t~~",
    "# 1",
    "C#",
    "- x",
    "1. x",
    '"quoted" -- (c) ...',
    "[bold]rich[/bold] :smile:",
    "https://example.org www.example.org a@example.org",
    "µ ± é 中 −1",
    "",
)
WIDTH, HEIGHT = 3.0, 2.0  # inches
DOTS = 200  # per inch, by the common style


def draw() -> Figure:
    with style():
        figure = Figure(figsize=(WIDTH, HEIGHT), layout="constrained")
        figure.subplots().plot([0, 1], [0, 1])
        return figure


def table(name: str = "special", notes: tuple[str, ...] = ()) -> Table:
    return Table(
        name, "What |is| <special>", ("text", "its *length*"), tuple((s, str(len(s))) for s in SPECIAL), notes
    )


def document(draw: Callable[[], Figure] = draw) -> Document:
    return Document(
        "Peeling & <NURBS>",
        Text("All of it is in {special}, *not* in {curve}."),
        (
            Section(
                "What comes out?",
                (table(notes=("- one", "2. two", "a_b")), Text("- see {second}")),
                "isopeel paper",
            ),
            Section("Äpfel & C#: 2", (Picture("curve", "The [curve] of *M*", draw), table("second"))),
        ),
    )


class Page(HTMLParser):
    """A page's elements, links, images and the texts of some elements; fails where tags do not match."""

    VOID = frozenset({"meta", "img", "br", "hr"})
    KEPT = frozenset({"title", "h1", "h2", "th", "td", "figcaption", "blockquote", "pre"})

    def __init__(self, html: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.texts: dict[str, list[str]] = {tag: [] for tag in self.KEPT}
        self.feed(html)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        if tag in self.KEPT:
            self.texts[tag].append("")
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        for tag in set(self.open) & self.KEPT:
            self.texts[tag][-1] += data

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.elements if name == tag]


def markdown_cells(markdown: str) -> list[str]:
    """The cells of all tables as the parser of the commonmark project's rules reads them."""
    tokens = MarkdownIt("commonmark").enable("table").parse(markdown)
    return [
        "".join(child.content for child in tokens[index + 1].children or ())
        for index, token in enumerate(tokens)
        if token.type in ("th_open", "td_open")
    ]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("report") / "new"
    write_document(document(), folder)
    return folder


@pytest.fixture(scope="module")
def page(folder: Path) -> Page:
    return Page((folder / "report.html").read_text("utf-8"))


CELLS = ["text", "its *length*", *(cell for row in table().rows for cell in row)]


def test_cells_come_out_of_markdown_as_they_went_in(folder: Path) -> None:
    assert markdown_cells((folder / "report.md").read_text("utf-8")) == CELLS * 2


def test_texts_come_out_of_the_page_as_they_went_in(page: Page) -> None:
    assert page.texts["th"] == CELLS[:2] * 2
    assert page.texts["td"] == CELLS[2:] * 2
    assert page.texts["title"] == page.texts["h1"] == ["Peeling & <NURBS>"]
    assert page.texts["h2"] == ["Contents", "What comes out?", "Äpfel & C#: 2"]
    assert [text.strip() for text in page.texts["figcaption"]] == [
        "Table 1. What |is| <special>",
        "Figure 1. The [curve] of *M*",
        "Table 2. What |is| <special>",
    ]
    assert page.texts["blockquote"] == ["\n- one\n2. two\na_b\n"]
    assert page.texts["pre"] == ["isopeel paper\n"]


one_line = st.text(st.characters(exclude_categories=["C", "Z"], include_characters=" ")).map(str.strip)


@settings(max_examples=200, deadline=None)
@given(one_line, one_line)
def test_any_text_comes_out_as_it_went_in(first: str, second: str) -> None:
    shown = Table("any", first or "any", (first, second), ((second, first),), (first or "any",))
    markdown = to_markdown(Document("Any", Text(""), (Section("One", (shown,)),)))
    assert markdown_cells(markdown) == [first, second, second, first]
    page = Page(to_html(markdown, Path()))
    assert page.texts["th"] + page.texts["td"] == [first, second, second, first]
    assert page.texts["figcaption"] == [f"Table 1. {first or 'any'}\n"]
    assert page.texts["blockquote"] == [f"\n{first or 'any'}\n"]


def test_references_become_numbers(folder: Path) -> None:
    markdown = (folder / "report.md").read_text("utf-8")
    assert "All of it is in Table 1, *not* in Figure 1." in markdown
    assert "- see Table 2" in markdown


def test_columns_are_aligned(folder: Path, page: Page) -> None:
    lines = [line for line in (folder / "report.md").read_text("utf-8").splitlines() if line.startswith("| ")]
    assert len(lines) == 2 * (len(SPECIAL) + 2)
    assert len(set(map(len, lines))) == 1
    assert {cell["style"] for cell in page.all("td")[::2]} == {"text-align:left"}
    assert {cell["style"] for cell in page.all("td")[1::2]} == {"text-align:right"}


def test_links_of_the_contents_are_there(folder: Path, page: Page) -> None:
    links = [unquote(str(link["href"])) for link in page.all("a")]
    assert links == ["#what-comes-out", "#äpfel--c-2"]
    assert {f"#{heading['id']}" for heading in page.all("h2")} == {"#contents", *links}
    for link in links:
        assert f"](#{link[1:]})" in (folder / "report.md").read_text("utf-8")


# as GitHub makes them, by its own pages
@pytest.mark.parametrize(
    ("heading", "name"),
    [("Where things live", "where-things-live"), ("What's new?", "whats-new"), ("A & b_c: 2.1", "a--b_c-21")],
)
def test_anchors(heading: str, name: str) -> None:
    assert anchor(heading) == name


def test_images_are_in_the_page(folder: Path, page: Page) -> None:
    (image,) = page.all("img")
    kind, data = str(image["src"]).split(",")
    assert kind == "data:image/png;base64"
    assert b64decode(data) == (folder / "figures" / "curve.png").read_bytes()
    assert unpack(">II", b64decode(data)[16:24]) == (WIDTH * DOTS, HEIGHT * DOTS)
    assert (image["width"], image["height"]) == ("300", "200")
    assert image["alt"] == "The [curve] of *M*"


def test_the_page_needs_nothing_else(folder: Path, page: Page) -> None:
    assert page.all("html")[0]["lang"] == "en"
    assert not {"script", "link", "iframe"} & {tag for tag, _ in page.elements}
    (sheet,) = re.findall(r"<style>(.*?)</style>", (folder / "report.html").read_text("utf-8"), re.DOTALL)
    assert "url(" not in sheet
    assert "@import" not in sheet


def test_html_in_a_text_is_escaped() -> None:
    text = "<script>alert(1)</script> [x](javascript:alert) <br>"
    page = Page(to_html(to_markdown(Document("A", Text(text), ())), Path()))
    assert not page.all("script")
    assert not page.all("a")
    assert not page.all("br")


def test_tables_have_files(folder: Path) -> None:
    with (folder / "tables" / "special.csv").open(encoding="utf-8", newline="") as file:
        rows = [tuple(row) for row in csv.reader(file)]
    assert rows == [table().headings, *table().rows]
    assert {str(path.relative_to(folder)) for path in folder.rglob("*.*")} == {
        "figures/curve.pdf",
        "figures/curve.png",
        "report.html",
        "report.md",
        "tables/second.csv",
        "tables/special.csv",
    }


def test_writing_again_gives_the_same_bytes(folder: Path, tmp_path: Path) -> None:
    write_document(document(), tmp_path)
    for name in ("report.md", "report.html", "tables/special.csv", "figures/curve.png", "figures/curve.pdf"):
        assert (tmp_path / name).read_bytes() == (folder / name).read_bytes()
    text = (tmp_path / "report.md").read_bytes()
    assert text == text.strip() + b"\n"


def test_an_interruption_leaves_the_earlier_report(tmp_path: Path) -> None:
    def interrupted() -> Figure:
        raise KeyboardInterrupt

    write_document(document(), tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*.*")}
    with pytest.raises(KeyboardInterrupt):
        write_document(document(interrupted), tmp_path)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*.*")} == before


def test_a_file_that_cannot_be_written_is_reported(tmp_path: Path) -> None:
    (tmp_path / "figures").write_text("not a folder")
    with pytest.raises(FileExistsError):
        write_document(document(), tmp_path)
    (tmp_path / "x.png").write_text("no image")
    with pytest.raises(InputError, match="PNG"):
        to_html("# A\n\n![a](x.png)\n", tmp_path)


def test_fonts_without_a_date_are_embedded_in_silence(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    def primed() -> Figure:
        figure = draw()
        figure.suptitle("$E'I$")
        return figure

    write_document(document(primed), tmp_path)
    # whose date is 0, and of which matplotlib has the prime
    assert b"Cmsy10" in (tmp_path / "figures" / "curve.pdf").read_bytes()
    assert caplog.messages == []


def test_nothing_is_drawn_for_text() -> None:
    def drawn() -> Figure:
        raise AssertionError

    assert "](figures/curve.png)" in to_markdown(document(drawn))


def test_the_console_shows_texts_as_they_are() -> None:
    console = Console(width=200, file=StringIO(), record=True)
    print_table(table(notes=("[red]a note[/red]",)), console)
    printed = console.export_text()
    for text in (*SPECIAL, "What |is| <special>", "its *length*", "[red]a note[/red]"):
        assert text in printed


def test_no_digit_is_cut_off_on_a_narrow_console() -> None:
    console = Console(width=12, file=StringIO(), record=True)
    print_table(Table("t", "t", ("a", "b"), (("x", "1.23456789012345"),)), console)
    assert re.sub(r"[^0-9.]", "", console.export_text()) == "1.23456789012345"


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Table("a", "A", ("x", "y"), (("1",),)), "a row has 2 cells"),
        (lambda: Table("a/b", "A", ("x",), ()), "small letters"),
        (lambda: Table("a", "A", (), ()), "a table needs columns"),
        (lambda: Table("a", "A", ("x",), (("1\n2",),)), "one line"),
        (lambda: Picture("a", " A", draw), "one line"),
        (lambda: Picture("", "A", draw), "small letters"),
        (lambda: Document("A", Text(""), (Section("B", (table(), table())),)), "used twice"),
        (lambda: Document("A", Text(""), (Section("B", ()), Section("B!", ()))), "used twice"),
        (lambda: Document("A", Text("{speciall}"), (Section("B", (table(),)),)), "special"),
    ],
)
def test_what_does_not_fit_is_refused(make: Callable[[], object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()
