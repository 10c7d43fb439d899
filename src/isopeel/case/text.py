"""The text of a case: TOML of bounded size and depth, which may come from anywhere."""

import re
import tomllib
from typing import Any

from isopeel.common.errors import InputError

#: Bytes of the text that a run holds: what a file of the largest size becomes where each character of a text
#: has to be escaped, and its path is a long one.
LARGEST_TEXT = 50_000
#: Parts of a key with points in it. Cases have three; a key of 25,000 took ten seconds to read, and of 60,000
#: a minute, because the time grows with their square.
MOST_PARTS = 20

#: What hides points from being parts of keys, whichever begins first: texts of four kinds, and comments. One
#: that does not end goes on to the end of the text, so that the time grows with the length alone.
_HIDING = re.compile(
    r"""
    \"{3} (?> (?: [^\\"] | \\. | "(?!"") )* ) (?:\"{3})?
    | '{3} (?> (?: [^'] | '(?!'') )* ) (?:'{3})?
    | " (?> (?: [^"\\\n] | \\. )* ) "?
    | ' (?> [^'\n]* ) '?
    | \# [^\n]*
    """,
    re.DOTALL | re.VERBOSE,
)
_PARTS = re.compile(rf"(?<![\w-])(?:(?>[\w-]+)[ \t]*\.[ \t]*){{{MOST_PARTS}}}")


def document_of(text: str, source: str, field: str = "CASE", what: str = "case") -> dict[str, Any]:
    """Read TOML of bounded size and depth, of a case or another file; InputError for its field otherwise."""
    # some editors begin a text in UTF-8 by its mark
    text = text.removeprefix("\ufeff")
    size = size_of(text)
    if size is None:
        raise InputError(field, source, "it contains half of a surrogate pair, which is no character")
    if size > LARGEST_TEXT:
        raise InputError(field, source, f"a {what} has at most {LARGEST_TEXT} bytes")
    # texts may be keys, too
    if _PARTS.search(_HIDING.sub("x", text)):
        raise InputError(field, source, f"a key of a {what} has at most {MOST_PARTS} parts")
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(field, source, f"it is not TOML: {error}") from error


def size_of(text: str) -> int | None:
    """Bytes of a text in UTF-8; None where it holds half of a surrogate pair, which has no encoding."""
    try:
        return len(text.encode())
    except UnicodeEncodeError:
        return None
