"""The common style of all figures: for print, and for all kinds of colour vision."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import matplotlib as mpl
from cycler import cycler
from matplotlib.figure import Figure

from isopeel.common.errors import InputError
from isopeel.results.files import MAKER
from isopeel.splines.names import parse_space_name

#: Colours that are distinct for all kinds of colour vision (Okabe and Ito, 2008), the strongest first.
BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY = "#0072B2", "#D55E00", "#009E73", "#E69F00", "#CC79A7", "#56B4E9"
DASHES = (0, (4, 2))
LONG_DASHES, DOT_DASHES = (0, (8, 2)), (0, (5, 1.5, 1, 1.5))
DOT_DOT_DASHES, DOTS = (0, (5, 1.5, 1, 1.5, 1, 1.5)), (0, (1, 1.2))
GREY, SHADE = "#666666", "#eeeeee"
#: A perceptually uniform colour map whose lightness rises, so that it is readable in a grey print.
FIELD_MAP = "viridis"
#: Widths of a figure in one and in two columns of a journal, in inches.
ONE_COLUMN, TWO_COLUMNS = 3.5, 7.2
FORMATS = (".png", ".pdf", ".svg")

_SETTINGS: dict[Any, Any] = {
    "font.family": "DejaVu Sans",  # comes with matplotlib: the same figure on every machine
    "font.size": 9,
    "axes.titlesize": 9,
    "axes.labelsize": 9,
    "legend.fontsize": 8,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "axes.prop_cycle": cycler(color=[BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY]),
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "xtick.direction": "out",
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "lines.linewidth": 1.3,
    "hatch.linewidth": 0.5,
    "legend.frameon": False,
    "figure.dpi": 200,
    "savefig.dpi": "figure",
    "pdf.fonttype": 42,  # text stays text
    "svg.fonttype": "none",
    "svg.hashsalt": "isopeel",
}


@contextmanager
def style() -> Iterator[None]:
    """Draw in the common style while the context is open, whatever the user's settings are."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_SETTINGS)
        yield


def check_format(suffix: str) -> None:
    """Raise InputError, for --format, unless figures can be written in a format, such as png."""
    if f".{suffix}" not in FORMATS:
        raise InputError("--format", suffix, f"it must be one of {', '.join(name[1:] for name in FORMATS)}")


def save(figure: Figure, path: Path) -> None:
    """Write a figure; raises InputError for a suffix that is not one of FORMATS."""
    if path.suffix.lower() not in FORMATS:
        raise InputError("figure", str(path), f"its name must end in one of {', '.join(FORMATS)}")
    dates = {".pdf": {"CreationDate": None}, ".svg": {"Date": None}}  # the same figure, the same file
    # some settings are read only when a figure is drawn
    with style(), _undated_fonts():
        # `savefig` would draw all of it once more to arrange it; without an engine it draws once
        layout = figure.get_layout_engine()
        if layout is not None:
            layout.execute(figure)
            figure.set_layout_engine(None)
        figure.savefig(path, metadata={"Creator": MAKER, **dates.get(path.suffix.lower(), {})})


@contextmanager
def _undated_fonts() -> Iterator[None]:
    """Embed fonts without a date without a warning: matplotlib takes the prime of a formula from one."""
    logger = logging.getLogger("fontTools.ttLib.tables._h_e_a_d")
    logger.addFilter(_is_not_about_dates)
    try:
        yield
    finally:
        logger.removeFilter(_is_not_about_dates)


def _is_not_about_dates(record: logging.LogRecord) -> bool:
    return "timestamp" not in record.getMessage()


LineStyle = Literal["-"] | tuple[int, tuple[float, ...]]


@dataclass(frozen=True)
class SpaceStyle:
    """The style of one spline space in all figures.

    `hollow` where the contact row alone is enriched, `half_filled` where it alone is elevated.
    """

    color: str
    marker: str
    linestyle: LineStyle
    hollow: bool = False
    half_filled: bool = False

    @property
    def line(self) -> dict[str, Any]:
        """Arguments of `Axes.plot` for a line without markers."""
        return {
            "color": self.color,
            "linestyle": self.linestyle,
            "linewidth": 0.8 if self.hollow or self.half_filled else 1.3,
        }

    @property
    def marked(self) -> dict[str, Any]:
        """Arguments of `Axes.plot` for a line with markers."""
        return self.line | {
            "marker": self.marker,
            "markersize": 5,
            "markeredgewidth": 1,
            "markerfacecolor": "white" if self.hollow else self.color,
            "fillstyle": "bottom" if self.half_filled else "full",
        }


# A family has a range of colours (cold, warm, green), whose members differ in lightness; no two spaces share
# a marker, nor a line style and about the same grey. The last two are the Hermite spaces of degree 5 and 7.
_STYLES = {
    "L1": SpaceStyle("#000000", "o", "-"),
    "L2": SpaceStyle(BLUE, "s", DASHES),
    "L4": SpaceStyle(SKY, "D", DOTS),
    "N2": SpaceStyle("#7A2A00", "^", "-"),
    "N4": SpaceStyle(VERMILION, "v", LONG_DASHES),
    "N6": SpaceStyle(ORANGE, "<", DOT_DASHES),
    "N8": SpaceStyle(PURPLE, ">", DOT_DOT_DASHES),
    "N2.1": SpaceStyle(GREEN, "P", "-"),
    "N4.1": SpaceStyle("#004D38", "X", DASHES),
    "N3.2": SpaceStyle("#9A9A2E", "p", "-"),
    "N4.3": SpaceStyle("#5A5A1A", "*", DASHES),
}
_LEFT_COLORS, _LEFT_MARKERS = (GREY, "#8C6BB1", "#A6611A", "#4A5A8A"), ("8", "h", "d", "H")


def space_style(name: str) -> SpaceStyle:
    """Return the style of a space, the same in all figures; raises InputError for other names.

    Each published space has its own style. L1+X, with only the contact row enriched, has that of X with
    hollow markers and a thinner line; Np+Np.q has that of Np.q with half of its marker filled. Other spaces
    share the remaining colours and markers.
    """
    parsed = parse_space_name(name)
    bulk, contact, rows = parsed.bulk, parsed.contact, parsed.contact_rows
    if str(bulk) == "L1" and rows == 1:
        return replace(space_style(str(contact)), hollow=True)
    if rows == 1 and bulk.continuity == contact.continuity and str(contact) in _STYLES:
        return replace(_STYLES[str(contact)], half_filled=True)
    if str(parsed) in _STYLES:
        return _STYLES[str(parsed)]
    # with these weights the spaces of the literature, of degrees 1, 2 and 4 with 1 to 3 contact rows, differ
    which = 3 * bulk.degree + contact.degree + 2 * contact.continuity + rows
    marker = _LEFT_MARKERS[(rows + contact.continuity) % len(_LEFT_MARKERS)]
    return SpaceStyle(_LEFT_COLORS[which % len(_LEFT_COLORS)], marker, DOTS)


_LINES: tuple[LineStyle, ...] = ("-", DASHES, DOT_DASHES, DOTS, LONG_DASHES, DOT_DOT_DASHES)
_COLORS = (BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY, "#000000")


def line_style(number: int) -> dict[str, Any]:
    """Return the style of one of several lines, by its number from zero: distinct in colour, dashed for grey.

    The first 42 are distinct.
    """
    return {"color": _COLORS[number % len(_COLORS)], "linestyle": _LINES[number % len(_LINES)]}
