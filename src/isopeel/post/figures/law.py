"""A law of adhesion: traction, its derivative and its potential over the gap."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from isopeel.physics.adhesion import AdhesionLaw
from isopeel.post.law import evaluate_flat, law_character
from isopeel.post.style import BLUE, DASHES, GREY, TWO_COLUMNS, style

_POINTS = 1001
_COMPRESSED = 0.15  # of what is shown lies in compression


def law_figure(law: AdhesionLaw) -> Figure:
    """Draw T, dT/dr and the potential from compression to where the attraction is spent.

    In units of E0 and L0; repulsion is positive. Raises InputError where the law attracts at no gap.
    """
    character = law_character(law)
    equilibrium, end = character.equilibrium_gap, character.spent_gap
    start = equilibrium - _COMPRESSED * (character.strongest_gap - equilibrium)
    gap = np.linspace(start, end, _POINTS)
    potential, traction, derivative = evaluate_flat(law, gap)
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 2.4), layout="constrained")
        panels = figure.subplots(1, 3, sharex=True)
        for axes, values, label in zip(
            panels,
            (traction, derivative, potential),
            ("traction $T$ / $E_0$", r"$\mathrm{d}T/\mathrm{d}r$ / $E_0 L_0^{-1}$", r"potential / $E_0 L_0$"),
            strict=True,
        ):
            axes.axhline(0.0, color=GREY, linewidth=0.6)
            for place in (equilibrium, character.strongest_gap):
                axes.axvline(place, color=GREY, linestyle=DASHES, linewidth=0.6)
            axes.plot(gap, values, color=BLUE)
            axes.set_xlabel("gap $r$ / $L_0$")
            axes.set_title(label, loc="left")
            axes.margins(x=0)
        marks = Line2D([], [], color=GREY, linestyle=DASHES, linewidth=0.6)
        figure.legend([marks], ["equilibrium, and strongest attraction"], loc="outside upper left")
        return figure
