"""The reference of the keys of a case: on the terminal, and as the tables of a page of the site.

`python -P -m isopeel.output.key_reference docs/keys.md` writes the tables of the page anew.
"""

import json
import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from difflib import get_close_matches
from itertools import product
from pathlib import Path
from textwrap import fill
from typing import Any, NamedTuple

from rich.console import Console
from rich.text import Text

from isopeel.case.absent import KEYS
from isopeel.case.reference import FAMILIES, PARTS, KeyEntry, TableEntry, tables
from isopeel.common.errors import InputError

#: What encloses a table on the page: its part and name, as in <!-- keys: one body --> and <!-- end -->.
_BLOCK = re.compile(r"(<!-- (keys|kinds): ([^>]*?) -->\n).*?(<!-- end -->)", re.DOTALL)


class _Found(NamedTuple):
    """A key, the table that has it, and the kind of this table that has it; without a kind, all have it."""

    table: str
    kind: str
    key: KeyEntry

    @property
    def path(self) -> str:
        return f"{self.table}.{self.key.name}".lstrip(".")


def toml(value: Any) -> str:
    """Return a value as a case file has it, in one line."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{name} = {toml(one)}" for name, one in value.items()) + " }"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(toml, value))}]"
    return json.dumps(value, ensure_ascii=False)


def show_help(key: str | None, console: Console) -> None:
    """Print what a key of a case is, a table or a kind of one; without any, all keys by their tables.

    Raises InputError where there is none of this name, with the nearest one.
    """
    found = list(_all())
    if key is None:
        for table in dict.fromkeys(one.table for one in found):
            names = dict.fromkeys(one.key.name for one in found if one.table == table)
            console.print(f"{table or 'the case itself'}: {', '.join(names)}", soft_wrap=True)
        console.print("`isopeel help KEY` shows one key, a table or a kind such as bilinear", soft_wrap=True)
        return
    wanted = re.sub(r"[\[\]]|(?<=\.)\d+\.", "", key)
    chosen = [one for one in found if wanted in (one.path, one.table)]
    chosen = chosen or [one for one in found if wanted in (one.key.name, one.kind)]
    # an [[interface]] has the keys of [adhesion]
    if not chosen:
        known = [name for one in found for name in (one.path, one.key.name, one.table, one.kind) if name]
        nearest = get_close_matches(wanted, known, 1)
        hint = KEYS.get(wanted.rpartition(".")[2]) or (nearest and f"did you mean {nearest[0]!r}?")
        hint = f"{hint}; " if hint else ""
        raise InputError("KEY", key, f"there is no such key; {hint}`isopeel help` lists all keys")
    # an [[interface]] has the keys of [adhesion], and several kinds have the same key
    alike: dict[tuple[str, ...], tuple[str, KeyEntry, dict[str, None]]] = {}
    for one in chosen:
        at = one.key.name, one.key.meaning, _value(one.key), one.key.default
        alike.setdefault(at, (one.path, one.key, {}))[2][one.kind] = None
    for path, entry, names in alike.values():
        of_kinds = f" ({', '.join(names)})" if any(names) else ""
        default = entry.default if entry.is_required else f"default: {entry.default}"
        example = f"; example: {_example(entry)}" if _example(entry) else ""
        console.print(Text.assemble((path, "bold"), of_kinds))
        # the marks of code are for the page
        for line in (entry.meaning, f"{_value(entry)}; {default}{example}"):
            console.print(
                Text(
                    fill(
                        line.replace("`", ""), console.width, initial_indent="    ", subsequent_indent="    "
                    )
                )
            )


def paths() -> list[str]:
    """Return all keys, as TABLE.KEY."""
    return list(dict.fromkeys(one.path for one in _all()))


def _all() -> Iterator[_Found]:
    """Yield all keys, those of kinds after those of tables."""
    for part in PARTS:
        for table in tables(part):
            yield from (_Found(table.name, "", key) for key in table.keys)
    for family in FAMILIES:
        for name, kind in product(family.tables, family.kinds):
            yield from (_Found(name, kind.name, key) for key in kind.keys)


def with_tables(page: str) -> str:
    """Return a page whose blocks of tables are those of the code."""
    return _BLOCK.sub(lambda block: f"{block[1]}{_block(block[2], block[3])}{block[4]}", page)


def _block(what: str, name: str) -> str:
    if what == "kinds":
        (family,) = [one for one in FAMILIES if one.title == name]
        heading = (f"`{family.chooser}`", "key", "meaning", "value", "default", "example")
        rows: list[tuple[str, ...]] = [heading]
        for kind in family.kinds:
            first = f"`{kind.name}`: {kind.meaning}"
            rows += [(first if n == 0 else "", *_cells(key)) for n, key in enumerate(kind.keys)]
            if not kind.keys:
                rows.append((first, "none", "", "", "", ""))
        return _markdown(rows)
    return "\n".join(_table(table) for table in tables(name))


def _table(table: TableEntry) -> str:
    heading = f"key of `{table.header}`" if table.header else "key"
    return _markdown(
        [(heading, "meaning", "value", "default", "example"), *(_cells(key) for key in table.keys)]
    )


def _cells(key: KeyEntry) -> tuple[str, ...]:
    meaning = f"{key.meaning} ([more]({key.see}))" if key.see else key.meaning
    return f"`{key.name}`", meaning, _value(key), key.default, f"`{_example(key)}`" if _example(key) else ""


def _value(key: KeyEntry) -> str:
    return f"{key.value.words}; {key.allowed}" if key.allowed else key.value.words


def _example(key: KeyEntry) -> str:
    return "" if key.example is None else toml(key.example)


def _markdown(rows: Sequence[tuple[str, ...]]) -> str:
    heading, *others = rows
    lines = [heading, ("---",) * len(heading), *others]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def main(paths: Sequence[str]) -> None:
    """Write the tables of pages anew."""
    for path in map(Path, paths):
        path.write_text(with_tables(path.read_text("utf-8")), "utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
