"""The sensitivities of the reaction along a curve."""

from matplotlib.figure import Figure

from isopeel.post.figures.labels import axis_label, mathematical
from isopeel.post.sensitivities import relative_sensitivities
from isopeel.post.style import GREY, TWO_COLUMNS, line_style, style
from isopeel.results.curve import Curve


def sensitivities_figure(curve: Curve) -> Figure:
    """Draw m dr/dm for each parameter m over the drive's parameter, beside the reaction r.

    So all lines have the unit of the reaction: the change of the reaction by one percent of a parameter is a
    hundredth of its line.
    """
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 3.0), layout="constrained")
        axes = figure.subplots()
        axes.plot(curve.parameter, curve.reaction, color=GREY, linewidth=0.8, label="reaction")
        for number, one in enumerate(curve.sensitive_to):
            relative = relative_sensitivities(curve)[:, number]
            axes.plot(curve.parameter, relative, label=one.key, **line_style(number))
        axes.margins(x=0)
        axes.set_xlabel(axis_label(curve.parameter_column))
        unit = mathematical(curve.reaction_column.unit)
        axes.set_ylabel(f"$m\\ \\partial r/\\partial m$ / {unit}")
        figure.legend(loc="outside right upper", fontsize=7)
        return figure
