"""The figures of a fit: measured and fitted curves with their residuals, correlation, and a profile."""

import numpy as np
from matplotlib.figure import Figure

from isopeel.identification.profile import RISE, Profile
from isopeel.identification.result import FitResult, FittedCurve
from isopeel.post.style import BLUE, GREY, SKY, TWO_COLUMNS, VERMILION, style


def curve_figure(curve: FittedCurve) -> Figure:
    """Draw measured points, the fitted curve with its 95 % band, and the residuals below."""
    x_label, y_label = curve.data.measured.headings
    order = np.argsort(curve.x, kind="stable")
    x, fitted, band = curve.x[order], curve.fitted[order], curve.band[order]
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 4.4), layout="constrained")
        upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
        upper.plot(curve.x, curve.data.measured.y, ".", color=GREY, markersize=4, label="measured")
        upper.fill_between(
            x, fitted - band, fitted + band, color=SKY, alpha=0.5, linewidth=0, label="95 % band of the fit"
        )
        upper.plot(x, fitted, color=BLUE, label="fitted")
        upper.set_ylabel(y_label)
        upper.legend()
        lower.axhspan(-1, 1, color=SKY, alpha=0.25, linewidth=0)
        lower.axhline(0, color=GREY, linewidth=0.6)
        lower.plot(curve.x, curve.residuals / curve.deviations, ".", color=VERMILION, markersize=4)
        lower.set_ylabel("residual / noise")
        lower.set_xlabel(x_label)
        lower.margins(x=0.01)
        return figure


def correlation_figure(result: FitResult) -> Figure:
    """Draw the correlation matrix of the parameters, with its numbers."""
    names = [one.key for one in result.parameters]
    with style():
        side = 1.6 + 0.7 * len(names)
        figure = Figure(figsize=(side + 2.4, side), layout="constrained")
        axes = figure.add_subplot()
        shown = axes.imshow(result.correlation, cmap="RdBu_r", vmin=-1, vmax=1)
        axes.set_xticks(range(len(names)), names, rotation=30, ha="right")
        axes.set_yticks(range(len(names)), names)
        for (row, column), value in np.ndenumerate(result.correlation):
            colour = "white" if abs(value) > 0.6 else "black"
            axes.text(
                column,
                row,
                "-" if np.isnan(value) else f"{value:.3f}",
                ha="center",
                va="center",
                color=colour,
            )
        figure.colorbar(shown, ax=axes, label="correlation")
        return figure


def profile_figure(profile: Profile) -> Figure:
    """Draw the rise of chi square over the values of a parameter, and its 95 % interval."""
    with style():
        figure = Figure(figsize=(TWO_COLUMNS, 3.0), layout="constrained")
        axes = figure.add_subplot()
        axes.plot(profile.values, profile.rises, marker="o", markersize=4, color=BLUE)
        axes.axhline(RISE, color=GREY, linewidth=0.8, linestyle="--", label=f"95 %: a rise of {RISE:.2f}")
        for end in profile.interval:
            if np.isfinite(end):
                axes.axvline(end, color=VERMILION, linewidth=0.8)
        axes.set_xlabel(profile.parameter.heading)
        axes.set_ylabel("rise of chi square")
        axes.set_ylim(bottom=0)
        axes.legend()
        return figure
