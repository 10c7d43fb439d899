"""A law of adhesion: traction, its derivative, its potential and its losses over the gap."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from isopeel.physics.adhesion import AdhesionLaw
from isopeel.post.figures.labels import mathematical
from isopeel.post.laboratory import Laboratory, Unit
from isopeel.post.law import evaluate_flat, law_character, opened_flat
from isopeel.post.style import BLUE, DASHES, DOTS, GREY, TWO_COLUMNS, VERMILION, style

_POINTS = 1001
_COMPRESSED = 0.15  # share of the axis that lies in compression


def law_figure(law: AdhesionLaw, units: Laboratory | None = None) -> Figure:
    """Draw T, dT/dr, the potential and the energy dissipated if irreversible, until the attraction is spent.

    The dissipated energy is drawn over the largest gap so far; a path of unloading begins at half of the
    strength. Values are in `units`, by default in E0 and L0; repulsion is positive. Raises InputError where
    the law attracts at no gap.
    """
    character = law_character(law)
    equilibrium, end = character.equilibrium_gap, character.spent_gap
    start = equilibrium - _COMPRESSED * (character.strongest_gap - equilibrium)
    gap = np.linspace(start, end, _POINTS)
    potential, traction, derivative = evaluate_flat(law, gap)
    length, stress, energy = Unit("$L_0$", 1.0), Unit("$E_0$", 1.0), Unit("$E_0 L_0$", 1.0)
    stiffness = Unit("$E_0 L_0^{-1}$", 1.0)
    if units is not None:
        length, stress = units.unit("length", end - equilibrium), units.unit("stress", character.strength)
        energy = units.unit("toughness")
        name = f"({mathematical(stress.name)}/{mathematical(length.name)})"
        stiffness = Unit(name, stress.factor / length.factor)
    unit = mathematical(length.name)
    gap_label = f"gap $r$ / {unit}"
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 4.4), layout="constrained")
        panels = figure.subplots(2, 2, sharex=True).ravel()
        for axes, values, title, label in zip(
            panels,
            (
                traction * stress.factor,
                derivative * stiffness.factor,
                potential * energy.factor,
                opened_flat(law, gap).dissipated * energy.factor,
            ),
            (
                f"traction $T$ / {mathematical(stress.name)}",
                rf"$\mathrm{{d}}T/\mathrm{{d}}r$ / {stiffness.name}",
                f"potential / {mathematical(energy.name)}",
                f"dissipated if irreversible / {mathematical(energy.name)}",
            ),
            (gap_label, gap_label, gap_label, f"largest gap so far / {unit}"),
            strict=True,
        ):
            axes.axhline(0.0, color=GREY, linewidth=0.6)
            for place in (equilibrium, character.strongest_gap):
                axes.axvline(place * length.factor, color=GREY, linestyle=DOTS, linewidth=0.8)
            axes.plot(gap * length.factor, values, color=BLUE)
            axes.set_title(title, loc="left")
            axes.set_xlabel(label)
            axes.tick_params(labelbottom=True)
            axes.margins(x=0)
        back = np.array([equilibrium, character.softened_gap])
        unloading = opened_flat(law, back)
        (path,) = panels[0].plot(
            back * length.factor,
            unloading.traction * stress.factor,
            color=VERMILION,
            linestyle=DASHES,
            marker="o",
            markersize=3,
            markevery=[1],
        )
        panels[3].plot(
            back[1] * length.factor,
            unloading.dissipated[1] * energy.factor,
            color=VERMILION,
            marker="o",
            markersize=3,
        )
        marks = Line2D([], [], color=GREY, linestyle=DOTS, linewidth=0.8)
        names = ["equilibrium, and strongest attraction", "unloading from half strength, if irreversible"]
        figure.legend([marks, path], names, loc="outside upper left", ncols=2)
        return figure
