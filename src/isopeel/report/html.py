"""Convert the Markdown of a report to one HTML page that needs no other file."""

import re
from base64 import b64encode
from collections.abc import Iterable, Iterator
from html import escape
from importlib import resources
from pathlib import Path
from struct import unpack

from markdown_it import MarkdownIt
from markdown_it.token import Token

from isopeel.common.errors import InputError

#: Kinds of consecutive blocks that belong together, and the element for them. A table may have notes.
_GROUPS = (
    (("contents", "bullet_list"), '<nav aria-label="Contents">\n{}{}</nav>\n'),
    (
        ("table caption", "table", "blockquote"),
        '<figure>\n<figcaption>{}</figcaption>\n<div class="wide">\n{}</div>\n{}</figure>\n',
    ),
    (
        ("table caption", "table"),
        '<figure>\n<figcaption>{}</figcaption>\n<div class="wide">\n{}</div>\n</figure>\n',
    ),
    (
        ("picture", "picture caption"),
        '<figure>\n<div class="wide">\n{}</div>\n<figcaption>{}</figcaption>\n</figure>\n',
    ),
)

_PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="generator" content="isopeel">
<title>{title}</title>
<style>
{style}</style>
</head>
<body>
<main>
{body}</main>
</body>
</html>
"""


def anchor(heading: str) -> str:
    """Return the name by which GitHub links to a heading: small letters, - for blanks."""
    return re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-")


def to_html(markdown: str, folder: Path) -> str:
    """Return the HTML page of a report that begins with its title; images in the folder become part of it.

    Raises InputError for an image that is not a PNG, OSError for one that cannot be read.
    """
    parser = MarkdownIt("commonmark", {"html": False, "xhtmlOut": False}).enable("table")
    tokens = parser.parse(markdown)
    for index, token in enumerate(tokens):
        if token.type == "heading_open":
            token.attrSet("id", anchor(_shown(tokens[index + 1])))
        elif token.type == "th_open":
            token.attrSet("scope", "col")
        for child in token.children or ():
            if child.type == "image":
                child.attrs |= _embedded(folder, str(child.attrs["src"]))
    blocks = list(_blocks(tokens))
    kinds = tuple(map(_kind, blocks))
    rendered = [parser.renderer.render(block, parser.options, {}) for block in blocks]
    style = resources.files("isopeel").joinpath("report", "report.css").read_text("utf-8")
    return _PAGE.format(title=escape(_shown(tokens[1])), style=style, body="".join(_grouped(kinds, rendered)))


def _blocks(tokens: Iterable[Token]) -> Iterator[list[Token]]:
    """Yield the outermost blocks of a document."""
    block: list[Token] = []
    for token in tokens:
        block.append(token)
        if token.level == 0 and token.nesting != 1:
            yield block
            block = []


def _kind(block: list[Token]) -> str:
    """Return the kind of a block, recognized by how the report writes it."""
    kind = block[0].type.removesuffix("_open")
    content = block[1].content if len(block) > 1 else ""
    if kind == "heading" and content == "Contents":
        return "contents"
    if kind == "paragraph":
        children = [child.type for child in block[1].children or ()]
        if children == ["image"]:
            return "picture"
        for word, name in (("Table", "table caption"), ("Figure", "picture caption")):
            if content.startswith(f"**{word} "):
                return name
    return kind


def _grouped(kinds: tuple[str, ...], rendered: list[str]) -> Iterator[str]:
    position = 0
    while position < len(rendered):
        for group, frame in _GROUPS:
            end = position + len(group)
            if kinds[position:end] == group:
                yield frame.format(*rendered[position:end])
                position = end
                break
        else:
            yield rendered[position]
            position += 1


def _shown(inline: Token) -> str:
    """Return the text of a heading without its marks."""
    return "".join(child.content for child in inline.children or ())


def _embedded(folder: Path, source: str) -> dict[str, str | int | float]:
    """Return the attributes of an image that is part of the page."""
    data = (folder / source).read_bytes()
    if not data.startswith(b"\x89PNG\r\n\x1a\n"):
        raise InputError("image", source, "the images of a report are PNG files")
    width, height = unpack(">II", data[16:24])
    # figures have 200 pixels per inch, about as many as a fine screen: twice as many as CSS pixels
    return {
        "src": f"data:image/png;base64,{b64encode(data).decode()}",
        "width": width // 2,
        "height": height // 2,
    }
