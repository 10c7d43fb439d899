"""The cost of a small amplitude, in unknowns and in time."""

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from isopeel.common.errors import InputError
from isopeel.paper.figures.amplitudes import AMPLITUDE, in_table_order
from isopeel.paper.figures.legend import add_legend, space_handles
from isopeel.post.style import TWO_COLUMNS, space_style, style


@dataclass(frozen=True)
class Cost:
    """Degrees of freedom of a run, computing time of one of its steps, and its dM in E0 L0^3."""

    space: str
    mesh: str
    dofs: int
    seconds: float
    amplitude: float


def cost_figure(entries: Sequence[Cost]) -> Figure:
    """Draw dM over degrees of freedom and over seconds; the meshes of a space are joined.

    Raises InputError if there are no entries.
    """
    if not entries:
        raise InputError("entries", [], "give one at least")
    spaces = in_table_order(entry.space for entry in entries)
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 4.4), layout="constrained")
        by_dofs, by_seconds = figure.subplots(1, 2, sharey=True)
        for space in spaces:
            runs = sorted((entry for entry in entries if entry.space == space), key=lambda run: run.dofs)
            amplitudes, look = [run.amplitude for run in runs], space_style(space).marked
            by_dofs.plot([run.dofs for run in runs], amplitudes, **look)
            by_seconds.plot([run.seconds for run in runs], amplitudes, **look)
        by_dofs.set(xscale="log", yscale="log", xlabel="degrees of freedom", ylabel=AMPLITUDE)
        by_seconds.set(xscale="log", xlabel="computing time of a step / second")
        for axes in (by_dofs, by_seconds):
            axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
            axes.xaxis.set_minor_formatter(NullFormatter())
        add_legend(figure, space_handles(spaces))
        return figure
