"""The report of a fit."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from isopeel.identification.figures import correlation_figure, curve_figure, profile_figure
from isopeel.identification.result import FitResult, FittedParameter
from isopeel.report.document import Block, Document, Picture, Section, Table, Text
from isopeel.report.wording import listed
from isopeel.results.provenance import Provenance

#: The case with the fitted values, in the folder of tables.
FITTED = "fitted.toml"


def make_document(result: FitResult, provenance: Provenance, command: str) -> Document:
    """Return the report of a fit; its figures are drawn when it is written."""
    count = sum(len(curve.x) for curve in result.curves)
    names = listed([f"`{one.key}`" for one in result.parameters])
    files = listed([f"`{curve.data.name}`" for curve in result.curves])
    abstract = (
        f"{names} of the case {result.fit.case.name} were fitted to {count} measured points of {files} by"
        " least"
        " squares."
    )
    sections = [
        Section("Parameters", tuple(_parameters(result)), command),
        Section("Curves", tuple(_curves(result))),
        Section("How well they are determined", tuple(_uncertainty(result))),
        Section("Search", tuple(_search(result))),
        Section("Where the numbers come from", tuple(_provenance(provenance))),
    ]
    return Document(f"Fit {result.fit.name}", Text(abstract), tuple(sections))


def _parameters(result: FitResult) -> Iterator[Block]:
    rows = tuple(_row(one) for one in result.parameters)
    title = "The fitted values, and their standard errors."
    headings = (
        "parameter",
        "value",
        "standard error",
        "relative [%]",
        "if the others were known [%]",
        "start",
        "bounds",
    )
    yield Table("parameters", title, headings, rows)
    yield Text(f"The case with these values is `tables/{FITTED}`; `isopeel run` computes it.")
    for note in result.notes:
        yield Text(note)


def _row(one: FittedParameter) -> tuple[str, ...]:
    parameter = one.parameter
    known = not np.isnan(one.standard_error)
    ends = [parameter.text(end, 4) if np.isfinite(end) else "-" for end in (parameter.lower, parameter.upper)]
    return (
        one.key,
        parameter.text(one.value),
        parameter.text(one.standard_error, 3) if known else f"at its {one.bound} bound",
        f"{100 * one.relative_error:.3g}" if known else "-",
        f"{100 * one.alone / abs(one.value or 1.0):.3g}" if known else "-",
        parameter.text(parameter.start, 4),
        " to ".join(ends),
    )


def _curves(result: FitResult) -> Iterator[Block]:
    for number, curve in enumerate(result.curves, start=1):
        caption = (
            f"{curve.data.name}: measured points, the fitted curve, and residuals. The band of the fit"
            " has the true"
            " curve with 95 % confidence, if the model is right; it is not that of single measured points."
        )
        yield Picture(f"curve-{number}", caption, partial(curve_figure, curve))


def _uncertainty(result: FitResult) -> Iterator[Block]:
    noise = (
        f"The noise is stated. Chi square is {result.chi_square:.4g} for {result.freedom} degrees of"
        " freedom; noise"
        f" alone gives as much with a probability of {result.probability:.2g}."
        if result.noise_is_stated
        else "The noise is estimated from the residuals, as one share of the largest value of each curve:"
        f" {100 * result.curves[0].deviations[0] / np.abs(result.curves[0].data.measured.y).max():.3g} %."
    )
    yield Text(noise)
    yield Text(
        "The standard errors are those of linear theory: the covariance is the inverse of $J^T J$, with the"
        f" derivatives $J$ in units of the noise. The condition number of $J$ is {result.condition:.3g},"
        " for relative"
        " changes of the parameters: it is large where a combination of parameters hardly changes the curves."
    )
    rows = tuple(
        (
            curve.data.name,
            str(len(curve.x)),
            "-" if curve.runs is None else str(curve.runs.runs),
            "-" if curve.runs is None else f"{curve.runs.expected:.1f}",
            "-" if curve.runs is None else f"{curve.runs.probability:.2g}",
        )
        for curve in result.curves
    )
    headings = ("curve", "points", "runs of one sign", "expected of noise", "probability of so few")
    yield Table(
        "residuals", "Whether the residuals look like noise (test of Wald and Wolfowitz).", headings, rows
    )
    if len(result.parameters) > 1:
        yield Picture("correlation", "Correlation of the parameters.", partial(correlation_figure, result))
    if result.profile is not None:
        profile = result.profile
        ends = [profile.parameter.text(end) if np.isfinite(end) else "not found" for end in profile.interval]
        caption = (
            f"Profile of {profile.parameter.key}: the smallest chi square over all other parameters. Ends"
            " of the 95 %"
            f" interval: {ends[0]}, {ends[1]}."
        )
        yield Picture("profile", caption, partial(profile_figure, profile))


def _search(result: FitResult) -> Iterator[Block]:
    yield Text(f"{result.runs} runs were computed; those of an earlier command are not counted.")
    headings = (
        "start",
        *(one.parameter.heading for one in result.parameters),
        "sum of squares",
        "evaluations",
        "",
    )
    rows = tuple(
        (
            str(number),
            *(f"{begin:.4g} -> {end:.6g}" for begin, end in zip(one.start, one.values, strict=True)),
            f"{one.chi_square:.6g}",
            str(one.evaluations),
            one.cause,
        )
        for number, one in enumerate(result.starts, start=1)
    )
    yield Table("starts", "The starts of the search, and where they ended.", headings, rows)


def _provenance(provenance: Provenance) -> Iterator[Block]:
    versions = ", ".join(f"{name} {version}" for name, version in provenance.versions.items())
    revision = f", source revision {provenance.git_revision}" if provenance.git_revision else ""
    yield Text(
        f"Computed by {versions}{revision}. Between its steps a computed curve is interpolated linearly"
        " at the"
        " measured points."
    )
