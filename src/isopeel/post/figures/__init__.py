"""Figures, each a pure function from data to a figure; `save` writes it."""

from isopeel.post.figures.comparison import comparison_figure
from isopeel.post.figures.front import front_figure
from isopeel.post.figures.law import law_figure
from isopeel.post.figures.plateau import plateau_figure
from isopeel.post.figures.reaction import reaction_figure
from isopeel.post.figures.sensitivities import sensitivities_figure
from isopeel.post.figures.shapes import shapes_figure
from isopeel.post.figures.spaces import space_figure
from isopeel.post.figures.tractions import tractions_figure
from isopeel.post.style import save

__all__ = [
    "comparison_figure",
    "front_figure",
    "law_figure",
    "plateau_figure",
    "reaction_figure",
    "save",
    "sensitivities_figure",
    "shapes_figure",
    "space_figure",
    "tractions_figure",
]
