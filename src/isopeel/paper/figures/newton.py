"""Energy residuals of Newton's iterations that converge, and of those that do not."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from isopeel.common.errors import InputError
from isopeel.paper.figures.legend import add_legend
from isopeel.post.style import DASHES, TWO_COLUMNS, space_style, style

_CONVERGING, _DIVERGING = {"linestyle": "-"}, {"linestyle": DASHES, "markerfacecolor": "white"}


@dataclass(frozen=True)
class NewtonHistory:
    """Energy residuals per unknown, |R . du|/n for a unit width, before each correction at one angle."""

    space: str
    angle_deg: float
    energy_residuals: tuple[float, ...]
    converged: bool

    def __post_init__(self) -> None:
        if not self.energy_residuals:
            raise InputError("energy_residuals", (), "give one at least")


def newton_figure(histories: Sequence[NewtonHistory]) -> Figure:
    """Draw each history, in one panel for each space, in the given order.

    Raises InputError if there are none.
    """
    if not histories:
        raise InputError("histories", [], "give one at least")
    spaces = list(dict.fromkeys(history.space for history in histories))
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 3.1), layout="constrained")
        panels = figure.subplots(1, len(spaces), squeeze=False, sharex=True, sharey=True)[0]
        for axes, space in zip(panels, spaces, strict=True):
            angles = []
            for history in (history for history in histories if history.space == space):
                # residuals of zero or infinity cannot be drawn on a logarithmic axis
                residuals = np.array(history.energy_residuals)
                residuals[~np.isfinite(residuals) | (residuals <= 0)] = np.nan
                look = space_style(space).marked | {"markersize": 4}
                look |= _CONVERGING if history.converged else _DIVERGING
                axes.plot(1 + np.arange(residuals.size), residuals, **look)
                angles.append(f"{history.angle_deg:.1f}°" + ("" if history.converged else " not converging"))
            axes.set_title(f"{space}: " + "\n".join(angles), loc="left")
            axes.set_yscale("log")
            axes.set_xlabel("iteration")
            axes.xaxis.set_major_locator(MaxNLocator(5, integer=True, min_n_ticks=2))
        panels[0].set_ylabel(r"$|R\cdot\delta u|$ per unknown / $E_0 L_0^3$")
        handles = [
            Line2D([], [], color="black", marker="o", markersize=4, label=label, **look)
            for label, look in (("converging", _CONVERGING), ("not converging", _DIVERGING))
        ]
        add_legend(figure, handles)
        return figure
