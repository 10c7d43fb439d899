"""The frame of a figure that has one panel."""

from collections.abc import Iterator
from contextlib import contextmanager

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from isopeel.post.style import ONE_COLUMN, style


@contextmanager
def one_panel(x_label: str, y_label: str, height: float = 2.4) -> Iterator[tuple[Figure, Axes]]:
    """Return a figure of one column, and its axes; what has a label gets a legend.

    The height is in inches.
    """
    with style():
        figure = Figure(figsize=(ONE_COLUMN, height), layout="constrained")
        axes = figure.subplots()
        axes.set_xlabel(x_label)
        axes.set_ylabel(y_label)
        yield figure, axes
        if axes.get_legend_handles_labels()[1] and axes.get_legend() is None:
            axes.legend()
