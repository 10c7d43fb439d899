"""A law of adhesion: traction, its derivative, its potential and its losses over the gap."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from isopeel.physics.adhesion import AdhesionLaw
from isopeel.post.law import evaluate_flat, law_character, opened_flat
from isopeel.post.style import BLUE, DASHES, DOTS, GREY, TWO_COLUMNS, VERMILION, style

_POINTS = 1001
_COMPRESSED = 0.15  # of what is shown lies in compression


def law_figure(law: AdhesionLaw) -> Figure:
    """Draw T, dT/dr, the potential and what irreversible adhesion dissipates, until the attraction is spent.

    The dissipated energy is over the largest gap so far; a path of unloading begins at half of the strength.
    In units of E0 and L0; repulsion is positive. Raises InputError where the law attracts at no gap.
    """
    character = law_character(law)
    equilibrium, end = character.equilibrium_gap, character.spent_gap
    start = equilibrium - _COMPRESSED * (character.strongest_gap - equilibrium)
    gap = np.linspace(start, end, _POINTS)
    potential, traction, derivative = evaluate_flat(law, gap)
    gap_label = "gap $r$ / $L_0$"
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 4.4), layout="constrained")
        panels = figure.subplots(2, 2, sharex=True).ravel()
        for axes, values, title, label in zip(
            panels,
            (traction, derivative, potential, opened_flat(law, gap).dissipated),
            (
                "traction $T$ / $E_0$",
                r"$\mathrm{d}T/\mathrm{d}r$ / $E_0 L_0^{-1}$",
                r"potential / $E_0 L_0$",
                "dissipated if irreversible / $E_0 L_0$",
            ),
            (gap_label, gap_label, gap_label, "largest gap so far / $L_0$"),
            strict=True,
        ):
            axes.axhline(0.0, color=GREY, linewidth=0.6)
            for place in (equilibrium, character.strongest_gap):
                axes.axvline(place, color=GREY, linestyle=DOTS, linewidth=0.8)
            axes.plot(gap, values, color=BLUE)
            axes.set_title(title, loc="left")
            axes.set_xlabel(label)
            axes.tick_params(labelbottom=True)
            axes.margins(x=0)
        back = np.array([equilibrium, character.softened_gap])
        unloading = opened_flat(law, back)
        (path,) = panels[0].plot(
            back,
            unloading.traction,
            color=VERMILION,
            linestyle=DASHES,
            marker="o",
            markersize=3,
            markevery=[1],
        )
        panels[3].plot(back[1], unloading.dissipated[1], color=VERMILION, marker="o", markersize=3)
        marks = Line2D([], [], color=GREY, linestyle=DOTS, linewidth=0.8)
        names = ["equilibrium, and strongest attraction", "unloading from half strength, if irreversible"]
        figure.legend([marks, path], names, loc="outside upper left", ncols=2)
        return figure
