"""The figures of the report, each a pure function from plain data to a figure."""

from isopeel.paper.figures.bases import bases_figure
from isopeel.paper.figures.convergence import Amplitude, convergence_figure
from isopeel.paper.figures.cost import Cost, cost_figure
from isopeel.paper.figures.curves import Trace
from isopeel.paper.figures.front import front_figure
from isopeel.paper.figures.linear import linear_figure
from isopeel.paper.figures.meshes import meshes_figure
from isopeel.paper.figures.newton import NewtonHistory, newton_figure
from isopeel.paper.figures.panels import panels_figure
from isopeel.paper.figures.quadrature import quadrature_figure
from isopeel.paper.figures.refinement import refinement_figure
from isopeel.paper.figures.windows import windows_figure

__all__ = [
    "Amplitude",
    "Cost",
    "NewtonHistory",
    "Trace",
    "bases_figure",
    "convergence_figure",
    "cost_figure",
    "front_figure",
    "linear_figure",
    "meshes_figure",
    "newton_figure",
    "panels_figure",
    "quadrature_figure",
    "refinement_figure",
    "windows_figure",
]
