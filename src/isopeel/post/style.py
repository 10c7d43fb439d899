"""One look for all figures: made for print, and for readers who see colours differently."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl
from cycler import cycler
from matplotlib.figure import Figure

from isopeel.errors import InputError

#: Colours that stay apart for all kinds of colour vision (Okabe and Ito, 2008), the strongest first.
BLUE, VERMILION, GREEN, ORANGE, PURPLE, SKY = "#0072B2", "#D55E00", "#009E73", "#E69F00", "#CC79A7", "#56B4E9"
DASHES = (0, (4, 2))
GREY, SHADE = "#666666", "#eeeeee"
#: Perceptually uniform, and lighter from end to end, so that it survives a grey print.
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
}


@contextmanager
def style() -> Iterator[None]:
    """Draw in the common style, whatever the user's settings are, and leave those untouched."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_SETTINGS)
        yield


def save(figure: Figure, path: Path) -> None:
    """Write a figure; InputError for a suffix that is not one of FORMATS."""
    if path.suffix.lower() not in FORMATS:
        raise InputError("figure", str(path), f"its name must end in one of {', '.join(FORMATS)}")
    with style():  # some settings are read only when a figure is drawn
        figure.savefig(path)
