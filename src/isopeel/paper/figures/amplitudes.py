"""Functions for the figures of the oscillation's amplitude."""

from collections.abc import Iterable

from isopeel.paper.study import SPACES
from isopeel.post.style import space_style
from isopeel.splines.names import parse_space_name

AMPLITUDE = r"amplitude $\Delta M$ / $E_0 L_0^3$"
_ALL, _CONTACT, _OTHER = "all rows", "contact row only, over L1", "elevated in the contact row"


def in_table_order(spaces: Iterable[str]) -> list[str]:
    """Return each space once: the published ones in the order of their table, then the others as given."""
    found = list(dict.fromkeys(spaces))
    return sorted(found, key=lambda space: SPACES.index(space) if space in SPACES else len(SPACES))


def by_rows(spaces: Iterable[str]) -> dict[str, list[str]]:
    """Return the spaces by kinds, each with a title: by the rows that are enriched."""
    kinds: dict[str, list[str]] = {_ALL: [], _CONTACT: [], _OTHER: []}
    for space in spaces:
        if parse_space_name(space).contact_rows == 0:
            kinds[_ALL].append(space)
        else:
            kinds[_CONTACT if space_style(space).hollow else _OTHER].append(space)
    return {kind: found for kind, found in kinds.items() if found}
