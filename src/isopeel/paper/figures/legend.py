"""Legends above all panels, where they hide nothing."""

from collections.abc import Iterable, Sequence
from math import ceil

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from isopeel.post.style import GREY, SpaceStyle, space_style
from isopeel.splines.names import parse_space_name

_MOST_COLUMNS, _MOST_LETTERS = 9, 50  # in a row


def space_handles(spaces: Iterable[str]) -> list[Line2D]:
    """Entries of spaces. That of X tells L1+X too, with one more entry for all such hollow ones."""
    names = list(spaces)
    styles = {name: space_style(name) for name in names}
    told_by_others = [
        name for name in names if styles[name].hollow and str(parse_space_name(name).contact) in names
    ]
    handles = [
        Line2D([], [], **look.marked, label=name)
        for name, look in styles.items()
        if name not in told_by_others
    ]
    if told_by_others:
        hollow = SpaceStyle(GREY, "o", "-", hollow=True)
        handles.append(Line2D([], [], **hollow.marked, label="L1+X"))
    return handles


def add_legend(figure: Figure, handles: Sequence[Line2D]) -> None:
    """Put a legend above all panels, to be read row by row."""
    longest = max(len(str(handle.get_label())) for handle in handles)
    most = min(_MOST_COLUMNS, max(1, _MOST_LETTERS // longest))
    columns = ceil(len(handles) / ceil(len(handles) / most))
    # matplotlib fills column by column
    by_column = [handle for column in range(columns) for handle in handles[column::columns]]
    figure.legend(handles=by_column, loc="outside upper left", ncols=columns, columnspacing=1.2)
