"""Legends above all panels, where they cover no curve."""

from collections.abc import Iterable, Sequence
from math import ceil

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.textpath import TextPath

from isopeel.post.style import GREY, SpaceStyle, space_style
from isopeel.splines.names import parse_space_name

_MOST_COLUMNS = 9
#: Size of the letters in points; in units of it, the width of a mark with its space, and the space of
#: columns.
_SIZE, _HANDLE, _SPACING = 8, 2.8, 1.2


def space_handles(spaces: Iterable[str]) -> list[Line2D]:
    """Return the entries of spaces. L1+X has the entry of X, and one more entry for all hollow marks."""
    names = list(spaces)
    styles = {name: space_style(name) for name in names}
    covered_by_others = [
        name for name in names if styles[name].hollow and str(parse_space_name(name).contact) in names
    ]
    handles = [
        Line2D([], [], **look.marked, label=name)
        for name, look in styles.items()
        if name not in covered_by_others
    ]
    if covered_by_others:
        hollow = SpaceStyle(GREY, "o", "-", hollow=True)
        handles.append(Line2D([], [], **hollow.marked, label="L1+X"))
    return handles


def add_legend(figure: Figure, handles: Sequence[Line2D]) -> None:
    """Add a legend above all panels, to be read row by row, with as many columns as fit the figure."""
    room = 72 * figure.get_figwidth() - _SIZE
    most = next((n for n in range(min(_MOST_COLUMNS, len(handles)), 1, -1) if _width(handles, n) < room), 1)
    # no more columns than this number of rows needs
    columns = ceil(len(handles) / ceil(len(handles) / most))
    # matplotlib fills column by column
    by_column = [handle for column in range(columns) for handle in handles[column::columns]]
    figure.legend(handles=by_column, loc="outside upper left", ncols=columns, columnspacing=_SPACING)


def _width(handles: Sequence[Line2D], columns: int) -> float:
    """Return the width of a legend in points."""
    widths = [
        max(TextPath((0, 0), str(handle.get_label()), size=_SIZE).get_extents().width for handle in column)
        for column in (handles[k::columns] for k in range(columns))
    ]
    return sum(widths) + columns * _SIZE * (_HANDLE + _SPACING)
